// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/driving_score.h"
#include "metrics/metric_under_test.h"
#include "support/network_text.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::ego;
using test::snapshot;

traffic::VehicleState at(double x, double y, double speed) { return ego(x, y, speed).state; }

TEST(CollisionCounter, TakesTheSamePartnerWithinFiveSecondsAsOne) {
  CollisionCounter counter({});
  counter.observe(10.0, at(0, 0, 5), "a");
  counter.observe(14.9, at(20, 0, 5), "a");  // 4.9 s later, 20 m on
  EXPECT_EQ(counter.count(), 1U);
  counter.observe(15.0, at(20, 0, 5), "a");
  EXPECT_EQ(counter.count(), 2U);
  counter.observe(15.1, at(40, 0, 5), "b");  // another one
  EXPECT_EQ(counter.count(), 3U);
  EXPECT_EQ(counter.contacts(), 4U);
}

TEST(CollisionCounter, TakesContactsWithinFiveMetersAsOne) {
  CollisionCounter counter({});
  counter.observe(0.0, at(0, 0, 5), "a");
  counter.observe(60.0, at(4.9, 0, 5), "b");
  EXPECT_EQ(counter.count(), 1U);
  counter.observe(60.0, at(5.0, 0, 5), "b");
  EXPECT_EQ(counter.count(), 2U);
}

TEST(CollisionCounter, DoesNotChargeAStandingEgo) {
  CollisionCounter counter({});
  counter.observe(0.0, at(0, 0, 0.09), "a");
  EXPECT_EQ(counter.count(), 0U);
  // And does not remember it: the same partner and place are charged when the ego moves.
  counter.observe(0.1, at(0, 0, 0.1), "a");
  EXPECT_EQ(counter.count(), 1U);
  InfractionOptions charged;
  charged.collision_minimum_speed = 0.0;
  CollisionCounter all(charged);
  all.observe(0.0, at(0, 0, 0.0), "a");
  EXPECT_EQ(all.count(), 1U);
}

const test::LaneText kNarrow{3.2, 10.0, ""};

// Lanes of 3.2 m: east along y = 0, west along y = 3.2, one bridge east 8 m above y = 20.
map::RoadNetwork twoWays() {
  return test::NetworkText()
      .edge("east", {"0,0 100,0"}, "a", "b", kNarrow)
      .edge("west", {"100,3.2 0,3.2"}, "b", "a", kNarrow)
      .edge("bridge", {"0,20,8 100,20,8"}, "c", "d", kNarrow)
      .edge(":b_0", {"100,0 120,0"}, "", "", kNarrow)
      .network();
}

TEST(OutsideLanes, StartsHalfAMeterBeyondTheLane) {
  const map::RoadNetwork network = twoWays();
  EXPECT_FALSE(isOutsideLanes(network, at(50, -2.09, 5), {}));  // 1.6 + 0.5 = 2.1
  EXPECT_TRUE(isOutsideLanes(network, at(50, -2.11, 5), {}));
  EXPECT_TRUE(isOutsideLanes(network, at(50, -60, 5), {}));
  InfractionOptions strict;
  strict.outside_lane_margin = 0.0;
  EXPECT_TRUE(isOutsideLanes(network, at(50, -1.7, 5), strict));
}

TEST(OutsideLanes, KnowsTheWrongDirection) {
  const map::RoadNetwork network = twoWays();
  EXPECT_FALSE(isOutsideLanes(network, at(50, 1.5, 5), {}));  // nearer to the lane east
  EXPECT_TRUE(isOutsideLanes(network, at(50, 1.7, 5), {}));   // nearer to the lane west
  traffic::VehicleState turning = at(50, 3.2, 5);
  turning.heading = core::degreesToRadians(61.0);  // 119 degrees to the lane
  EXPECT_FALSE(isOutsideLanes(network, turning, {}));
  turning.heading = core::degreesToRadians(59.0);  // 121 degrees
  EXPECT_TRUE(isOutsideLanes(network, turning, {}));
}

TEST(OutsideLanes, AsksForNoDirectionInJunctions) {
  const map::RoadNetwork network = twoWays();
  traffic::VehicleState across = at(110, 0, 5);
  across.heading = core::kPi;
  EXPECT_FALSE(isOutsideLanes(network, across, {}));
}

TEST(OutsideLanes, RespectsLevels) {
  const map::RoadNetwork network = twoWays();
  traffic::VehicleState state = at(50, 20, 5);
  EXPECT_TRUE(isOutsideLanes(network, state, {}));  // on the ground below the bridge
  state.elevation = 8.0;
  EXPECT_FALSE(isOutsideLanes(network, state, {}));
}

TEST(OutsideLanes, IsAShareOfTheProgress) {
  const map::RoadNetwork network = twoWays();
  OutsideLanes outside(network, {});
  EXPECT_EQ(outside.percent(), 0.0);
  for (int i = 0; i < 8; ++i) outside.observe(at(i, 0, 5), 1.0);
  outside.observe(at(9, -3, 5), 2.0);
  outside.observe(at(9, -3, 5), 0.0);  // no progress, no share
  EXPECT_NEAR(outside.percent(), 20.0, 1e-12);
  EXPECT_EQ(outside.ticks(), 10U);
}

TEST(MinimumSpeed, ComparesMeansOnEveryStretch) {
  // Two stretches of 50 m. Background 4 and 8 (mean 6), then 12: first stretch (0, 40, 50 m) ego
  // 3, 3, 6 against 6, 6, 12: 12 / 24 = 50 %; the tick that reaches the checkpoint belongs to the
  // stretch. Second: 24 against 12 = 200 %.
  MinimumSpeed speed(100.0, 2);
  speed.observe(0.0, 3.0, snapshot(0, {background("a", 0, 0, 4), background("b", 0, 0, 8)}));
  speed.observe(40.0, 3.0, snapshot(1, {background("a", 0, 0, 4), background("b", 0, 0, 8)}));
  EXPECT_TRUE(speed.percents().empty());
  speed.observe(50.0, 6.0, snapshot(2, {background("a", 0, 0, 12), test::cbv("c", 0, 0, 90)}));
  EXPECT_EQ(speed.percents(), std::vector<double>({50.0}));
  speed.observe(94.9, 24.0, snapshot(3, {background("a", 0, 0, 12)}));
  EXPECT_EQ(speed.percents().size(), 1U);  // less than 95 % of the route
  speed.observe(95.1, 24.0, snapshot(4, {background("a", 0, 0, 12)}));
  EXPECT_EQ(speed.percents(), std::vector<double>({50.0, 200.0}));
}

TEST(MinimumSpeed, LeavesOutTicksAndStretchesWithoutMovingTraffic) {
  MinimumSpeed speed(100.0, 2);
  speed.observe(0.0, 1.0, snapshot(0, {}));
  speed.observe(50.0, 1.0, snapshot(1, {background("a", 0, 0, 0)}));
  EXPECT_TRUE(speed.percents().empty());
  speed.observe(60.0, 99.0, snapshot(2, {}));
  speed.observe(100.0, 5.0, snapshot(3, {background("a", 0, 0, 10)}));
  EXPECT_EQ(speed.percents(), std::vector<double>({50.0}));
}

TEST(MinimumSpeed, CountsAnUnfinishedStretchOnlyWhereItIsTheLast) {
  MinimumSpeed speed(100.0, 100);  // of 1 m each
  const auto traffic = snapshot(0, {background("a", 0, 0, 10)});
  for (double way = 0.0; way <= 96.0; way += 1.0) speed.observe(way, 5.0, traffic);
  const std::size_t whole = speed.percents().size();
  speed.observe(96.5, 5.0, traffic);
  EXPECT_EQ(speed.percents().size(), whole);
}

TEST(MinimumSpeed, WithoutCheckpointsMeasuresNothing) {
  MinimumSpeed speed(100.0, 0);
  speed.observe(100.0, 5.0, snapshot(0, {background("a", 0, 0, 10)}));
  EXPECT_TRUE(speed.percents().empty());
}

/// Shows a tick to a metric, with the ego `arc_length` [m] along its route.
void show(test::MetricUnderTest& metric, const traffic::TrafficSnapshot& snapshot,
          double arc_length) {
  MetricTick tick{snapshot, nullptr, snapshot.ego()};
  tick.ego_arc_length = arc_length;
  metric.observe(tick);
}

TEST(EgoInfractions, NamesWhatCannotOccurAndWhatIsUnknown) {
  test::MetricUnderTest score("ego_driving_score");
  EXPECT_EQ(score.at("ego_penalty").reason, "the ego was never seen");
  EXPECT_EQ(*score.at("ego_driving_score").value, 0.0);
  show(score, snapshot(0, {ego(10, 0, 5)}), 10.0);
  for (const char* name : {"pedestrian_collisions", "static_collisions", "scenario_timeouts",
                           "yields_failed", "red_lights", "stop_signs", "outside_lanes_percent",
                           "minimum_speed_missed", "minimum_speed_percent"}) {
    const Measure measure = score.at("ego_infraction_" + std::string(name));
    EXPECT_FALSE(measure.value.has_value()) << name;
    EXPECT_FALSE(measure.reason.empty()) << name;
  }
  EXPECT_EQ(*score.at("ego_infraction_vehicle_collisions").value, 0.0);
  EXPECT_EQ(score.at("ego_infraction_red_lights").reason, "no road network was given");
  EXPECT_EQ(*score.at("ego_penalty").value, 1.0);
}

// Two stretches of 50 m: at 3 m/s beside 6 m/s 50 %, at 20 beside 10 m/s 200 %: one of two is
// missed, 125 % on average. A contact with the same partner 0.05 s later belongs to the first.
TEST(EgoInfractions, ReportsSpeedsAndCollisionsWithTheirNumbers) {
  SessionMetricsOptions options;
  options.infractions.speed_checkpoints = 2;
  test::MetricUnderTest score("ego_driving_score", options);
  show(score, snapshot(0, {ego(50, 0, 3), background("a", 0, 0, 6)}), 50.0);
  show(score, snapshot(1, {ego(100, 0, 20), background("a", 0, 0, 10)}), 100.0);
  EXPECT_DOUBLE_EQ(*score.at("ego_infraction_minimum_speed_missed").value, 1.0);
  EXPECT_EQ(score.at("ego_infraction_minimum_speed_missed").n, 2U);
  EXPECT_DOUBLE_EQ(*score.at("ego_infraction_minimum_speed_percent").value, 125.0);
  EXPECT_EQ(score.at("ego_infraction_minimum_speed_percent").n, 2U);
  for (const std::uint64_t tick : {2, 3}) {
    const traffic::TrafficSnapshot at = snapshot(tick, {ego(100, 0, 5)});
    MetricTick contact{at, nullptr, at.ego()};
    contact.contacts = {{"a", {}, ""}, {"", {"b"}, ""}};
    score.observe(contact);
  }
  EXPECT_EQ(*score.at("ego_infraction_vehicle_collisions").value, 1.0);
  EXPECT_EQ(score.at("ego_infraction_vehicle_collisions").n, 2U);
}

// 80 m on the lane, then 20 m beside it; standing back is no progress.
TEST(EgoInfractions, TakesTheShareOutsideOfTheProgress) {
  const test::StraightRoad road;
  SessionMetricsOptions options;
  options.network = &road.network;
  test::MetricUnderTest score("ego_driving_score", options, &road.route);
  show(score, snapshot(0, {ego(0, 0, 5)}), 0.0);
  show(score, snapshot(1, {ego(80, 0, 5)}), 80.0);
  show(score, snapshot(2, {ego(100, -3, 5)}), 100.0);
  show(score, snapshot(3, {ego(90, -3, 5)}), 90.0);
  EXPECT_NEAR(*score.at("ego_infraction_outside_lanes_percent").value, 20.0, 1e-12);
  EXPECT_EQ(score.at("ego_infraction_outside_lanes_percent").n, 4U);
}

TEST(EgoInfractions, SurvivesValuesThatAreNotFinite) {
  const test::StraightRoad road;
  SessionMetricsOptions options;
  options.network = &road.network;
  test::MetricUnderTest score("ego_driving_score", options, &road.route);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  show(score, snapshot(0, {ego(nan, 0, nan), background("a", 0, 0, nan)}), 0.0);
  show(score, snapshot(1, {ego(10, 0, 5), background("a", 0, 0, 5)}), 10.0);
  EXPECT_EQ(*score.at("ego_penalty").value, 1.0);
  EXPECT_EQ(score.at("ego_penalty").n, 1U);
  EXPECT_EQ(*score.at("ego_infraction_outside_lanes_percent").value, 0.0);
}

}  // namespace
}  // namespace cdiff::metrics
