// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions without SUMO that are watched and steered by pages: what these see, and that the session
// computes the same bytes as without them.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "core/file.h"
#include "session/closed_loop.h"
#include "session/scripted_session.h"
#include "watch/live_session.h"
#include "watch/page_client.h"

namespace cdiff::watch {
namespace {

using test::answerTo;
using test::comes;
using test::getOf;
using test::PageAddress;
using test::PageSocket;
using Json = nlohmann::json;

constexpr const char* kOddName = "<script>alert(1)</script>";

/// A session on a straight road whose traffic has an odd name, in a thread.
class WatchedRun {
 public:
  using Early = std::function<void(const PageAddress&)>;

  /// `patience`: how long it waits for a page [s]; negative: it is not watched. `early` is called
  /// when the page is there and the session has not begun.
  explicit WatchedRun(double patience, const Early& early = {})
      : loop_(scripted_.setup(), parts()) {
    if (patience >= 0.0)
      live_ = std::make_unique<LiveSession>(scripted_.setup(),
                                            std::make_unique<ControlLink>(loop_.control()), 0);
    loop_.addObserver(writer_);
    if (live_) {
      loop_.addObserver(*live_);
      if (early) early(address());
      live_->begin(writer_, patience);
    }
    thread_ = std::thread([this] { loop_.run(stop_); });
  }
  ~WatchedRun() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  PageAddress address() const { return PageAddress(live_->address()); }
  /// Waits for the end; the trace.
  std::string end() {
    thread_.join();
    writer_.finish(1.0);
    if (live_) live_->finish();
    return writer_.result().trace_sha256;
  }
  void stop() { stop_ = true; }
  double pace() { return loop_.control().pace(); }
  const record::SessionResult& result() const { return writer_.result(); }
  /// Files of the result that hold a text.
  std::vector<std::string> filesWith(const std::string& text) const {
    std::vector<std::string> files;
    for (const auto& file : std::filesystem::directory_iterator(folder_.path())) {
      if (core::readFile(file.path(), "result").find(text) != std::string::npos)
        files.push_back(file.path().filename());
    }
    return files;
  }

 private:
  session::LoopParts parts() {
    session::LoopParts parts = session::makeParts(scripted_.setup());
    scripted_.simulator().place(kOddName, {160.0, 0.0, 0.0, 6.0});
    parts.world = scripted_.makeWorld();
    return parts;
  }

  test::ScriptedSession scripted_;
  test::TemporaryFolder folder_;
  session::ClosedLoop loop_;
  page::ResultWriter writer_{scripted_.setup(), {"test", "none", true}, folder_.path()};
  std::unique_ptr<LiveSession> live_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

Json steer(const std::string& what, const std::string& value) {
  return {{"do", "steer"}, {"what", what}, {"value", value}};
}

/// Lets a paused session run to its end.
void letGo(PageSocket& page) {
  EXPECT_EQ(page.ask({{"do", "pace"}, {"value", "0"}}), "");
  EXPECT_EQ(page.ask({{"do", "resume"}}), "");
}

void waitFor(PageSocket& page, const std::string& run) {
  while (page.next("run") != run) {
  }
}

TEST(LiveSession, ComputesTheSameBytesWhateverItsPagesDo) {
  const std::string unwatched = WatchedRun(-1.0).end();
  EXPECT_EQ(WatchedRun(0.0).end(), unwatched) << "no page came";
  WatchedRun run(600.0);
  PageSocket page(run.address());
  EXPECT_EQ(page.ask({{"do", "pause"}}), "");
  EXPECT_NE(page.ask({{"do", "pause"}}).find("paused already"), std::string::npos);
  EXPECT_NE(page.ask(steer("choose", "nobody")).find("'nobody' is not there"), std::string::npos);
  EXPECT_NE(page.ask(steer("profile", "fierce")).find("is not guided"), std::string::npos);
  EXPECT_NE(page.ask(steer("weight", "1")).find("cannot be steered"), std::string::npos);
  page.send("{\"do\": ");
  EXPECT_NE(page.answered().find("no JSON object"), std::string::npos);
  EXPECT_NE(page.ask({{"do", "step"}, {"ticks", 5000}}).find("[1, 1000]"), std::string::npos);
  EXPECT_EQ(page.ask({{"do", "step"}, {"ticks", 5}}), "");
  { const PageSocket closed(run.address()); }
  EXPECT_NE(answerTo(run.address(), getOf(run.address(), "/")).find("403"), std::string::npos);
  letGo(page);
  std::thread reader([&] {
    EXPECT_EQ(page.next("over").at("report"), true);
    const std::string path = run.address().path + "report.html";
    EXPECT_NE(answerTo(run.address(), getOf(run.address(), path)).find("session report"),
              std::string::npos);
  });
  EXPECT_EQ(run.end(), unwatched);
  reader.join();
  EXPECT_TRUE(run.result().steering.records().empty());
  EXPECT_EQ(run.filesWith(run.address().token), std::vector<std::string>());
}

TEST(LiveSession, APageThatComesEarlyStartsItAtThePaceThatItAsksFor) {
  std::unique_ptr<PageSocket> page;
  WatchedRun run(600.0, [&](const PageAddress& address) {
    page = std::make_unique<PageSocket>(address);
    EXPECT_EQ(page->ask({{"do", "pace"}, {"value", "0"}}), "");
  });
  EXPECT_EQ(run.pace(), 0.0);
  page.reset();
  EXPECT_FALSE(run.end().empty());
}

TEST(LiveSession, ShowsItsPagesTheSame) {
  WatchedRun run(600.0);
  PageSocket first(run.address()), second(run.address());
  EXPECT_EQ(first.ask({{"do", "pause"}}), "");
  waitFor(second, "paused");
  EXPECT_EQ(second.ask({{"do", "step"}, {"ticks", 4}}), "");
  Json told;
  EXPECT_TRUE(comes([&] {  // the steps are over
    told = Json::parse(PageSocket(run.address()).next());
    return told.at("run") == "paused";
  }));
  EXPECT_EQ(told.at("frame").at("vehicles").size(), 2U);
  EXPECT_EQ(told.at("frame").at("vehicles")[1][1], kOddName) << "as text";
  EXPECT_FALSE(told.at("points").empty());
  EXPECT_EQ(told.at("values").at("target_speed"), "8");
  const std::string page = answerTo(run.address(), getOf(run.address(), run.address().path));
  EXPECT_NE(page.find("id=\"objectives\""), std::string::npos);
  EXPECT_EQ(page.find("alert(1)"), std::string::npos);
  run.stop();
}

TEST(LiveSession, OfASliderTheLastPlaceCounts) {
  WatchedRun run(600.0);
  PageSocket page(run.address());
  EXPECT_EQ(page.ask({{"do", "pause"}}), "");
  for (int i = 1; i <= 100; ++i)
    EXPECT_EQ(page.ask(steer("target_speed", std::to_string(i % 9 + 3))), "");
  letGo(page);
  const Json changes = page.next("changes");
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0][1], "live page");
  EXPECT_EQ(changes[0][2], "target_speed 8 -> 4");
  EXPECT_EQ(changes[0][3], "") << "not refused";
  run.stop();
  run.end();
  ASSERT_EQ(run.result().steering.records().size(), 1U);
  EXPECT_TRUE(run.result().steering.byHand());
}

TEST(LiveSession, TellsWhyAChosenVehicleWasNotTaken) {
  WatchedRun run(600.0);
  PageSocket page(run.address());
  EXPECT_EQ(page.ask({{"do", "pause"}}), "");
  EXPECT_EQ(page.ask(steer("choose", kOddName)), "") << "the gates of CBVs come later";
  letGo(page);
  const Json changes = page.next("changes");
  run.stop();
  run.end();
  ASSERT_EQ(run.result().steering.records().size(), 1U);
  const std::string refused = run.result().steering.records()[0].refused;
  EXPECT_NE(refused, "");
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0][3], refused);
}

}  // namespace
}  // namespace cdiff::watch
