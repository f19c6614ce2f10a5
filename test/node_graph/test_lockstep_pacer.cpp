// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/lockstep_pacer.h"
#include "node_graph/pacer_fixture.h"

namespace cdiff::node_graph {
namespace {

using Ticks = std::vector<std::uint64_t>;

class LockstepPacerTest : public test::PacerFixture {};

TEST_F(LockstepPacerTest, GoesOnWhenAnswersAreHere) {
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(4));
  select(4);
  control(4, kEgoSlot, "ego", 0.25);
  EXPECT_FALSE(pacer.wait());
  const TickInput input = pacer.advance();
  ASSERT_TRUE(input.selection);
  EXPECT_EQ(input.selection->tick, 4U);
  ASSERT_EQ(input.actions.size(), 1U);
  EXPECT_EQ(input.actions[0].action.throttle, 0.25);
  EXPECT_EQ(kept_, Ticks{4});
}

// Tick 25 needs the acknowledgement of tick 5, 20 ticks before it.
TEST_F(LockstepPacerTest, CountsWaitsForAnswersToTheTickThatStands) {
  using std::chrono::milliseconds;
  const AnswerWaits::Clock::time_point begin;
  AnswerWaits waits;
  waits.published(4, begin);
  waits.arrived(ChannelId::kSelection, 4, begin + milliseconds(2));
  waits.arrived(controlOf(0), 4, begin + milliseconds(5));
  waits.arrived(controlOf(1), 4, begin + milliseconds(7));  // the same channel: 6 ms in the mean
  waits.published(6, begin + milliseconds(10));
  waits.arrived(ChannelId::kSelection, 6, begin + milliseconds(14));
  waits.arrived(ChannelId::kSelection, 4, begin + milliseconds(19));  // late
  const std::map<std::string, double> expected = {{"cbv_K_control", 6.0}, {"cbv_selection", 3.0}};
  EXPECT_EQ(waits.means(), expected);
}

TEST_F(LockstepPacerTest, NamesTheObserverThatIsTooFarBehind) {
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(25));
  acknowledge(4);
  const auto end = pacer.wait();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->source, kMetricsNode);
  EXPECT_NE(end->text.find("metrics_node's acknowledgement of tick 5"), std::string::npos)
      << end->text;
  acknowledge(5);
  EXPECT_FALSE(pacer.wait());
}

TEST_F(LockstepPacerTest, WaitsAtTheEndForAllThatCameBefore) {
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(25));
  acknowledge(24);
  const auto end = pacer.waitForObservers();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->source, kMetricsNode);
  acknowledge(25);
  EXPECT_FALSE(pacer.waitForObservers());
}

TEST_F(LockstepPacerTest, NamesTheAnswerThatDoesNotCome) {
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(4));
  select(4);
  const auto end = pacer.wait();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->source, kEgoPlannerNode);
  EXPECT_NE(end->text.find("ego/control for tick 4 (ego_planner_node)"), std::string::npos)
      << end->text;
}

TEST_F(LockstepPacerTest, NothingMovesTheWorldBetweenDecisions) {
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(5));
  EXPECT_FALSE(pacer.wait());
  const TickInput input = pacer.advance();
  EXPECT_FALSE(input.selection);
  EXPECT_TRUE(input.actions.empty());
  EXPECT_EQ(kept_, Ticks{5});
}

TEST_F(LockstepPacerTest, RecordsADecisionOfAnExternalEgoOnce) {
  graph_.external_ego = true;
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(4));
  select(4);
  control(4, kEgoSlot, "ego", 0.25);
  EXPECT_FALSE(pacer.wait());
  EXPECT_EQ(records_, Ticks{4});
  pacer.close();
  EXPECT_EQ(records_, Ticks{4});
}

TEST_F(LockstepPacerTest, SendsTheSnapshotAgainToAnExternalEgoThatIsLate) {
  limit_ = 1.3;
  graph_.external_ego = true;
  LockstepPacer& pacer = make<LockstepPacer>(test::sampleOptions());
  pacer.published(snapshotAt(4));
  select(4);
  EXPECT_TRUE(pacer.wait());
  EXPECT_EQ(again_, Ticks{4});
}

}  // namespace
}  // namespace cdiff::node_graph
