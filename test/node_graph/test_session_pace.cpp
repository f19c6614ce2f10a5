// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A session at the pace of the wall clock whose planner is late at most decisions: what its result
// and its bag say is what drove.
#include "core/text.h"
#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/bags/replay.h"
#include "node_graph/messages/topics.h"
#include "node_graph/session_launch.h"
#include "support/random_model.h"

namespace cdiff {
namespace {

using Decision = ::e2e_cdiff::DecisionRecord;
using Vehicle = ::e2e_cdiff::DecidedVehicle;

/// What a bag holds, by tick.
struct Recording {
  std::map<std::uint64_t, ::e2e_cdiff::TrafficSnapshot::ConstPtr> snapshots;
  std::map<std::uint64_t, Decision::ConstPtr> decisions;
  std::map<std::pair<std::uint64_t, int>, ::e2e_cdiff::Rollout::ConstPtr> rollouts;
  std::size_t controls = 0;
  std::size_t selections = 0;

  explicit Recording(const fs::path& file) {
    rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
    for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
      if (const auto one = message.instantiate<::e2e_cdiff::TrafficSnapshot>())
        snapshots[one->tick] = one;
      if (const auto one = message.instantiate<Decision>()) decisions[one->tick] = one;
      if (const auto one = message.instantiate<::e2e_cdiff::Rollout>())
        rollouts[{one->tick, one->slot}] = one;
      controls += message.instantiate<::e2e_cdiff::ControlAction>() != nullptr;
      selections += message.instantiate<::e2e_cdiff::CbvSelection>() != nullptr;
    }
  }
};

/// Counts of the decisions' records.
struct Counts {
  std::size_t asked = 0;
  std::size_t late = 0;
  std::size_t answered = 0;
  std::size_t calls = 0;  ///< of the CBVs' planner
  std::size_t selections = 0;

  explicit Counts(const Recording& recording) {
    for (const auto& [tick, record] : recording.decisions) {
      bool called = false;
      ++asked;
      selections += record->selection_came;
      late += !record->selection_came || record->selection_lateness > 0.0;
      for (const Vehicle& vehicle : record->vehicles) {
        asked += vehicle.asked;
        answered += vehicle.answered;
        late += vehicle.asked && (!vehicle.answered || vehicle.lateness > 0.0);
        called = called || (vehicle.slot >= 0 && vehicle.answered);
      }
      calls += called;
    }
  }
};

/// Expects what drove a vehicle at a decision to be what the record says, and that to be the action
/// of the recorded plan.
void expectDriven(const Recording& recording, const Decision& record, const Vehicle& driven) {
  const auto after = recording.snapshots.find(record.tick + 1);
  if (after == recording.snapshots.end() || driven.driven_by == Vehicle::SIMULATOR) return;
  for (const ::e2e_cdiff::Vehicle& vehicle : after->second->vehicles) {
    if (vehicle.id != driven.vehicle_id || !vehicle.driven) continue;
    EXPECT_EQ(vehicle.throttle, driven.throttle) << vehicle.id << record.tick;
    EXPECT_EQ(vehicle.steer, driven.steer) << vehicle.id << record.tick;
    EXPECT_EQ(vehicle.brake, driven.brake) << vehicle.id << record.tick;
  }
  const auto plan = recording.rollouts.find({driven.plan_tick, driven.slot});
  if (driven.slot < 0 || driven.driven_by == Vehicle::FULL_BRAKE) return;
  ASSERT_NE(plan, recording.rollouts.end()) << "plan of tick " << driven.plan_tick;
  const std::size_t row = (record.tick - driven.plan_tick) / 2;  // a decision has two ticks, 0.1 s
  if (plan->second->points.empty()) return;                      // the planner braked
  EXPECT_EQ(plan->second->points.at(row).throttle, driven.throttle) << record.tick;
  EXPECT_EQ(plan->second->points.at(row).steer, driven.steer) << record.tick;
  EXPECT_EQ(plan->second->points.at(row).brake, driven.brake) << record.tick;
}

void expectWhatDroveIsRecorded(const Recording& recording) {
  const std::uint64_t last = recording.snapshots.rbegin()->first;
  for (const auto& [tick, snapshot] : recording.snapshots) {
    if (!snapshot->decision_tick) continue;
    ASSERT_EQ(recording.decisions.count(tick), 1U) << tick << " of " << last;
    for (const Vehicle& vehicle : recording.decisions.at(tick)->vehicles)
      expectDriven(recording, *recording.decisions.at(tick), vehicle);
  }
}

class PacedSession : public Session {
 protected:
  /// Four times real time leave 12.5 ms of wall time to an answer; a plan of 60 fp32 steps takes
  /// 30 at least, on a fast processor too.
  void drive() {
    const std::string model = testing::writeRandomModel(folder_ / "model");
    log_ = launch("e2e_cdiff session.launch",
                  "scenario:=crossing_left_turn seed:=2 record:=true cbv_planner:=diffusion "
                  "set:=\"protocol.time_limit=10 verdict.judge=false real_time_factor=4 "
                  "diffusion.sampler.steps=60 diffusion.precision=fp32 diffusion.model=" +
                      model + "\"");
    ASSERT_TRUE(fs::exists(results() / "session.bag")) << log_;
    fs::rename(results(), live());
  }
  fs::path live() const { return folder_ / "live"; }
  std::string log_;
};

TEST_F(PacedSession, RecordsCountsAndTimesLateAnswersAndReplaysToTheSame) {
  drive();
  const nlohmann::json live_summary = summaryIn(live());
  const Recording recording(live() / "session.bag");
  const Counts counts(recording);
  expectWhatDroveIsRecorded(recording);
  EXPECT_GT(counts.late, 20U) << log_;
  EXPECT_EQ(live_summary["late_answers"]["count"], counts.late);
  EXPECT_EQ(recording.snapshots.rbegin()->second->late_answers, counts.late);
  std::size_t asked = 0;
  for (const auto& [planner, measures] : live_summary["late_answers"]["planners"].items())
    asked += measures["asked"].get<std::size_t>();
  EXPECT_EQ(asked, counts.asked);
  EXPECT_EQ(live_summary["planner_latency_ms"]["cbv:diffusion"]["n"], counts.calls);
  EXPECT_EQ(recording.controls, counts.answered);
  EXPECT_EQ(recording.selections, counts.selections);
  EXPECT_NE(core::readFile(live() / "report.html", "report").find("Answers came late"),
            std::string::npos);
  EXPECT_NE(log_.find("late answers"), std::string::npos) << log_;
  EXPECT_NE(core::readFile(live() / "session.yaml", "session").find("deterministic: false"),
            std::string::npos);

  const node_graph::ReplayResult offline =
      node_graph::replayBag(live() / "session.bag", folder_ / "offline");
  EXPECT_EQ(core::joinText(offline.findings, "; "), "");
  expectSameResult(folder_ / "offline", live());
  const std::string replay_log =
      launch("e2e_cdiff replay.launch", "rate:=0 bag:=" + (live() / "session.bag").string());
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << replay_log;
  expectSameResult(results(), live());

  // As an earlier version recorded it: without records of decisions.
  const fs::path earlier = folder_ / "earlier.bag";
  test::editBag(live() / "session.bag", earlier, [](const auto& message, rosbag::Bag& to) {
    if (message.getTopic() != "/decision_record") test::keep(message, to);
  });
  const node_graph::ReplayResult replayed = node_graph::replayBag(earlier, folder_ / "earlier");
  EXPECT_EQ(core::joinText(replayed.findings, "; "), "");
  EXPECT_EQ(summaryIn(folder_ / "earlier")["trace_sha256"], live_summary["trace_sha256"]);
}

}  // namespace
}  // namespace cdiff
