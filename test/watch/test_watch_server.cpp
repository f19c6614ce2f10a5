// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The server of live pages with real sockets, and a source that counts.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <deque>
#include <mutex>

#include "e2e_cdiff/core/exceptions.h"
#include "watch/page_client.h"
#include "watch/watch_server.h"

namespace cdiff::watch {
namespace {

using test::answerTo;
using test::comes;
using test::getOf;
using test::PageAddress;
using test::PageSocket;

/// News are "frame N" with as many letters as wanted, from 1 on.
class CountingSource : public WatchSource {
 public:
  std::shared_ptr<const std::string> document(const std::string& name) override {
    return name.empty() ? std::make_shared<const std::string>("<p>page</p>") : nullptr;
  }
  void delivered(const std::string&) override { ++pages; }
  std::string news(NewsCursor& cursor) override {
    if (cursor.frame == frame) return {};
    cursor.frame = frame;
    return "frame " + std::to_string(frame) + std::string(letters, '.');
  }
  void take(const std::string& message, std::function<void(const std::string&)> answer) override {
    ++taken;
    answer("taken " + message);
  }
  void viewersAre(std::size_t count) override { viewers = count; }
  void beat() override {}

  std::atomic<std::uint64_t> frame{1};
  std::atomic<std::size_t> letters{0};
  std::atomic<std::size_t> taken{0};
  std::atomic<std::size_t> viewers{0};
  std::atomic<std::size_t> pages{0};
};

class WatchServerTest : public testing::Test {
 protected:
  void serve(const WatchLimits& limits = {}) {
    server_ = std::make_unique<WatchServer>(0, source_, limits);
  }
  PageAddress address() const { return PageAddress(server_->access().address()); }
  std::string status(const std::string& request) const {
    const std::string answer = answerTo(address(), request);
    return answer.size() < 12 ? answer : answer.substr(9, 3);
  }
  std::string head(const std::string& method, const std::string& more = "") const {
    return method + " " + address().path + " HTTP/1.1\r\nHost: " + address().host + "\r\n" + more +
           "\r\n";
  }
  /// The status that refuses a socket.
  std::string refused(const std::string& origin, const std::string& host = "") const {
    try {
      PageSocket(address(), origin, host);
    } catch (const boost::system::system_error& error) {
      return error.code() == boost::beast::websocket::error::upgrade_declined ? "declined"
                                                                              : error.what();
    }
    return "";
  }
  void expectNewest(PageSocket& socket, std::uint64_t frame) const {
    std::string text = socket.next();
    while (text != "frame " + std::to_string(frame)) text = socket.next();
  }

  CountingSource source_;
  std::unique_ptr<WatchServer> server_;
};

TEST_F(WatchServerTest, ServesThePageWithAPolicyThatLetsNothingElseIn) {
  serve();
  const std::string answer = answerTo(address(), getOf(address(), address().path));
  EXPECT_EQ(answer.rfind("HTTP/1.1 200 OK", 0), 0U) << answer;
  for (const char* part :
       {"Content-Security-Policy: default-src 'none'; script-src 'sha256-",
        "frame-ancestors 'none'", "Cache-Control: no-store", "Referrer-Policy: no-referrer",
        "X-Content-Type-Options: nosniff", "\r\n\r\n<p>page</p>"})
    EXPECT_NE(answer.find(part), std::string::npos) << part << "\nin\n" << answer;
  EXPECT_TRUE(comes([&] { return source_.pages == 1; }));
}

TEST_F(WatchServerTest, RefusesWhatItDoesNotServe) {
  serve();
  const std::string wrong = "/" + std::string(32, 'a') + "/";
  EXPECT_EQ(status(getOf(address(), wrong)), "403");
  EXPECT_EQ(status("GET " + address().path + " HTTP/1.1\r\n\r\n"), "403") << "no Host";
  EXPECT_EQ(status("GET " + address().path + " HTTP/1.1\r\nHost: evil.example\r\n\r\n"), "403");
  EXPECT_EQ(status(head("GET", "Host: evil.example\r\n")), "403") << "two of them";
  EXPECT_EQ(status(head("GET", "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(status(getOf(address(), address().path + "nothing")), "404");
  EXPECT_EQ(status(getOf(address(), address().path + "report.html")), "404") << "not there yet";
  EXPECT_EQ(status(head("POST", "Content-Length: 0\r\n")), "405");
  EXPECT_EQ(status(head("POST", "Content-Length: 5\r\n") + "hello"), "413");
  EXPECT_EQ(status(head("GET", "Cookie: " + std::string(10000, 'x') + "\r\n")), "431");
  EXPECT_EQ(status("hello\r\n\r\n"), "400");
  EXPECT_EQ(source_.pages, 0U);
}

TEST_F(WatchServerTest, RefusesSocketsOfOtherPages) {
  serve();
  EXPECT_EQ(refused("http://evil.example"), "declined");
  EXPECT_EQ(refused(""), "declined") << "no page at all";
  EXPECT_EQ(refused("http://evil.example:80", "evil.example:80"), "declined");
  EXPECT_EQ(source_.viewers, 0U);
  EXPECT_EQ(refused("http://" + address().host), "");
}

TEST_F(WatchServerTest, TenPagesSeeTheNewestAndOneThatGoesIsForgotten) {
  serve();
  std::deque<PageSocket> sockets;
  for (int i = 0; i < 10; ++i) sockets.emplace_back(address());
  EXPECT_TRUE(comes([&] { return source_.viewers == 10; }));
  source_.frame = 7;
  for (PageSocket& socket : sockets) expectNewest(socket, 7);
  sockets.pop_front();
  EXPECT_TRUE(comes([&] { return source_.viewers == 9; }));
  source_.frame = 8;
  for (PageSocket& socket : sockets) expectNewest(socket, 8);
}

TEST_F(WatchServerTest, MorePagesThanItHasRoomForAreRefused) {
  WatchLimits limits;
  limits.viewers = 1;
  serve(limits);
  PageSocket first(address());
  expectNewest(first, 1);
  EXPECT_EQ(refused("http://" + address().host), "declined");
}

TEST_F(WatchServerTest, APageThatReadsNothingIsDroppedAndKeepsNobodyWaiting) {
  WatchLimits limits;
  limits.silence_seconds = 0.5;
  serve(limits);
  PageSocket silent(address());
  EXPECT_TRUE(comes([&] { return source_.viewers == 1; }));
  source_.letters = 10000000;  // more than the system keeps for it
  source_.frame = 2;
  EXPECT_TRUE(comes([&] { return source_.viewers == 0; }));
  source_.letters = 0;
  source_.frame = 3;
  PageSocket reader(address());
  expectNewest(reader, 3);
}

TEST_F(WatchServerTest, AThousandConnectionsDoNotDisturbAPage) {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 4096);
  setrlimit(RLIMIT_NOFILE, &files);
  WatchLimits limits;
  limits.request_seconds = 0.5;
  serve(limits);
  PageSocket page(address());
  expectNewest(page, 1);
  {
    std::deque<test::Connection> idle;
    for (int i = 0; i < 1000; ++i) idle.emplace_back(address().port);
    source_.frame = 2;
    expectNewest(page, 2);
    // Those that ask for nothing are closed, and there is room again.
    EXPECT_TRUE(comes([&] { return status(getOf(address(), address().path)) == "200"; }));
  }
  source_.frame = 3;
  expectNewest(page, 3);
}

TEST_F(WatchServerTest, AMessageOf100MegabytesEndsItsPageAlone) {
  serve();
  PageSocket page(address());
  PageSocket flood(address());
  EXPECT_TRUE(comes([&] { return source_.viewers == 2; }));
  EXPECT_THROW(
      {
        std::string message;
        message.resize(100000000, 'x');
        flood.send(message);
        while (true) flood.next();
      },
      boost::system::system_error);
  EXPECT_TRUE(comes([&] { return source_.viewers == 1; }));
  EXPECT_EQ(source_.taken, 0U);
  page.send("hello");
  std::string text = page.next();
  while (text != "taken hello") text = page.next();
}

TEST_F(WatchServerTest, MessagesBeyondTheRateWaitButAreNotLost) {
  WatchLimits limits;
  limits.messages = 5;
  serve(limits);
  PageSocket page(address());
  for (int i = 0; i < 12; ++i) page.send(std::to_string(i));
  int next = 0;
  while (next < 12) {
    if (page.next() == "taken " + std::to_string(next)) ++next;
  }
  EXPECT_EQ(source_.taken, 12U);
}

TEST_F(WatchServerTest, ATakenPortIsBadInput) {
  serve();
  try {
    WatchServer(address().port, source_);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("port " + std::to_string(address().port)), std::string::npos) << text;
    EXPECT_NE(text.find("choose another one"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace cdiff::watch
