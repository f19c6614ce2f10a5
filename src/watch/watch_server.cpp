// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "watch/watch_server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <set>
#include <thread>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"
#include "page/live_page.h"

namespace cdiff::watch {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

constexpr auto kBeat = std::chrono::milliseconds(40);

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<long>(1000.0 * seconds));
}

std::string_view viewOf(beast::string_view text) { return {text.data(), text.size()}; }

/// The value of a header that is there once; empty when it is not.
std::string_view header(const Request& request, http::field field) {
  return request.count(field) == 1 ? viewOf(request[field]) : std::string_view();
}

}  // namespace

/// The thread, its listening socket, and what is connected.
class WatchServer::Listener {
 public:
  Listener(std::uint16_t port, WatchSource& source, const WatchLimits& limits)
      : source_(source),
        limits_(limits),
        acceptor_(open(port)),
        access_(acceptor_.local_endpoint().port()) {
    accept();
    beat();
    thread_ = std::thread([this] { loop_.run(); });
  }
  ~Listener() {
    loop_.stop();
    thread_.join();
    viewers_.clear();  // before the loop that their sockets belong to
  }

  WatchSource& source() { return source_; }
  const WatchLimits& limits() const { return limits_; }
  const PageAccess& access() const { return access_; }

  class Connection;
  class Viewer;
  /// Counts what is connected as long as it exists.
  class Place {
   public:
    explicit Place(std::size_t& count) : count_(count) { ++count_; }
    ~Place() { --count_; }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    std::size_t& count_;
  };
  bool hasRoomForViewer() const { return viewers_.size() < limits_.viewers; }
  void join(const std::shared_ptr<Viewer>& viewer) {
    viewers_.insert(viewer);
    source_.viewersAre(viewers_.size());
  }
  void leave(const std::shared_ptr<Viewer>& viewer) {
    if (viewers_.erase(viewer) > 0) source_.viewersAre(viewers_.size());
  }

 private:
  asio::ip::tcp::acceptor open(std::uint16_t port);
  void accept();
  void beat();

  WatchSource& source_;
  WatchLimits limits_;
  std::size_t connections_ = 0;
  std::set<std::shared_ptr<Viewer>> viewers_;
  asio::io_context loop_{1};
  asio::ip::tcp::acceptor acceptor_;
  PageAccess access_;
  asio::steady_timer timer_{loop_};
  asio::steady_timer breath_{loop_};
  std::thread thread_;
};

/// A page's socket: news when it is free, answers to what it asks.
class WatchServer::Listener::Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(beast::tcp_stream stream, Listener& listener, std::unique_ptr<Place> place)
      : socket_(std::move(stream)),
        listener_(listener),
        place_(std::move(place)),
        rest_(socket_.get_executor()) {}

  void begin(const Request& request) {
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = milliseconds(listener_.limits().request_seconds);
    timeout.idle_timeout = milliseconds(listener_.limits().silence_seconds);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(listener_.limits().message);
    socket_.async_accept(request, [self = this->shared_from_this()](error_code failed) {
      if (failed) return;
      self->listener_.join(self);
      self->read();
      self->tell();
    });
  }

  /// Sends an answer that waits, or else what is new; nothing while something is being sent.
  void tell() {
    if (sending_ || dropped_) return;
    if (answers_.empty()) {
      sent_ = listener_.source().news(cursor_);
    } else {
      sent_ = std::move(answers_.front());
      answers_.pop_front();
    }
    if (sent_.empty()) return;
    sending_ = true;
    socket_.text(true);
    socket_.async_write(asio::buffer(sent_),
                        [self = this->shared_from_this()](error_code failed, std::size_t) {
                          self->sending_ = false;
                          if (failed) return self->drop();
                          if (!self->answers_.empty()) self->tell();
                        });
  }

 private:
  void read() {
    socket_.async_read(received_,
                       [self = this->shared_from_this()](error_code failed, std::size_t) {
                         if (failed) return self->drop();
                         self->take();
                         self->readOn();
                       });
  }

  void take() {
    const std::string message = beast::buffers_to_string(received_.data());
    received_.consume(received_.size());
    const std::weak_ptr<Viewer> viewer = this->shared_from_this();
    const auto executor = socket_.get_executor();
    listener_.source().take(message, [viewer, executor](const std::string& text) {
      asio::post(executor, [viewer, text] {
        if (const auto self = viewer.lock()) self->answer(text);
      });
    });
  }

  void answer(const std::string& text) {
    if (answers_.size() >= listener_.limits().answers) return drop();
    answers_.push_back(text);
    tell();
  }

  /// Who sends too much is read on in the next second.
  void readOn() {
    const Clock::time_point now = Clock::now();
    if (now - second_ > std::chrono::seconds(1)) {
      second_ = now;
      taken_ = 0;
    }
    if (++taken_ < listener_.limits().messages) return read();
    rest_.expires_at(second_ + std::chrono::seconds(1));
    rest_.async_wait([self = this->shared_from_this()](error_code failed) {
      if (!failed && !self->dropped_) self->read();
    });
  }

  void drop() {
    if (dropped_) return;
    dropped_ = true;
    rest_.cancel();
    beast::get_lowest_layer(socket_).close();
    listener_.leave(this->shared_from_this());
  }

  websocket::stream<beast::tcp_stream> socket_;
  Listener& listener_;
  std::unique_ptr<Place> place_;
  asio::steady_timer rest_;
  beast::flat_buffer received_;
  std::string sent_;
  std::deque<std::string> answers_;
  NewsCursor cursor_;
  Clock::time_point second_ = Clock::now();
  std::size_t taken_ = 0;  ///< messages since then
  bool sending_ = false;
  bool dropped_ = false;
};

/// One request and its answer; a page's socket goes on as a Viewer.
class WatchServer::Listener::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(asio::ip::tcp::socket socket, Listener& listener, std::unique_ptr<Place> place)
      : stream_(std::move(socket)), listener_(listener), place_(std::move(place)) {
    parser_.header_limit(listener.limits().header);
    parser_.body_limit(0);
  }

  void begin() {
    stream_.expires_after(milliseconds(listener_.limits().request_seconds));
    http::async_read(stream_, received_, parser_,
                     [self = this->shared_from_this()](error_code failed, std::size_t) {
                       self->handle(failed);
                     });
  }

 private:
  void handle(error_code failed) {
    if (failed == http::error::body_limit) return refuse(http::status::payload_too_large);
    if (failed == http::error::header_limit || failed == http::error::buffer_overflow)
      return refuse(http::status::request_header_fields_too_large);
    if (failed.category() == make_error_code(http::error::bad_method).category() &&
        failed != http::error::end_of_stream && failed != http::error::partial_message)
      return refuse(http::status::bad_request);
    if (failed) return;  // closed, or too slow
    const Request& request = parser_.get();
    const bool upgrade = websocket::is_upgrade(request);
    const int refusal = listener_.access().refusal(
        {viewOf(request.method_string()), viewOf(request.target()),
         header(request, http::field::host), header(request, http::field::origin), upgrade});
    if (refusal != 0) return refuse(static_cast<http::status>(refusal));
    if (!upgrade) return send(std::string(PageAccess::name(viewOf(request.target()))));
    if (!listener_.hasRoomForViewer()) return refuse(http::status::service_unavailable);
    std::make_shared<Viewer>(std::move(stream_), listener_, std::move(place_))->begin(request);
  }

  void send(const std::string& name) {
    const auto document = listener_.source().document(name);
    if (document == nullptr) return refuse(http::status::not_found);
    name_ = name;
    response_.body() = *document;
    response_.set(http::field::content_type, "text/html; charset=utf-8");
    response_.set("Content-Security-Policy",
                  page::livePagePolicy(std::string(header(parser_.get(), http::field::host))));
    respond(http::status::ok);
  }

  void refuse(http::status status) {
    response_.body() = std::to_string(static_cast<int>(status)) + " " +
                       std::string(http::obsolete_reason(status)) + "\n";
    response_.set(http::field::content_type, "text/plain; charset=utf-8");
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET");
    respond(status);
  }

  void respond(http::status status) {
    response_.result(status);
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.prepare_payload();
    stream_.expires_after(milliseconds(listener_.limits().request_seconds));
    http::async_write(
        stream_, response_,
        [self = this->shared_from_this()](error_code failed, std::size_t) { self->end(failed); });
  }

  void end(error_code failed) {
    error_code closed;
    stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, closed);
    if (failed) return;
    if (response_.result() == http::status::ok) listener_.source().delivered(name_);
    drain();
  }

  /// Reads on a little: closing with bytes unread would take the answer from the client.
  void drain() {
    received_.consume(received_.size());
    if (drained_ > kMostDrained) return;
    stream_.async_read_some(received_.prepare(4096),
                            [self = this->shared_from_this()](error_code over, std::size_t size) {
                              self->drained_ += size;
                              if (!over) self->drain();
                            });
  }

  beast::tcp_stream stream_;
  Listener& listener_;
  std::unique_ptr<Place> place_;
  beast::flat_buffer received_{16384};
  http::request_parser<http::string_body> parser_;
  Response response_;
  std::string name_;
  static constexpr std::size_t kMostDrained = 1 << 20;  // [bytes]
  std::size_t drained_ = 0;
};

asio::ip::tcp::acceptor WatchServer::Listener::open(std::uint16_t port) {
  const asio::ip::tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
  try {
    return asio::ip::tcp::acceptor(loop_, endpoint);
  } catch (const boost::system::system_error& error) {
    throw core::InputError("the live page cannot listen on port " + std::to_string(port) +
                           " of 127.0.0.1: " + error.code().message() +
                           "; choose another one, or 0 for any that is free");
  }
}

void WatchServer::Listener::accept() {
  acceptor_.async_accept([this](error_code failed, asio::ip::tcp::socket socket) {
    if (failed) {  // out of file descriptors, or over
      breath_.expires_after(std::chrono::milliseconds(100));
      breath_.async_wait([this](error_code over) {
        if (!over) accept();
      });
      return;
    }
    if (connections_ < limits_.connections)
      std::make_shared<Connection>(std::move(socket), *this, std::make_unique<Place>(connections_))
          ->begin();
    accept();
  });
}

void WatchServer::Listener::beat() {
  source_.beat();
  const auto viewers = viewers_;  // one that is dropped leaves
  for (const std::shared_ptr<Viewer>& viewer : viewers) viewer->tell();
  timer_.expires_after(kBeat);
  timer_.async_wait([this](error_code over) {
    if (!over) beat();
  });
}

WatchServer::WatchServer(std::uint16_t port, WatchSource& source, const WatchLimits& limits)
    : listener_(std::make_unique<Listener>(port, source, limits)) {}

WatchServer::~WatchServer() = default;

const PageAccess& WatchServer::access() const { return listener_->access(); }

}  // namespace cdiff::watch
