// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "planners/course.h"

namespace cdiff::planners {
namespace {

using testing::ClosedLoop;
using testing::kNorth;
using testing::makeNetwork;
using testing::routeAlong;
using testing::straight;
using testing::vehicleAt;

/// A road along +x and one across it at x = 100, without a junction.
class CrossRoads : public ::testing::Test {
 protected:
  double gap(const ClosedLoop& loop, std::size_t first, std::size_t second) const {
    return geometry::distance(loop.vehicle(first).box(), loop.vehicle(second).box());
  }

  map::RoadNetwork network_ = makeNetwork({{"east", straight(0.0, 0.0, 300.0, 0.0)},
                                           {"north", straight(100.0, -100.0, 100.0, 100.0)},
                                           {"bridge", straight(150.0, -100.0, 150.0, 100.0, 8.0)}});
  map::Route east_ = routeAlong(network_, {"east"});
  map::Route north_ = routeAlong(network_, {"north"});
};

TEST_F(CrossRoads, StopsBehindAStandingLeader) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  loop.add(vehicleAt("leader", 60.0, 0.0, 0.0, 0.0));
  double nearest = 1e9;
  loop.run(15.0, [&] { nearest = std::min(nearest, gap(loop, 0, 1)); });
  // IDM rests at s0 = 4 m of the gap "distance - leader's length", here the gap between the
  // bumpers.
  EXPECT_GE(nearest, 2.0);
  EXPECT_LE(nearest, 5.0);
  EXPECT_LT(loop.vehicle(0).state.speed, 0.1);
  RecordProperty("gap_m", std::to_string(nearest));
}

TEST_F(CrossRoads, FollowsAMovingLeader) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  loop.add(vehicleAt("leader", 30.0, 0.0, 0.0, 4.0));
  double nearest = 1e9;
  loop.run(25.0, [&] { nearest = std::min(nearest, gap(loop, 0, 1)); });
  EXPECT_GE(nearest, 4.0);
  EXPECT_LE(gap(loop, 0, 1), 8.0);
  RecordProperty("nearest_m", std::to_string(nearest));
}

TEST_F(CrossRoads, IgnoresAParkedCarInTheNextLane) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  loop.add(vehicleAt("parked", 50.0, -3.2, 0.0, 0.0));
  double slowest = 8.0;
  loop.run(10.0, [&] { slowest = std::min(slowest, loop.vehicle(0).state.speed); });
  EXPECT_GT(slowest, 7.7);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 80.0);
}

TEST_F(CrossRoads, IgnoresACarOnTheBridge) {
  for (const double elevation : {8.0, 0.0}) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 100.0, 0.0, 0.0, 8.0), east_);
    traffic::Vehicle above = vehicleAt("above", 150.0, 0.0, kNorth, 0.0);
    above.state.elevation = elevation;
    loop.add(above);
    loop.run(15.0);
    // On the bridge it is passed under; at road level the same car stops the ego.
    EXPECT_EQ(loop.vehicle(0).state.position.x() > 180.0, elevation == 8.0);
  }
}

TEST_F(CrossRoads, BrakesForACrossingCarAndGoesOn) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  // Both would reach the crossing after 11.9 s.
  traffic::Vehicle crossing = vehicleAt("crossing", 100.0, -95.0, kNorth, 8.0);
  crossing.lane_id = "north_0";
  loop.add(crossing);
  double nearest = 1e9;
  double slowest = 8.0;
  loop.run(20.0, [&] {
    nearest = std::min(nearest, gap(loop, 0, 1));
    slowest = std::min(slowest, loop.vehicle(0).state.speed);
  });
  EXPECT_LT(slowest, 4.0);
  EXPECT_GT(nearest, 0.5);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 110.0);
  RecordProperty("nearest_m", std::to_string(nearest));
  RecordProperty("slowest_mps", std::to_string(slowest));
}

/// With a = 2 and b = 3 m/s^2, and what its pedals did.
class EvenStyle : public CrossRoads {
 protected:
  static constexpr double kAcceleration = 2.0;

  ClosedLoop evenLoop() const {
    DrivingStyle style;
    style.time_headway = 0.8;
    style.acceleration = kAcceleration;
    style.deceleration = 3.0;
    return ClosedLoop(network_, testing::styled(style));
  }

  /// To be called after each decision.
  void watch(const ClosedLoop& loop) {
    const traffic::Vehicle& self = loop.vehicle(0);
    const double acceleration = (self.state.speed - speed_) / 0.1;
    hardest_ = std::min(hardest_, acceleration);
    strongest_ = std::max(strongest_, acceleration);
    speed_ = self.state.speed;
    for (std::size_t i = 1; i < loop.snapshot().vehicles.size(); ++i)
      nearest_ = std::min(nearest_, gap(loop, 0, i));
  }

  double speed_ = 0.0;
  double hardest_ = 0.0;    ///< acceleration [m/s^2]
  double strongest_ = 0.0;  ///< acceleration [m/s^2]
  double nearest_ = 1e9;    ///< gap to another [m]
};

TEST_F(EvenStyle, StartsAndReachesItsSpeedWithoutEverAskingForMore) {
  ClosedLoop loop = evenLoop();
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 0.0), east_);
  loop.run(12.0, [&] { watch(loop); });
  EXPECT_GT(loop.vehicle(0).state.speed, 7.2);
  EXPECT_LT(loop.vehicle(0).state.speed, 8.2);
  EXPECT_LT(strongest_, kAcceleration + 0.3);
  EXPECT_GT(hardest_, -0.3);
}

TEST_F(EvenStyle, SlowsDownToItsSpeedComfortably) {
  ClosedLoop loop = evenLoop();
  speed_ = 12.0;
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 12.0), east_);
  loop.run(10.0, [&] { watch(loop); });
  EXPECT_LT(loop.vehicle(0).state.speed, 8.5);
  EXPECT_GT(hardest_, -3.5);
}

TEST_F(EvenStyle, StopsShortlyBeyondTheEndOfItsRoute) {
  ClosedLoop loop = evenLoop();
  loop.drive(vehicleAt("ego", 270.0, 0.0, 0.0, 6.0), east_);
  loop.run(20.0);
  EXPECT_EQ(loop.vehicle(0).state.speed, 0.0);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 300.0);
  EXPECT_LT(loop.vehicle(0).state.position.x(), 302.0);
}

TEST_F(EvenStyle, StandingItLetsACrossingCarPassThatItsForecastMeets) {
  ClosedLoop loop = evenLoop();
  loop.drive(vehicleAt("ego", 92.0, 0.0, 0.0, 0.0), east_);
  traffic::Vehicle crossing = vehicleAt("crossing", 100.0, -18.0, kNorth, 8.0);
  crossing.lane_id = "north_0";
  loop.add(crossing);
  loop.run(10.0, [&] { watch(loop); });
  EXPECT_GT(nearest_, 0.3);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 110.0);
}

TEST_F(EvenStyle, StopsComfortablyBehindAStandingLeader) {
  ClosedLoop loop = evenLoop();
  speed_ = 8.0;
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  loop.add(vehicleAt("leader", 70.0, 0.0, 0.0, 0.0));
  loop.run(25.0, [&] { watch(loop); });
  EXPECT_GT(nearest_, 2.0);
  EXPECT_LT(nearest_, 7.0);
  EXPECT_LT(loop.vehicle(0).state.speed, 0.1);
  EXPECT_GT(hardest_, -4.5) << "full brake is 8 m/s^2";
}

TEST_F(EvenStyle, GivesWayToACrossingCarWithoutFullBrakeAndGoesOn) {
  ClosedLoop loop = evenLoop();
  speed_ = 8.0;
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), east_);
  traffic::Vehicle crossing = vehicleAt("crossing", 100.0, -95.0, kNorth, 8.0);
  crossing.lane_id = "north_0";
  loop.add(crossing);
  loop.run(25.0, [&] { watch(loop); });
  EXPECT_GT(nearest_, 0.5);
  EXPECT_GT(hardest_, -6.0);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 110.0);
}

TEST_F(EvenStyle, IsThatOfCbvsAloneWhereTheOptionSaysSo) {
  PdmLiteOptions options;
  options.cbv_acceleration = kAcceleration;
  for (const int slot : {-1, 0}) {
    ClosedLoop loop(network_, options);
    speed_ = strongest_ = 0.0;
    loop.drive(vehicleAt("car", 5.0, 0.0, 0.0, 0.0), east_, slot);
    loop.run(3.0, [&] { watch(loop); });
    EXPECT_EQ(strongest_ < kAcceleration + 0.3, slot == 0) << strongest_;
  }
}

TEST_F(CrossRoads, StandingBesideAStandingCrossingCarItStartsAtOnce) {
  // The other's nose is 0.6 m outside of the ego's width; both stand.
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 90.0, 0.0, 0.0, 0.0), east_);
  loop.add(vehicleAt("waiting", 100.0, -0.9 - 0.6 - 2.25, kNorth, 0.0));
  loop.run(5.0);
  EXPECT_GT(loop.vehicle(0).state.position.x(), 110.0);
}

/// What came of an ego and a CBV that meet at the crossing.
struct Encounter {
  double nearest = 1e9;           ///< gap between the boxes [m]
  double longest_standing = 0.0;  ///< of the ego, below 0.1 m/s [s]
  bool both_passed = false;
};

Encounter meetAtCrossing(ClosedLoop& loop) {
  Encounter encounter;
  double standing = 0.0;
  loop.run(25.0, [&] {
    const geometry::OrientedBox ego = loop.vehicle(0).box();
    encounter.nearest = std::min(encounter.nearest, geometry::distance(ego, loop.vehicle(1).box()));
    standing = loop.vehicle(0).state.speed < 0.1 ? standing + 0.1 : 0.0;
    encounter.longest_standing = std::max(encounter.longest_standing, standing);
  });
  encounter.both_passed =
      loop.vehicle(0).state.position.x() > 110.0 && loop.vehicle(1).state.position.y() > 10.0;
  return encounter;
}

TEST_F(CrossRoads, EgoAndCbvPassOneAfterTheOtherWithoutADeadlock) {
  // Distances to the crossing and speed of both, mirror images: nothing but the rule of giving way
  // distinguishes them.
  const std::vector<std::pair<double, double>> starts = {{8.0, 0.0},  {6.0, 0.0},  {12.0, 3.0},
                                                         {30.0, 8.0}, {60.0, 8.0}, {70.0, 0.0}};
  for (const auto& [distance, speed] : starts) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 100.0 - distance, 0.0, 0.0, speed), east_);
    loop.drive(vehicleAt("cbv", 100.0, -distance, kNorth, speed), north_, 0);
    const Encounter encounter = meetAtCrossing(loop);
    EXPECT_TRUE(encounter.both_passed) << distance << " m, " << speed << " m/s";
    EXPECT_GT(encounter.nearest, 0.3) << distance << " m, " << speed << " m/s";
    // The protocol calls 3 s "blocked".
    EXPECT_LT(encounter.longest_standing, 3.0) << distance << " m, " << speed << " m/s";
    RecordProperty("gap_m_from_" + std::to_string(static_cast<int>(distance)),
                   std::to_string(encounter.nearest));
    RecordProperty("standing_s_from_" + std::to_string(static_cast<int>(distance)),
                   std::to_string(encounter.longest_standing));
  }
}

TEST_F(CrossRoads, TrailingCarDoesNotStopIt) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 20.0, 0.0, 0.0, 4.0), east_);
  loop.add(vehicleAt("behind", 10.0, 0.0, 0.0, 4.0));
  double hardest = 0.0;
  loop.run(5.0, [&] { hardest = std::max(hardest, loop.actions()[0].action.brake); });
  EXPECT_EQ(hardest, 0.0);
}

// The trailer is 5.5 m behind bumper to bumper and 9 m/s faster than the ego, which reaches at most
// 8 m/s: within the forecast of 2 s their boxes meet, but who comes from behind is to give way.
TEST_F(CrossRoads, FasterTrailingCarDoesNotStopIt) {
  for (const double speed : {4.0, 13.0}) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 20.0, 0.0, 0.0, 4.0), east_);
    loop.add(vehicleAt("behind", 10.0, 0.0, 0.0, speed));
    loop.advance();
    EXPECT_EQ(loop.actions()[0].action.brake, 0.0) << speed;
    EXPECT_GT(loop.actions()[0].action.throttle, 0.5) << speed;
  }
}

// Of vehicles that give way to one another the ego goes first, then the CBVs by slot: a CBV waits
// until its way has been clear for 0.5 s + 0.2 s x slot. Decisions are 0.1 s apart and the first
// clear one counts 0.1 s, so it goes at decision 5, 7 and 9.
TEST_F(CrossRoads, CbvThatGaveWayRestartsByItsSlot) {
  for (const auto& [slot, goes] : {std::pair{-1, 1}, {0, 5}, {1, 7}, {2, 9}}) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("car", 90.0, 0.0, 0.0, 0.0), east_, slot);
    traffic::Vehicle crossing = vehicleAt("crossing", 100.0, -12.0, kNorth, 8.0);
    crossing.lane_id = "north_0";
    loop.add(crossing);
    loop.advance();
    ASSERT_EQ(loop.actions()[0].action.throttle, 0.0) << "slot " << slot << " gives way";
    loop.snapshot().vehicles.pop_back();
    int decision = 0;
    do {
      loop.advance();
      ++decision;
    } while (loop.actions()[0].action.throttle == 0.0 && decision < 20);
    EXPECT_EQ(decision, goes) << "slot " << slot;
  }
}

std::string bytesOf(const std::vector<planning::PlannedAction>& actions) {
  std::string bytes;
  const auto append = [&](double value) {
    char buffer[sizeof value];
    std::memcpy(buffer, &value, sizeof value);
    bytes.append(buffer, sizeof value);
  };
  for (const planning::PlannedAction& planned : actions) {
    bytes += planned.vehicle_id;
    for (const double value :
         {planned.action.throttle, planned.action.steer, planned.action.brake,
          planned.rollout.back().state.position.x(), planned.rollout.back().state.position.y()}) {
      append(value);
    }
  }
  return bytes;
}

TEST_F(CrossRoads, SameInputsGiveTheSameBytes) {
  std::vector<std::string> traces(2);
  for (std::string& trace : traces) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 60.0, 0.2, 0.1, 6.0), east_);
    loop.drive(vehicleAt("cbv", 100.0, -40.0, kNorth, 8.0), north_, 0);
    loop.add(vehicleAt("leader", 80.0, 0.0, 0.0, 3.0));
    loop.run(10.0, [&] { trace += bytesOf(loop.actions()); });
  }
  EXPECT_EQ(traces[0], traces[1]);
}

TEST_F(CrossRoads, ManyVehiclesAtOnceEqualOneAtATime) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {
      vehicleAt("ego", 60.0, 0.2, 0.1, 6.0), vehicleAt("cbv_a", 100.0, -40.0, kNorth, 8.0),
      vehicleAt("cbv_b", 40.0, 0.0, 0.0, 8.0), vehicleAt("other", 75.0, 0.0, 0.0, 3.0)};
  std::vector<planning::PlanningTask> tasks;
  for (int i = 0; i < 3; ++i) {
    tasks.push_back({i - 1, &snapshot.vehicles[i], i == 1 ? &north_ : &east_, 8.0});
  }
  const map::DrivableArea area(network_);
  const planning::PlanningContext context{network_, area};
  for (const planning::PlanningTask& task : tasks) {
    PdmLite alone({}, {}, context);
    for (int decision = 0; decision < 3; ++decision) alone.plan(snapshot, {task});
    PdmLite batch({}, {}, context);
    for (int decision = 0; decision < 3; ++decision) batch.plan(snapshot, tasks);
    const auto one = alone.plan(snapshot, {task});
    const auto all = batch.plan(snapshot, tasks);
    const auto index = static_cast<std::size_t>(task.slot + 1);
    EXPECT_EQ(bytesOf(one), bytesOf({all[index]}));
  }
}

}  // namespace
}  // namespace cdiff::planners
