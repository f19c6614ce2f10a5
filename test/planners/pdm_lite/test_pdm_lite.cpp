// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "planners/course.h"
#include "planners/pdm_lite/pdm_lite.h"

namespace cdiff::planners {
namespace {

using testing::ClosedLoop;
using testing::leftBend;
using testing::makeNetwork;
using testing::routeAlong;
using testing::straight;
using testing::vehicleAt;

double distanceFromRoute(const map::Route& route, const traffic::Vehicle& vehicle) {
  return route.path().project(vehicle.state.position).distance;
}

TEST(PdmLite, ReachesTheTargetSpeedAndKeepsAStraightLane) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 0.1, 0.0, 0.0), route);
  loop.run(3.0);
  // Full throttle gives 7.6 to 5.5 m/s^2: 8 m/s within 2 s.
  EXPECT_NEAR(loop.vehicle(0).state.speed, 8.0, 0.15);
  double worst_speed = 0.0;
  double worst_offset = 0.0;
  loop.run(20.0, [&] {
    worst_speed = std::max(worst_speed, std::abs(loop.vehicle(0).state.speed - 8.0));
    worst_offset = std::max(worst_offset, distanceFromRoute(route, loop.vehicle(0)));
  });
  EXPECT_LT(worst_speed, 0.25);
  EXPECT_LT(worst_offset, 0.2);
  RecordProperty("worst_speed_error_mps", std::to_string(worst_speed));
  RecordProperty("worst_offset_m", std::to_string(worst_offset));
}

TEST(PdmLite, KeepsItsLaneInATwelveMeterBend) {
  const auto network = makeNetwork({{"bend", leftBend(60.0, 12.0, 60.0)}});
  const map::Route route = routeAlong(network, {"bend"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 0.0), route);
  double worst = 0.0;
  loop.run(16.0, [&] { worst = std::max(worst, distanceFromRoute(route, loop.vehicle(0))); });
  EXPECT_GT(loop.vehicle(0).state.position.y(), 40.0);
  EXPECT_LT(worst, 0.6);
  RecordProperty("worst_offset_m", std::to_string(worst));
}

TEST(PdmLite, ComesBackToItsLaneFromTwoMetersBeside) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 2.0, 0.0, 8.0), route);
  loop.run(3.0);
  double worst = 0.0;
  loop.run(10.0, [&] { worst = std::max(worst, distanceFromRoute(route, loop.vehicle(0))); });
  EXPECT_LT(worst, 0.2);
}

TEST(PdmLite, DrivesBeyondTheEndOfItsRouteAndStops) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 60.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route);
  double hardest = 0.0;
  loop.run(15.0, [&] { hardest = std::max(hardest, loop.actions()[0].action.brake); });
  EXPECT_EQ(loop.vehicle(0).state.speed, 0.0);
  // 8 m/s within 5 + 1 m: 64 / 12 = 5.3 m/s^2, two thirds of the brake, if it starts exactly there;
  // 0.8 m later 6.2.
  EXPECT_NEAR(loop.vehicle(0).state.position.x(), 61.0, 0.9);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 60.0);
}

TEST(PdmLite, CrawlsToTheEndWhenItStandsShortOfIt) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 60.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 57.0, 0.0, 0.0, 0.0), route);
  double fastest = 0.0;
  loop.run(8.0, [&] { fastest = std::max(fastest, loop.vehicle(0).state.speed); });
  EXPECT_GE(loop.vehicle(0).state.position.x(), 60.0);
  EXPECT_LT(loop.vehicle(0).state.position.x(), 61.5);
  EXPECT_LT(fastest, 1.8);
}

TEST(PdmLite, RolloutIsTheForecastWithoutHazards) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 0.0), route);
  loop.advance();
  const planning::PlannedAction planned = loop.actions().front();
  EXPECT_EQ(planned.vehicle_id, "ego");
  EXPECT_EQ(planned.slot, -1);
  ASSERT_EQ(planned.rollout.size(), 20u);
  // On a free road the first point is what then happens.
  EXPECT_EQ(planned.rollout.front().action, planned.action);
  EXPECT_EQ(planned.rollout.front().state.position, loop.vehicle(0).state.position);
  EXPECT_EQ(planned.rollout.front().state.speed, loop.vehicle(0).state.speed);
}

TEST(PdmLite, StuckVehicleGetsFullThrottleAfter8AndAHalfSeconds) {
  // A wall of a car across the road 6 m ahead: the box rule holds the ego; the published rule then
  // pushes once.
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 0.0), route);
  loop.add(vehicleAt("wall", 13.0, 0.0, 0.5 * core::kPi, 0.0));
  for (int decision = 1; decision <= 84; ++decision) {
    loop.advance();
    ASSERT_EQ(loop.actions()[0].action.brake, 1.0) << decision;
  }
  loop.advance();
  EXPECT_EQ(loop.actions()[0].action.throttle, 1.0);
  EXPECT_EQ(loop.actions()[0].action.brake, 0.0);
  loop.advance();
  EXPECT_EQ(loop.actions()[0].action.brake, 1.0);
}

TEST(PdmLite, RefusesTasksWithoutVehicleOrRoute) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  const traffic::Vehicle ego = vehicleAt("ego", 5.0, 0.0, 0.0, 0.0);
  EXPECT_THROW(loop.planner().plan({}, {{0, nullptr, &route, 8.0}}), std::invalid_argument);
  EXPECT_THROW(loop.planner().plan({}, {{0, &ego, nullptr, 8.0}}), std::invalid_argument);
  EXPECT_TRUE(loop.planner().plan({}, {}).empty());
}

TEST(PdmLite, ForgetsVehiclesThatAreNoLongerAsked) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  ClosedLoop loop(network);
  const traffic::Vehicle ego = vehicleAt("ego", 5.0, 0.3, 0.0, 5.0);
  const traffic::TrafficSnapshot snapshot;
  const std::vector<planning::PlanningTask> tasks = {{-1, &ego, &route, 8.0}};
  const auto fresh = loop.planner().plan(snapshot, tasks).front().action;
  const auto second = loop.planner().plan(snapshot, tasks).front().action;
  EXPECT_NE(fresh.steer, second.steer);  // the derivative term remembers
  loop.planner().plan(snapshot, {});
  EXPECT_EQ(loop.planner().plan(snapshot, tasks).front().action, fresh);
}

/// Speed after 12 s on a free, straight road; `slot` -1 is the ego.
double freeSpeed(const PdmLiteOptions& options, std::uint64_t seed, int slot) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::DrivableArea area(network);
  const map::Route route = routeAlong(network, {"road"});
  PdmLite planner(options, {}, {network, area, seed});
  const dynamics::BicycleModel model{dynamics::BicycleModelOptions()};
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("car", 5.0, 0.0, 0.0, 0.0)};
  for (int decision = 0; decision < 120; ++decision) {
    planning::PlanningTask task;
    task.slot = slot;
    task.vehicle = &snapshot.vehicles[0];
    task.route = &route;
    const auto actions = planner.plan(snapshot, {task});
    for (int step = 0; step < 2; ++step) {
      traffic::VehicleState& state = snapshot.vehicles[0].state;
      state = model.step(state, actions[0].action, 0.05);
    }
  }
  return snapshot.vehicles[0].state.speed;
}

TEST(PdmLite, GivesCbvsDriversOfTheirOwnWhereAsked) {
  // The factor is that of the stream "driver": 8 m/s x (1 + .2 z). The pedals swing by up to half a
  // meter per second around faster targets.
  PdmLiteOptions spread;
  spread.cbv_speed_spread = 0.2;
  const core::RandomKey key{core::hashText("car"), 0, 0};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const double z = core::RandomStream(seed, "driver").normal(key, 0);
    EXPECT_NEAR(freeSpeed(spread, seed, 0), 8.0 * (1.0 + 0.2 * z), 0.5) << "z " << z;
    EXPECT_EQ(freeSpeed(spread, seed, -1), freeSpeed({}, seed, -1));  // the ego keeps its own
  }
  EXPECT_NE(freeSpeed(spread, 1, 0), freeSpeed(spread, 2, 0));
  EXPECT_EQ(freeSpeed({}, 1, 0), freeSpeed({}, 2, 0));
}

// However far a driver's draw lies out, the factor is 0.5 to 1.5: 4 or 12 m/s, with pedals that
// swing by half a meter per second. At 0.5 a draw beyond 1.2 would make it 1.6 or 0.4.
TEST(PdmLite, KeepsDriversBetweenHalfAndOneAndAHalfTimesTheirSpeed) {
  PdmLiteOptions spread;
  spread.cbv_speed_spread = 0.5;
  const core::RandomKey key{core::hashText("car"), 0, 0};
  int fast = 0, slow = 0;
  for (std::uint64_t seed = 1; seed < 60 && (fast == 0 || slow == 0); ++seed) {
    const double z = core::RandomStream(seed, "driver").normal(key, 0);
    if (std::abs(z) < 1.2 || (z > 0.0 ? fast : slow) > 0) continue;
    ++(z > 0.0 ? fast : slow);
    EXPECT_NEAR(freeSpeed(spread, seed, 0), z > 0.0 ? 12.0 : 4.0, 0.5) << "z " << z;
  }
  EXPECT_EQ(fast + slow, 2);
}

/// The first decision 14.5 m behind a leader, both at 7 m/s, with a longer time headway. The boxes
/// are 10 m apart: 1.2 m/s (1 - (7 / 8)^4 - ((4 + 7 T) / 10)^2) is a gain of 0.10 m/s at T = 0.25 s
/// and of 0.05 m/s at 0.30 s, for both of which there is a throttle between 0 and 1.
traffic::ControlAction actionBehind(const PdmLiteOptions& options, int slot, double longer) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  const map::DrivableArea area(network);
  const map::Route route = routeAlong(network, {"road"});
  DrivingStyle style;
  style.time_headway += longer;
  PdmLite planner(testing::styled(style, options), {}, {network, area, 1});
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("car", 5.0, 0.0, 0.0, 7.0),
                       vehicleAt("leader", 19.5, 0.0, 0.0, 7.0)};
  planning::PlanningTask task;
  task.slot = slot;
  task.vehicle = &snapshot.vehicles[0];
  task.route = &route;
  return planner.plan(snapshot, {task})[0].action;
}

TEST(PdmLite, GivesCbvsGapsOfTheirOwnWhereAsked) {
  PdmLiteOptions spread;
  spread.cbv_headway_spread = 0.05;
  const core::RandomKey key{core::hashText("car"), 0, 0};
  const double z = core::RandomStream(1, "driver").normal(key, 1);
  EXPECT_EQ(actionBehind(spread, 0, 0.0), actionBehind({}, 0, 0.05 * std::abs(z)));
  EXPECT_EQ(actionBehind(spread, -1, 0.0), actionBehind({}, -1, 0.0)) << "the ego keeps its own";
  EXPECT_FALSE(actionBehind(spread, 0, 0.0) == actionBehind({}, 0, 0.0)) << "z " << z;
}

}  // namespace
}  // namespace cdiff::planners
