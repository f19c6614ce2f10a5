// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "node_graph/lockstep/decision_tracker.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/sample_messages.h"

namespace cdiff::node_graph {
namespace {

using msgs::DecidedVehicle;
using test::controlFor;
using test::selectionFor;

/// Ego, "bg_7" as CBV of slot 1, "bg_9" in the background; decisions every second tick of 0.05 s.
msgs::TrafficSnapshot::ConstPtr snapshotAt(std::uint64_t tick) {
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
  snapshot.decision_tick = tick % 2 == 0;
  return boost::make_shared<const msgs::TrafficSnapshot>(toMsg(snapshot));
}

/// Three actions, 0.1 s apart, the first that of controlFor.
msgs::Rollout::Ptr planFor(std::uint64_t tick) {
  auto plan = boost::make_shared<msgs::Rollout>();
  plan->tick = tick;
  plan->slot = 1;
  plan->vehicle_id = "bg_7";
  plan->points.resize(3);
  plan->points[0].throttle = 0.25;
  plan->points[1].throttle = 0.5;
  plan->points[2].brake = 0.125;
  return plan;
}

const AppliedAction& of(const std::vector<AppliedAction>& applied, const std::string& vehicle) {
  for (const AppliedAction& action : applied) {
    if (action.planned.vehicle_id == vehicle) return action;
  }
  throw std::runtime_error("no action for " + vehicle);
}

TEST(PacedAnswers, HoldsTheNewestActionForHalfASecondThenBrakes) {
  TickAnswers answers;
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  const PacedAnswers paced(0.05);
  const auto at = [&](std::uint64_t tick) {
    return of(paced.actions(*snapshotAt(tick), std::nullopt, answers), "ego");
  };
  EXPECT_EQ(at(5).driven_by, DecidedVehicle::ANSWER);  // between decisions
  EXPECT_EQ(at(6).driven_by, DecidedVehicle::PLAN);
  EXPECT_EQ(at(13).planned.action.throttle, 0.25);  // (13 - 4) x 0.05 s old: still held
  EXPECT_EQ(at(13).plan_tick, 4U);
  EXPECT_EQ(at(14).planned.action, traffic::ControlAction::failSafe());  // 0.5 s old
  EXPECT_EQ(at(14).driven_by, DecidedVehicle::FULL_BRAKE);
}

TEST(PacedAnswers, DrivesOnByTheNextActionsOfThePlan) {
  TickAnswers answers;
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  answers.add({ChannelId::kCbvRollout, 1}, planFor(4));
  const PacedAnswers paced(0.05);
  const auto at = [&](std::uint64_t tick) {
    return of(paced.actions(*snapshotAt(tick), std::nullopt, answers), "bg_7").planned.action;
  };
  EXPECT_EQ(at(5), (traffic::ControlAction{0.25, 0.0, 0.0}));  // 0.05 s: the first still
  EXPECT_EQ(at(6), (traffic::ControlAction{0.5, 0.0, 0.0}));
  EXPECT_EQ(at(9), (traffic::ControlAction{0.0, 0.0, 0.125}));  // 0.25 s: row 2
  EXPECT_EQ(at(10), (traffic::ControlAction{0.25, 0.0, 0.0}));  // beyond the plan: held
}

TEST(PacedAnswers, TakesAVehicleOverWhenItsFirstActionHasCome) {
  TickAnswers answers;
  PacedAnswers paced(0.05);
  EXPECT_FALSE(paced.selection(*snapshotAt(4), answers).has_value());
  answers.add(ChannelId::kSelection, selectionFor(4, 0, "bg_9"));
  ASSERT_TRUE(
      paced.selection(*snapshotAt(4), answers).has_value());  // it has arrived: releases count
  EXPECT_FALSE(paced.selection(*snapshotAt(5), answers).has_value());
  answers.add({ChannelId::kCbvControl, 0}, controlFor(4, 0, "bg_9"));
  const auto taken = paced.selection(*snapshotAt(6), answers);
  ASSERT_TRUE(taken.has_value());
  ASSERT_EQ(taken->assignments.size(), 1U);
  const AppliedAction first = of(paced.actions(*snapshotAt(6), taken, answers), "bg_9");
  EXPECT_EQ(first.driven_by, DecidedVehicle::PLAN);
  EXPECT_EQ(first.plan_tick, 4U);
}

/// A session in which one planner answers late.
class LateSession : public testing::Test {
 protected:
  LateSession() : tracker_(options()), paced_(0.05) {}
  static session::ScenarioOptions options() {
    session::ScenarioOptions options;
    options.ego_planner = "sample";
    options.cbv_planner = "sample";
    return options;
  }
  void arrive(int slot, std::uint64_t tick, double now) {
    if (slot == DecisionTracker::kSelection)
      answers_.add(ChannelId::kSelection, selectionFor(tick, 1, "bg_7"));
    if (slot == -1) answers_.add(ChannelId::kEgoControl, controlFor(tick, -1, "ego"));
    if (slot == 1) answers_.add({ChannelId::kCbvControl, 1}, controlFor(tick, 1, "bg_7"));
    tracker_.arrived(slot, tick, now);
  }
  std::vector<msgs::DecisionRecord::ConstPtr> end(std::uint64_t tick, double now) {
    const auto snapshot = snapshotAt(tick);
    const auto taken = paced_.selection(*snapshot, answers_);
    tracker_.ended(tick, paced_.actions(*snapshot, taken, answers_), now);
    return tracker_.settle(answers_, tick, false);
  }
  DecisionTracker tracker_;
  PacedAnswers paced_;
  TickAnswers answers_;
};

TEST_F(LateSession, RecordSaysWhatDroveAndHowLateTheAnswerCame) {
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 10.01);
  arrive(-1, 4, 10.02);
  EXPECT_TRUE(end(4, 10.05).empty());  // the CBV's answer is awaited
  arrive(1, 4, 10.08);
  const auto records = end(5, 10.10);
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0]->tick, 4U);
  EXPECT_TRUE(records[0]->selection_came);
  EXPECT_EQ(records[0]->selection_lateness, 0.0);
  ASSERT_EQ(records[0]->vehicles.size(), 2U);
  EXPECT_EQ(records[0]->vehicles[0].lateness, 0.0);
  EXPECT_EQ(records[0]->vehicles[0].driven_by, DecidedVehicle::ANSWER);
  const DecidedVehicle& cbv = records[0]->vehicles[1];
  EXPECT_EQ(cbv.driven_by, DecidedVehicle::FULL_BRAKE);  // at tick 4 there was no plan
  EXPECT_EQ(cbv.brake, 1.0);
  EXPECT_TRUE(cbv.answered);
  EXPECT_TRUE(cbv.answer_drove);          // from tick 5 on
  EXPECT_NEAR(cbv.lateness, 0.03, 1e-9);  // 10.08 - 10.05
  EXPECT_EQ(cbv.answer.planner_latency_ms, 1.5);
  EXPECT_EQ(tracker_.late(), 1U);
  const auto texts = latenessTexts(*records[0]);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_NE(texts.at({"cbv:sample", true}).find("came 0.030 s after its time"), std::string::npos);
}

TEST_F(LateSession, RecordCutsWhatAPlannerOfOthersIsCalledAndSays) {
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 10.01);
  arrive(1, 4, 10.02);
  const auto control = controlFor(4, -1, "ego");
  control->planner = control->fault = std::string(1'000'000, 'x');
  answers_.add(ChannelId::kEgoControl, control);
  tracker_.arrived(-1, 4, 10.02);
  const auto records = end(4, 10.05);
  ASSERT_EQ(records.size(), 1U);
  const msgs::ControlAction& answer = records[0]->vehicles[0].answer;
  for (const std::string& text : {answer.planner, answer.fault}) {
    EXPECT_GT(text.size(), 10U);
    EXPECT_LT(text.size(), 10000U);
  }
}

TEST_F(LateSession, DecisionThatAPlannerLeftOutIsSettledByItsNextAnswer) {
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 10.01);
  arrive(-1, 4, 10.02);
  end(4, 10.05);
  end(5, 10.10);
  tracker_.open(snapshotAt(6));
  arrive(DecisionTracker::kSelection, 6, 10.11);
  arrive(-1, 6, 10.11);
  arrive(1, 6, 10.12);
  const auto records = end(6, 10.15);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_FALSE(records[0]->vehicles[1].answered);
  EXPECT_EQ(records[0]->vehicles[1].answer.planner, "cbv:sample");
  EXPECT_EQ(records[1]->vehicles[1].driven_by, DecidedVehicle::ANSWER);
  EXPECT_EQ(tracker_.late(), 1U);
}

TEST_F(LateSession, AnswerThatIsTooOldToDriveIsTimedButNoActionThatDrove) {
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 10.01);
  arrive(-1, 4, 10.02);
  end(4, 10.05);
  for (std::uint64_t tick = 5; tick < 15; ++tick) end(tick, 10.0);
  arrive(1, 4, 10.59);
  const auto records = end(15, 10.60);  // 0.55 s after its decision
  ASSERT_EQ(records.size(), 1U);
  EXPECT_FALSE(records[0]->vehicles[1].answer_drove);
  answers_.add(ChannelId::kDecisionRecord, records[0]);
  const std::vector<Answer> given = answers_.answers(*snapshotAt(4));
  ASSERT_EQ(given.size(), 2U);
  EXPECT_EQ(actionsOf(given).size(), 1U);    // the ego's
  EXPECT_EQ(latenciesOf(given).size(), 2U);  // of both planners
}

TEST_F(LateSession, SilentPlannerIsGivenUpAfterTenSeconds) {
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 0.01);
  arrive(1, 4, 0.02);
  for (std::uint64_t tick = 4; tick <= 204; ++tick) EXPECT_TRUE(end(tick, 0.05).empty()) << tick;
  const auto records = end(205, 0.05);  // (205 - 4) x 0.05 s > 10 s
  ASSERT_EQ(records.size(), 1U);
  EXPECT_FALSE(records[0]->vehicles[0].answered);
}

TEST_F(LateSession, RecordSaysWhatObserversWaitFor) {
  SessionGraph paced;
  paced.paced = true;
  TickAnswers observed(0.05, awaitedBy(Party::kMetrics, paced));
  EXPECT_EQ(namesOf(observed.missing(*snapshotAt(4))), std::vector<std::string>{"decision_record"});
  tracker_.open(snapshotAt(4));
  arrive(DecisionTracker::kSelection, 4, 10.01);
  arrive(-1, 4, 10.02);
  arrive(1, 4, 10.02);
  observed.add(ChannelId::kDecisionRecord, end(4, 10.05).at(0));
  EXPECT_EQ(namesOf(observed.missing(*snapshotAt(4))),
            (std::vector<std::string>{"cbv/selection", "cbv_1/rollout"}));
  observed.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  observed.add({ChannelId::kCbvRollout, 1}, planFor(4));
  EXPECT_TRUE(observed.missing(*snapshotAt(4)).empty());
  EXPECT_EQ(observed.answers(*snapshotAt(4)).size(), 2U);  // the controls are the record's
}

TEST(Latencies, PlannerThatReportsNoneHasNone) {
  std::vector<Answer> answers(2);
  answers[0].planner = "ego:external";
  answers[1].planner = "cbv:sample";
  answers[1].latency_ms = 2.0;
  const auto latencies = latenciesOf(answers);
  ASSERT_EQ(latencies.size(), 1U);
  EXPECT_EQ(latencies[0].planner, "cbv:sample");
}

}  // namespace
}  // namespace cdiff::node_graph
