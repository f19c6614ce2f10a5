// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "node_graph/lockstep/wall_clock_pacer.h"
#include "node_graph/pacer_fixture.h"

namespace cdiff::node_graph {
namespace {

using Ticks = std::vector<std::uint64_t>;

class WallClockPacerTest : public test::PacerFixture {
 protected:
  WallClockPacerTest() {
    graph_.paced = true;
    options_.real_time_factor = 10.0;
    limit_ = 2.0;
  }
  session::ScenarioOptions options_ = test::sampleOptions();
};

TEST_F(WallClockPacerTest, TickEndsWithoutAnswersWhenItsTimeHasCome) {
  WallClockPacer& pacer = make<WallClockPacer>(options_);
  pacer.published(snapshotAt(0));
  EXPECT_FALSE(pacer.wait());
  EXPECT_GE(pacer.elapsed(), 0.005);  // 0.05 s at ten times real time
  const TickInput input = pacer.advance();
  EXPECT_FALSE(input.selection);
  EXPECT_EQ(kept_, Ticks());  // its answers may still come
  pacer.close();
  EXPECT_EQ(records_, Ticks{0});
  EXPECT_EQ(kept_, Ticks{0});
  EXPECT_EQ(pacer.late(), 2U);  // selection and ego
  EXPECT_FALSE(faults_.empty());
}

TEST_F(WallClockPacerTest, FaultsSayWhatDroveFirstAndThenThatTheVehicleBraked) {
  WallClockPacer& pacer = make<WallClockPacer>(options_);
  pacer.published(snapshotAt(0));
  select(0);
  control(0, kEgoSlot, "ego", 0.25);
  pacer.advance();
  for (std::uint64_t tick = 1; tick < 30; ++tick) {  // 1.5 s of silence
    pacer.published(snapshotAt(tick));
    if (tick % 2 == 0) select(tick);
    pacer.advance();
  }
  pacer.close();
  const auto count = [&](const char* text) {
    return std::count_if(faults_.begin(), faults_.end(), [&](const std::string& fault) {
      return fault.find("vehicle 'ego'") != std::string::npos &&
             fault.find(text) != std::string::npos;
    });
  };
  EXPECT_EQ(count("by the plan of tick 0"), 1);
  EXPECT_EQ(count("braked fully"), 1);
}

TEST_F(WallClockPacerTest, PunctualAnswersMoveTheWorldAndAreNotLate) {
  WallClockPacer& pacer = make<WallClockPacer>(options_);
  pacer.published(snapshotAt(0));
  select(0);
  control(0, kEgoSlot, "ego", 0.25);
  EXPECT_FALSE(pacer.wait());
  const TickInput input = pacer.advance();
  ASSERT_TRUE(input.selection);
  ASSERT_EQ(input.actions.size(), 1U);
  EXPECT_EQ(input.actions[0].action.throttle, 0.25);
  EXPECT_EQ(records_, Ticks{0});
  EXPECT_EQ(kept_, Ticks{0});
  EXPECT_EQ(pacer.late(), 0U);
}

TEST_F(WallClockPacerTest, ControlOfACbvCountsWithItsRollout) {
  WallClockPacer& pacer = make<WallClockPacer>(options_);
  pacer.published(snapshotAt(54));  // "bg_1" is the CBV of slot 0
  control(54, 0, "bg_1", 0.5);
  const auto throttle = [&] {
    for (const planning::PlannedAction& action : pacer.advance().actions) {
      if (action.vehicle_id == "bg_1") return action.action.throttle;
    }
    return -1.0;
  };
  EXPECT_NE(throttle(), 0.5);
  msgs::Rollout rollout;
  rollout.tick = 54;
  rollout.slot = 0;
  rollout.vehicle_id = "bg_1";
  pacer.take({ChannelId::kCbvRollout, 0}, shared(rollout));
  pacer.published(snapshotAt(55));
  EXPECT_EQ(throttle(), 0.5);
}

TEST_F(WallClockPacerTest, ASilentNodeEndsTheSession) {
  WallClockPacer& pacer = make<WallClockPacer>(options_);
  participants_.note(test::ackOf(kMetricsNode, msgs::TickAck::ALIVE),
                     Pacer::Clock::now() - std::chrono::seconds(3));
  EXPECT_TRUE(pacer.silentFor(20.0));   // 2 s of wall time
  EXPECT_FALSE(pacer.silentFor(60.0));  // 6 s
  pacer.published(snapshotAt(5));
  const auto end = pacer.wait();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->source, kMetricsNode);
  EXPECT_EQ(end->text, "nothing came for 2 s: a sign of life of metrics_node");
}

}  // namespace
}  // namespace cdiff::node_graph
