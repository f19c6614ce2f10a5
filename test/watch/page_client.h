// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a browser, or somebody who means no good, does with the server of live pages: requests as
/// bytes, and sockets as pages open them.
#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

namespace cdiff::test {

/// "http://127.0.0.1:8080/TOKEN/" in its parts.
struct PageAddress {
  explicit PageAddress(const std::string& address)
      : host(address.substr(7, address.find('/', 7) - 7)),
        path(address.substr(address.find('/', 7))),
        token(path.substr(1, path.size() - 2)),
        port(static_cast<std::uint16_t>(std::stoi(host.substr(host.find(':') + 1)))) {}
  std::string host;
  std::string path;
  std::string token;
  std::uint16_t port;
};

/// Waits for what comes within half a minute on any machine; false when it does not.
inline bool comes(const std::function<bool()>& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// An open connection to a port of this computer.
class Connection {
 public:
  explicit Connection(std::uint16_t port) {
    socket_.connect({boost::asio::ip::address_v4::loopback(), port});
  }
  /// Sends bytes and reads what comes until the server closes; empty when it closes at once.
  std::string answer(const std::string& bytes) {
    boost::system::error_code ignored;
    std::string text;
    boost::asio::write(socket_, boost::asio::buffer(bytes), ignored);
    boost::asio::read(socket_, boost::asio::dynamic_buffer(text), ignored);
    return text;
  }

 private:
  boost::asio::io_context loop_;
  boost::asio::ip::tcp::socket socket_{loop_};
};

inline std::string answerTo(const PageAddress& address, const std::string& request) {
  return Connection(address.port).answer(request);
}

/// The first request of a browser for a path.
inline std::string getOf(const PageAddress& address, const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: " + address.host + "\r\n\r\n";
}

/// A page's socket.
class PageSocket {
 public:
  /// Throws boost::system::system_error when it is refused; status() says how.
  explicit PageSocket(const PageAddress& address) : PageSocket(address, "http://" + address.host) {}
  /// Of a page from elsewhere; without `origin`: of no page.
  PageSocket(const PageAddress& address, const std::string& origin, const std::string& host = "") {
    namespace beast = boost::beast;
    auto& stream = beast::get_lowest_layer(socket_);
    stream.connect({boost::asio::ip::address_v4::loopback(), address.port});
    socket_.set_option(beast::websocket::stream_base::decorator([origin](auto& request) {
      if (!origin.empty()) request.set(beast::http::field::origin, origin);
    }));
    socket_.handshake(host.empty() ? address.host : host, address.path + "socket");
  }
  void send(const std::string& text) { socket_.write(boost::asio::buffer(text)); }
  std::string next() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    return boost::beast::buffers_to_string(buffer.data());
  }
  /// The first message that has it.
  nlohmann::json next(const std::string& key) {
    while (true) {
      const nlohmann::json message = nlohmann::json::parse(next());
      if (message.contains(key)) return message.at(key);
    }
  }
  /// Sends a command and gives why it was refused; empty: it was not.
  std::string ask(nlohmann::json command) {
    command["id"] = ++asked_;
    send(command.dump());
    return answered();
  }
  std::string answered() { return next("answers").at(0).at("refused"); }

 private:
  boost::asio::io_context loop_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_{loop_};
  std::uint64_t asked_ = 0;
};

}  // namespace cdiff::test
