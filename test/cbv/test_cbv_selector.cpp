// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_selector.h"
#include "cbv/crossing_world.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::cbv {
namespace {

constexpr std::uint64_t kFirst = 52;  // 2.6 s
const double kTurn = std::sqrt(50.0);

TEST(CbvSelector, ScoreAndConflictPointOfATurningVehicle) {
  CrossingWorld world;
  const auto selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  const CbvAssignment& chosen = selection.assignments.front();
  EXPECT_EQ(chosen.vehicle_id, "a");
  EXPECT_EQ(chosen.slot, 0);
  EXPECT_EQ(chosen.selected_tick, kFirst);
  // Points lie every 4 m of x. To x: ego x - 70, candidate 25 + sqrt(50) + x - 110. The difference
  // of the distances is the same at all of them, 15 - sqrt(50) - 7.07... = sqrt(50) - 15; arrival
  // times are equal at x = 149.29: x = 148 is the best of the grid.
  const double cbv_distance = 25.0 + kTurn + 38.0;
  EXPECT_NEAR(chosen.conflict_point.position.x(), 148.0, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.position.y(), 0.0, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.ego_arc_length, 148.0, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.ego_distance, 78.0, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.cbv_distance, cbv_distance, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.ego_arrival, 7.8, 1e-9);
  EXPECT_NEAR(chosen.conflict_point.cbv_arrival, cbv_distance / 9.0, 1e-9);
  const double ds = cbv_distance - 78.0;
  const double dt = cbv_distance / 9.0 - 7.8;
  EXPECT_NEAR(chosen.interaction_score,
              std::exp(-ds * ds / 200.0) * std::exp(-dt * dt / 8.0) *
                  std::exp(-std::hypot(35.0, 30.0) / 40.0),
              1e-12);
}

TEST(CbvSelector, StandingVehiclesArriveAtTheLeastSpeed) {
  CrossingWorld world;
  const auto selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 0.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  // The longer the route, the larger the gap of arrival: the first point behind the turn, x = 112,
  // is best. 2 m/s.
  EXPECT_NEAR(selection.assignments[0].conflict_point.position.x(), 112.0, 1e-9);
  EXPECT_NEAR(selection.assignments[0].conflict_point.cbv_arrival, (27.0 + kTurn) / 2.0, 1e-9);
}

// Points at 100, 200 and, where the route ends, 290 m. To x the ego has x - 70 m at 10 m/s, "a" x -
// 77.93 m at 9.64 m/s: both arrive after 22.0 s at 290 m, at 200 m they are 0.34 s apart.
TEST(CbvSelector, TheEndOfTheEgosRouteIsExaminedToo) {
  CbvOptions options;
  options.sample_spacing = 100.0;
  options.ego_route_length = 220.0;
  options.interaction_radius = 1000.0;
  options.field_of_view = 180.0;
  CrossingWorld world(options);
  const auto selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.64)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  EXPECT_NEAR(selection.assignments[0].conflict_point.ego_arc_length, 290.0, 1e-9);
}

TEST(CbvSelector, ConflictAwareRouteIsConnectedThroughThePointAndLongEnough) {
  CrossingWorld world;
  const auto selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  const map::Route& route = selection.assignments[0].conflict_aware_route;
  EXPECT_NEAR((route.path().positionAt(0.0) - Eigen::Vector2d(105.0, -30.0)).norm(), 0.0, 1e-6);
  const auto at_point = route.path().project({148.0, 0.0});
  EXPECT_NEAR(at_point.distance, 0.0, 1e-6);
  // Routes round corners. Rounding a corner of 45 degrees over at most 3 m on each side saves at
  // most 6 (1 - cos 22.5) = 0.46 m, and there are two.
  EXPECT_NEAR(at_point.arc_length, 25.0 + kTurn + 38.0, 0.92);
  EXPECT_GE(route.length(), 160.0 - 1e-6);
  EXPECT_EQ(route.edges(), (std::vector<std::string>{"south", "east"}));
  for (std::size_t i = 1; i < route.lanes().size(); ++i) {
    const auto here = route.lanes()[i];
    const auto before = route.lanes()[i - 1];
    const auto& next = world.network.lane(before).next;
    EXPECT_TRUE(here == before || std::any_of(next.begin(), next.end(),
                                              [&](const auto& link) { return link.to == here; }));
  }
}

TEST(CbvSelector, RouteIsExtendedPastTheNextJunction) {
  CbvOptions options;
  options.route_length = 230.0;  // 25 + sqrt(50) + 190 = 222 m lead to the junction at x = 300
  CrossingWorld world(options);
  const auto selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  const map::Route& route = selection.assignments[0].conflict_aware_route;
  EXPECT_GE(route.length(), 230.0 - 1e-6);
  EXPECT_EQ(route.edges().back(), "further");
  EXPECT_FALSE(route.inJunctionAt(route.length()));
}

TEST(CbvSelector, NamesTheFirstGateThatFails) {
  CrossingWorld world;
  auto snapshot = crossingSnapshot(kFirst, 70.0, {});
  const auto add = [&](const std::string& id, const test::Motion& motion) {
    snapshot.vehicles.push_back(test::vehicle(id, motion));
  };
  add("far", {105.0, -50.0, 90.0, 5.0});          // hypot(35, 50) = 61 m
  add("near", {79.0, 0.0, 0.0, 5.0});             // 9 m
  add("above", {70.0, -20.0, 90.0, 5.0, 8.0});    // on the bridge
  add("below_bridge", {70.0, -20.0, 90.0, 5.0});  // there is only the bridge here, 8 m above
  add("beside", {105.0, -30.0, 0.0,
                 5.0});  // preview (107, -30) lies on the border, its centerline crosses the road
  add("wrong_way", {105.0, -36.0, -90.0, 5.0});  // against the lane
  add("askew", {105.5, -4.5, 75.0, 5.0});        // the turning lane runs at 45 degrees
  add("away", {40.0, 6.0, 180.0, 5.0});          // the ego's route lies behind it
  add("alley", {125.0, -12.0, 90.0, 5.0});
  add("early", {105.0, -16.0, 90.0, 5.0});  // 11 + sqrt(50) + x - 110 - (x - 70) = -21.9
  const auto selection = world.selector.update(snapshot);
  EXPECT_TRUE(selection.assignments.empty());
  EXPECT_EQ(reasonOf(selection, "far"), kTooFar);
  EXPECT_EQ(reasonOf(selection, "near"), kTooNear);
  EXPECT_EQ(reasonOf(selection, "above"), kOtherLevel);
  EXPECT_EQ(reasonOf(selection, "below_bridge"), kOffLane);
  EXPECT_EQ(reasonOf(selection, "beside"), kOffLane);
  EXPECT_EQ(reasonOf(selection, "wrong_way"), kOffLane);
  EXPECT_EQ(reasonOf(selection, "askew"), kJunctionHeading);
  EXPECT_EQ(reasonOf(selection, "away"), kOutOfView);
  EXPECT_EQ(reasonOf(selection, "alley"), kNoWay);
  EXPECT_EQ(reasonOf(selection, "early"), kDistanceMismatch);
  ASSERT_EQ(selection.rejected.size(), 10u);
  EXPECT_TRUE(
      std::is_sorted(selection.rejected.begin(), selection.rejected.end(),
                     [](const auto& a, const auto& b) { return a.vehicle_id < b.vehicle_id; }));
}

TEST(CbvSelector, NoConflictLiesBeyondATurnRound) {
  // Against the ego along y = 6, then back along its exit: 26 m to the turn, 11.7 m round it, x -
  // 110 m on; the ego has x - 80 m to go, so the distances differ by 7.7 m.
  for (const char direction : {'l', 't'}) {
    test::NetworkText text = crossingText();
    text.edge("oncoming", {"160,6 112,6"}, "v", "j").edge(":j_3", {"112,6 106,3 110,0"});
    text.connection("oncoming_0", "east_0", ":j_3_0", direction);
    CrossingWorld world({}, 2, text);
    const auto selection = world.selector.update(
        crossingSnapshot(kFirst, 80.0, {test::vehicle("a", {138.0, 6.0, 180.0, 9.0})}));
    EXPECT_EQ(selection.assignments.size(), direction == 'l' ? 1U : 0U);
    EXPECT_EQ(reasonOf(selection, "a"), direction == 'l' ? "" : kNoWay);
  }
}

TEST(CbvSelector, FieldOfViewIsAFullAngle) {
  // At the preview point (105, -28) looking north, the grid's points with x >= 112 lie at atan((x -
  // 105) / 28) >= 14.04 degrees on the right; those with a route from it are only these.
  CbvOptions options;
  options.field_of_view = 29.0;
  CrossingWorld wide(options);
  EXPECT_EQ(wide.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}))
                .assignments.size(),
            1u);
  options.field_of_view = 27.0;
  CrossingWorld narrow(options);
  EXPECT_EQ(
      reasonOf(narrow.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)})),
               "a"),
      kNoWay);
}

TEST(CbvSelector, BestScoresFillTheSlotsAndTiesGoById) {
  CrossingWorld world;
  // "b" and "c" mirror each other; "a" is farther off and arrives at another time.
  std::vector<traffic::Vehicle> others = {fromSouth("c", -30.0, 9.0), fromNorth("b", 30.0, 9.0),
                                          fromNorth("a", 40.0, 4.0)};
  const auto selection = world.selector.update(crossingSnapshot(kFirst, 70.0, others));
  ASSERT_EQ(selection.assignments.size(), 2u);
  EXPECT_EQ(selection.assignments[0].vehicle_id, "b");
  EXPECT_EQ(selection.assignments[1].vehicle_id, "c");
  EXPECT_EQ(selection.assignments[0].interaction_score, selection.assignments[1].interaction_score);
  EXPECT_EQ(reasonOf(selection, "a"), kOutranked);
  EXPECT_GT(selection.rejected.front().interaction_score, 0.0);
  EXPECT_LT(selection.rejected.front().interaction_score,
            selection.assignments[1].interaction_score);
  ASSERT_NE(selection.find(1), nullptr);
  EXPECT_EQ(selection.find(1)->vehicle_id, "c");
  EXPECT_EQ(selection.find(2), nullptr);
}

TEST(CbvSelector, OrderOfVehiclesDoesNotMatter) {
  std::vector<traffic::Vehicle> others = {fromSouth("c", -30.0, 9.0), fromNorth("b", 30.0, 9.0),
                                          fromNorth("a", 40.0, 4.0)};
  CrossingWorld first;
  CrossingWorld second;
  const auto forward = first.selector.update(crossingSnapshot(kFirst, 70.0, others));
  std::reverse(others.begin(), others.end());
  const auto backward = second.selector.update(crossingSnapshot(kFirst, 70.0, others));
  ASSERT_EQ(forward.assignments.size(), backward.assignments.size());
  for (std::size_t i = 0; i < forward.assignments.size(); ++i) {
    EXPECT_EQ(forward.assignments[i].vehicle_id, backward.assignments[i].vehicle_id);
    EXPECT_EQ(forward.assignments[i].interaction_score, backward.assignments[i].interaction_score);
  }
}

TEST(CbvSelector, RankingByNearness) {
  // The slow vehicle is nearer (20 m south) but arrives 10 s late: a lower score.
  const std::vector<traffic::Vehicle> others = {fromSouth("near", -20.0, 2.0),
                                                fromNorth("far", 30.0, 9.0)};
  CbvOptions options;
  CrossingWorld by_score(options, 1);
  EXPECT_EQ(
      by_score.selector.update(crossingSnapshot(kFirst, 70.0, others)).assignments.at(0).vehicle_id,
      "far");
  options.ranking = "nearest";
  CrossingWorld by_distance(options, 1);
  EXPECT_EQ(by_distance.selector.update(crossingSnapshot(kFirst, 70.0, others))
                .assignments.at(0)
                .vehicle_id,
            "near");
}

TEST(CbvSelector, RankingByTheGatesAloneGoesById) {
  // "m" is nearer and scores higher, "a" passes the gates, too; "A" is first by id but too far.
  const std::vector<traffic::Vehicle> others = {
      fromNorth("m", 22.0, 9.0), fromSouth("a", -40.0, 2.0), fromSouth("A", -70.0, 9.0)};
  const auto first = [&](const char* ranking) {
    CbvOptions options;
    options.ranking = ranking;
    CrossingWorld world(options, 1);
    const auto selection = world.selector.update(crossingSnapshot(kFirst, 70.0, others));
    return selection.assignments.at(0).vehicle_id;
  };
  EXPECT_EQ(first("gates"), "a");
  EXPECT_EQ(first("score"), "m");
  EXPECT_EQ(first("nearest"), "m");
}

TEST(CbvSelector, SelectsFromTheFirstTimeOnAndOncePerPeriod) {
  CrossingWorld world;
  const std::vector<traffic::Vehicle> one = {fromSouth("a", -30.0, 9.0)};
  EXPECT_TRUE(world.selector.update(crossingSnapshot(50, 70.0, one)).assignments.empty());  // 2.5 s
  EXPECT_TRUE(world.selector.update(crossingSnapshot(52, 70.0, {})).assignments.empty());   // 2.6 s
  const auto between = world.selector.update(crossingSnapshot(54, 70.0, one));              // 2.7 s
  EXPECT_TRUE(between.assignments.empty());
  EXPECT_TRUE(between.rejected.empty());
  EXPECT_EQ(world.selector.update(crossingSnapshot(56, 70.0, one)).assignments.size(),
            1u);  // 2.8 s
}

TEST(CbvSelector, PeriodDoesNotDriftWithRoundedTimes) {
  CbvOptions options;
  options.minimum_distance = 0.0;
  CrossingWorld world(options, 1);
  int selections = 0;
  for (std::uint64_t tick = 52; tick < 52 + 4000; tick += 2) {
    const auto selection =
        world.selector.update(crossingSnapshot(tick, 70.0, {test::vehicle("x", {0.0, 500.0})}));
    const bool due = (tick - 52) % 4 == 0;
    ASSERT_EQ(selection.rejected.size(), due ? 1u : 0u) << "tick " << tick;
    selections += due ? 1 : 0;
  }
  EXPECT_EQ(selections, 1000);
}

TEST(CbvSelector, VehicleOnTheRoadBelowABridgeIsNotPlacedOnTheBridge) {
  // At (70, 0) the bridge crosses 8 m above the ego's own road. A vehicle there at elevation 0 is
  // on "west".
  CrossingWorld world;
  auto snapshot = crossingSnapshot(kFirst, 50.0, {test::vehicle("low", {70.0, 0.0, 0.0, 10.0})});
  snapshot.vehicles.push_back(test::vehicle("high", {70.0, 0.0, 90.0, 10.0, 8.0}));
  snapshot.vehicles.push_back(
      test::vehicle("crosswise", {70.0, 2.0, 90.0, 10.0}));  // as on the bridge, but below it
  const auto selection = world.selector.update(snapshot);
  EXPECT_EQ(reasonOf(selection, "high"), kOtherLevel);
  EXPECT_EQ(reasonOf(selection, "low"), kDistanceMismatch);  // 20 m ahead at every point
  EXPECT_EQ(reasonOf(selection, "crosswise"), kOffLane);
}

TEST(CbvSelector, RefusesBadOptions) {
  CbvOptions options;
  options.ranking = "nearst";
  EXPECT_THROW(CrossingWorld{options}, core::InputError);
  options = {};
  options.sample_spacing = 0.0;
  EXPECT_THROW(options.validate(), core::InputError);
  options = {};
  options.minimum_distance = 60.0;
  EXPECT_THROW(options.validate(), core::InputError);
  EXPECT_THROW(CrossingWorld({}, -1), core::InputError);
}

TEST(CbvSelector, OptionsLoadFromYaml) {
  CbvOptions options;
  core::loadOptions({"cbv.yaml", "ranking: nearest\nperiod: 0.5\nlife_cycle: reselect\n"}, options);
  EXPECT_EQ(options.ranking, "nearest");
  EXPECT_EQ(options.period, 0.5);
  CbvOptions again;
  core::loadOptions({"dump", core::dumpOptions(options)}, again);
  EXPECT_EQ(core::dumpOptions(again), core::dumpOptions(options));
  EXPECT_THROW(core::loadOptions({"cbv.yaml", "perod: 0.5\n"}, options), core::InputError);
}

}  // namespace
}  // namespace cdiff::cbv
