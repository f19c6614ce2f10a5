// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <memory>

#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/result_reserve.h"
#include "node_graph/session_files.h"
#include "node_graph/session_launch.h"
#include "support/small_files.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

/// Gives the reserve each tick of a session that one process drives, all but the last.
class Feeder : public session::SessionObserver {
 public:
  Feeder(const session::SessionSetup& setup, ResultReserve& reserve)
      : setup_(setup), reserve_(reserve) {}

  void observe(const session::TickRecord& record) override {
    if (last_) reserve_.keep(last_, answers_);
    const session::ScenarioOptions& options = setup_.options();
    TickValues values{*record.snapshot, &setup_.network(), options.simulation_step};
    values.selection = record.selection;
    if (record.actions != nullptr) {
      for (const planning::PlannedAction& action : *record.actions)
        values.answers.push_back(answerOf(action, record));
    }
    const TickMessages tick =
        makeMessages(values, static_cast<int>(options.max_cbv), setup_.rigs());
    answers_ = TickAnswers(options.simulation_step);
    for (const ChannelId id : {ChannelId::kSelection, ChannelId::kEgoControl,
                               ChannelId::kCbvControl, ChannelId::kCbvRollout}) {
      for (const Topic& topic :
           topicsOf(channel(id), static_cast<int>(options.max_cbv), setup_.rigs())) {
        if (const AnyMessage message = tick.find(topic)) answers_.add(topic, message);
      }
    }
    last_ = tick.get<msgs::TrafficSnapshot>(ChannelId::kTraffic);
  }

  const msgs::TrafficSnapshot::ConstPtr& last() const { return last_; }

 private:
  Answer answerOf(const planning::PlannedAction& action, const session::TickRecord& record) const {
    const session::ScenarioOptions& options = setup_.options();
    Answer answer;
    answer.action = action;
    answer.planner =
        action.slot == kEgoSlot ? "ego:" + options.ego_planner : "cbv:" + options.cbv_planner;
    for (const session::PlannerLatency& latency : record.latencies) {
      if (latency.planner == answer.planner) answer.latency_ms = latency.milliseconds;
    }
    return answer;
  }

  const session::SessionSetup& setup_;
  ResultReserve& reserve_;
  TickAnswers answers_;
  msgs::TrafficSnapshot::ConstPtr last_;
};

session::SessionRequest shortSession() {
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = {"protocol.time_limit=2"};
  return request;
}

msgs::SessionInfo infoOf(const session::SessionSetup& setup, const fs::path& results) {
  msgs::SessionInfo info = toMsg(setup);
  info.deployment = "test";
  info.simulator_version = "SUMO";
  info.package_version = "test";
  info.results_folder = results.string();
  return info;
}

TEST(ResultReserve, ReplaysTheResultThatAWriterHadMade) {
  const test::TemporaryFolder folder;
  const fs::path reserved = folder.path() / "reserve";
  const session::SessionSetup setup(session::resolveRequest(shortSession()));
  {
    ResultReserve reserve(setup, infoOf(setup, reserved));
    session::ClosedLoop loop(setup);
    page::ResultWriter writer(setup, {"test", "SUMO", true}, folder.path() / "written");
    Feeder feeder(setup, reserve);
    loop.addObserver(writer);
    loop.addObserver(feeder);
    const std::atomic<bool> never{false};
    loop.run(never);
    writer.finish(1.0);
    EXPECT_TRUE(reserve.adopt(feeder.last(), 1.0));
    EXPECT_FALSE(reserve.adopt(feeder.last(), 1.0));  // file exit_code is there
    EXPECT_EQ(core::readFile(reserved / "exit_code", "exit code"),
              std::to_string(writer.exitCode()) + "\n");
  }
  EXPECT_FALSE(fs::exists(reserved / ".reserve"));
  EXPECT_EQ(withoutWallClock(summaryIn(reserved)),
            withoutWallClock(summaryIn(folder.path() / "written")));
  for (const char* file : {"trace.csv", "plans.csv"})
    EXPECT_EQ(core::readFile(reserved / file, "file"),
              core::readFile(folder.path() / "written" / file, "file"));
}

/// Two results of a session whose process ended: of all that its simulator had kept, and of the
/// most of that.
class ReservedResult : public ::testing::Test {
 protected:
  ReservedResult() : setup_(session::resolveRequest(shortSession())) {
    ResultReserve reserve(setup_, infoOf(setup_, kept()));
    session::ClosedLoop loop(setup_);
    page::ResultWriter writer(setup_, {"test", "SUMO", true}, written());
    Feeder feeder(setup_, reserve);
    loop.addObserver(writer);
    loop.addObserver(feeder);
    const std::atomic<bool> never{false};
    loop.run(never);
    writer.finish(1.0);
    exit_code_ = writer.exitCode();
    reserve.handOver(feeder.last());
    fs::copy(kept(), left(), fs::copy_options::recursive);
  }

  fs::path kept() const { return folder_.path() / "kept"; }
  fs::path written() const { return folder_.path() / "written"; }
  fs::path left() const { return folder_.path() / "left"; }
  std::optional<int> writeLeft() const {
    return writeReservedResult(left(), traffic::SessionStatus::kError,
                               {0, "session_nodelets", "it crashed"});
  }

  const test::TemporaryFolder folder_;
  const session::SessionSetup setup_;
  int exit_code_ = 0;  ///< of the writer
};

TEST_F(ReservedResult, IsTheOneThatAWriterHadMade) {
  EXPECT_EQ(writeLeft(), exit_code_);
  EXPECT_FALSE(fs::exists(left() / ".reserve"));
  nlohmann::json summary = withoutWallClock(summaryIn(left()));
  summary.erase("real_time_factor_reason");  // no session.yaml says when it began
  EXPECT_EQ(summary, withoutWallClock(summaryIn(written())));
  EXPECT_EQ(core::readFile(left() / "trace.csv", "file"),
            core::readFile(written() / "trace.csv", "file"));
}

TEST_F(ReservedResult, EndsWhereTheRecordDoesAndNamesWhy) {
  const fs::path bag = left() / ".reserve" / "session.bag";
  fs::resize_file(bag, 3 * fs::file_size(bag) / 4);
  EXPECT_EQ(writeLeft(), 2);
  const nlohmann::json summary = summaryIn(left());
  EXPECT_EQ(summary["status"], "error");
  EXPECT_GT(summary["simulated_seconds"], 0.0);
  EXPECT_LT(summary["simulated_seconds"], 2.0);
  EXPECT_EQ(summary["faults"].back()["source"], "session_nodelets");
  EXPECT_EQ(summary["faults"].back()["text"], "it crashed");
}

TEST_F(ReservedResult, NeedsATick) {
  fs::resize_file(left() / ".reserve" / "session.bag", 0);
  EXPECT_EQ(writeLeft(), std::nullopt);
  fs::remove(left() / ".reserve" / "session.bag");
  EXPECT_EQ(writeLeft(), std::nullopt);
}

msgs::TrafficSnapshot::ConstPtr brokenEnd(std::uint64_t tick) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.status = traffic::SessionStatus::kError;
  snapshot.faults = {{tick, "metrics_node", "the node left the session"}};
  return shared(toMsg(snapshot));
}

TEST(ResultReserve, NamesWhoEndedASessionBeforeItsFirstTick) {
  const test::TemporaryFolder folder;
  const session::SessionSetup setup(session::resolveRequest(shortSession()));
  ResultReserve reserve(setup, infoOf(setup, folder.path()));
  EXPECT_TRUE(reserve.adopt(brokenEnd(1), 0.5));
  const nlohmann::json summary = summaryIn(folder.path());
  EXPECT_EQ(summary["status"], "error");
  ASSERT_EQ(summary["faults"].size(), 1U) << summary["faults"];
  EXPECT_EQ(summary["faults"][0]["source"], "metrics_node");
  EXPECT_EQ(core::readFile(folder.path() / "exit_code", "exit code"), "2\n");
}

// Nobody writes there but us; a disk may still lose what was written.
TEST(ResultReserve, TicksThatCannotBeReadAgainCostTheTicksAlone) {
  const test::TemporaryFolder folder;
  const session::SessionSetup setup(session::resolveRequest(shortSession()));
  ResultReserve reserve(setup, infoOf(setup, folder.path()));
  traffic::TrafficSnapshot snapshot;
  reserve.keep(shared(toMsg(snapshot)), TickAnswers());
  fs::resize_file(folder.path() / ".reserve" / "session.bag.active", 0);
  EXPECT_TRUE(reserve.adopt(brokenEnd(1), 0.5));
  const nlohmann::json summary = summaryIn(folder.path());
  EXPECT_EQ(summary["status"], "error");
  ASSERT_EQ(summary["faults"].size(), 2U) << summary["faults"];
  EXPECT_EQ(summary["faults"][0]["source"], "result folder");
  EXPECT_EQ(summary["faults"][1]["source"], "metrics_node");
  EXPECT_EQ(core::readFile(folder.path() / "exit_code", "exit code"), "2\n");
}

TEST(ResultReserve, FullDiskCostsTheTicksButNotTheResult) {
  const test::TemporaryFolder folder;
  const session::SessionSetup setup(session::resolveRequest(shortSession()));
  ResultReserve reserve(setup, infoOf(setup, folder.path()));
  auto small = std::make_unique<test::SmallFiles>();
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles.resize(2000);
  for (std::uint64_t tick = 0; tick < 20; ++tick) {
    snapshot.tick = tick;
    reserve.keep(shared(toMsg(snapshot)), TickAnswers());
  }
  EXPECT_FALSE(fs::exists(folder.path() / ".reserve" / "session.bag.active"));
  EXPECT_TRUE(reserve.adopt(brokenEnd(20), 0.5));
  small.reset();
  const nlohmann::json faults = summaryIn(folder.path())["faults"];
  ASSERT_EQ(faults.size(), 2U) << faults;
  EXPECT_EQ(faults[0]["source"], "result folder");
  EXPECT_EQ(faults[1]["source"], "metrics_node");
}

}  // namespace
}  // namespace cdiff::node_graph
