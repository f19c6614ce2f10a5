// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The acceleration of one driver of LaneTraffic, to the last digit: a [1 - (v / v0)^4 - (s* / s)^2]
// with a = 2.6, b = 4.5, s0 = 2.5, T = 1 and v0 = the driver's share of the limit of 10 m/s.
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/random.h"
#include "map/lane_graph.h"
#include "simulation/lane_traffic.h"
#include "support/network_text.h"

namespace cdiff::simulation {
namespace {

constexpr double kQuarterTurn = 0.5 * core::kPi;

double shareOf(const std::string& id) {
  return 1.0 + core::RandomStream(0, "lane traffic drivers")
                   .uniform({core::hashText(id)}, 0, -0.15, 0.15);
}

double freeAcceleration(double v, double limit = 10.0) {
  return 2.6 * (1.0 - std::pow(v / (shareOf("a") * limit), 4.0));
}

/// Behind an obstacle at a distance `gap` that drives at `speed`.
double behind(double v, double gap, double speed) {
  const double wanted = 2.5 + std::max(0.0, v + v * (v - speed) / (2.0 * std::sqrt(2.6 * 4.5)));
  return freeAcceleration(v) - 2.6 * wanted * wanted / (gap * gap);
}

/// A road along x, from x = 500 m on with half of the limit, and one across it at x = 150 m. Car
/// "a", 4.5 x 1.8 m, has its center at (100, 0).
class LaneDriver : public ::testing::Test {
 protected:
  static map::RoadNetwork roads() {
    return test::NetworkText()
        .edge("road", {"0,0 500,0"})
        .edge("slow", {"500,0 900,0"}, "b", "c", {4.0, 5.0, ""})
        .edge("across", {"150,-200 150,200"}, "d", "e")
        .connection("road_0", "slow_0")
        .network();
  }
  /// Of car "a" at `v` with its center at (x, 0).
  double acceleration(double v, double x = 100.0) {
    EXPECT_TRUE(traffic_.addBackground("a", {"road", "slow"}, x + 2.25, 0, v, {}));
    traffic_.step({});
    const SimulatedVehicle* car = findVehicle(traffic_.vehicles(), "a");
    const double result = car == nullptr ? std::nan("") : car->acceleration;
    traffic_.step({});  // drivers think in every second step
    return result;
  }
  /// One of ours, 4.5 x 1.8 m, that stays as it is in the first step.
  void addOurs(double x, double y, double speed, double heading = 0.0, double elevation = 0.0) {
    DrivenVehicle ours;
    ours.id = "ours";
    ours.state.position = {x, y};
    ours.state.speed = speed;
    ours.state.heading = heading;
    ours.state.elevation = elevation;
    traffic_.addDriven("ours", {}, ours);
  }

  map::RoadNetwork network_ = roads();
  map::LaneGraph graph_{network_};
  LaneTraffic traffic_{graph_, 0.05};
};

TEST_F(LaneDriver, AloneComesToItsSpeed) {
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// 20 m/s is far above the wish: no more than the comfortable 4.5 m/s^2.
TEST_F(LaneDriver, SlowsDownComfortably) { EXPECT_NEAR(acceleration(20.0), -4.5, 1e-12); }

// With its center at x = 485.75 its front bumper is 12 m before the slow road; routes have a point
// every meter.
TEST_F(LaneDriver, SeesALowerLimitTwelveMetersAhead) {
  EXPECT_NEAR(acceleration(4.0, 484.7), freeAcceleration(4.0, 10.0), 1e-12);
  traffic_.remove("a");
  EXPECT_NEAR(acceleration(4.0, 486.8), freeAcceleration(4.0, 5.0), 1e-12);
}

// Centers 30 m apart: 30 - 4.5 = 25.5 m between the bumpers.
TEST_F(LaneDriver, BrakesBehindWhoStandsOnItsPath) {
  addOurs(130.0, 0.0, 0.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 25.5, 0.0), 1e-9);
}

TEST_F(LaneDriver, FollowsWhoDrivesAhead) {
  addOurs(130.0, 0.0, 6.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 25.5, 6.0), 1e-9);
}

// Turned by 60 degrees it drives 6 cos 60 along the path and reaches (4.5 cos 60 + 1.8 sin 60) / 2
// toward the car.
TEST_F(LaneDriver, FollowsWhoDrivesAskewByItsPartAlong) {
  addOurs(130.0, 0.0, 6.0, core::kPi / 3.0);
  const double extent = 0.5 * (4.5 * 0.5 + 1.8 * std::sqrt(0.75));
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 30.0 - 2.25 - extent, 3.0), 1e-9);
}

TEST_F(LaneDriver, TakesWhoComesTowardItAsStanding) {
  addOurs(130.0, 0.0, 6.0, core::kPi);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 25.5, 0.0), 1e-9);
}

// Half widths of 0.9 m each and 0.2 m between: 2 m.
TEST_F(LaneDriver, DrivesPastWhoStandsTwoMetersBeside) {
  addOurs(130.0, 2.05, 0.0);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

TEST_F(LaneDriver, DoesNotDrivePastWhoStandsNearer) {
  addOurs(130.0, -1.95, 0.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 25.5, 0.0), 1e-9);
}

TEST_F(LaneDriver, DoesNotMindWhoIsBehindOrOnAnotherLevel) {
  addOurs(90.0, 0.0, 0.0);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
  traffic_.remove("a");
  traffic_.remove("ours");
  addOurs(98.5, 0.0, 0.0);  // in contact, from behind
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
  traffic_.remove("a");
  traffic_.remove("ours");
  addOurs(120.0, 0.0, 0.0, 0.0, 5.0);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// At 8 m/s it looks 15 + 1.5 x 8 + 64 / 9 = 34.1 m ahead, and 2 m beside where that ends.
TEST_F(LaneDriver, LooksAheadAsFarAsItsSpeedAsks) {
  addOurs(134.0, 0.0, 0.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 29.5, 0.0), 1e-9);
  traffic_.remove("a");
  traffic_.remove("ours");
  addOurs(136.5, 0.0, 0.0);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// Edges are taken in until a route is 200 m long: from x = 300 m the road's 200 m are enough, from
// 301 m the slow road is added.
TEST_F(LaneDriver, RoutesEndWhereTheyAreLongEnough) {
  LaneTrafficOptions options;
  options.route_length = 200.0;
  for (const double x : {300.0, 301.0}) {
    LaneTraffic traffic(graph_, 0.05, options);
    ASSERT_TRUE(traffic.addBackground("a", {"road", "slow"}, x + 2.25, 0, 10.0, {}));
    double last = 0.0;
    for (int i = 0; i < 2000 && last < 550.0; ++i) {
      traffic.step({});
      const SimulatedVehicle* car = findVehicle(traffic.vehicles(), "a");
      if (car != nullptr) last = car->state.position.x();
    }
    EXPECT_EQ(last > 500.0, x > 300.0) << last;
  }
}

// 1 m ahead of the bumper: -2.6 (20 / 1)^2 and more; the wheels hold 8 m/s^2.
TEST_F(LaneDriver, BrakesNoHarderThanTheWheelsHold) {
  addOurs(105.5, 0.0, 0.0);
  EXPECT_NEAR(acceleration(8.0), -8.0, 1e-12);
}

/// Ours drives north, `south` meters south of the car's path, 20 m ahead of the car's center:
/// 17.75 m ahead of its bumper. The car stops 4 m before that: 13.75 m.
class LaneDriverAtACrossing : public LaneDriver {
 protected:
  void cross(double south, double speed, double ahead = 20.0) {
    addOurs(100.0 + ahead, -south, speed, kQuarterTurn);
  }
};

TEST_F(LaneDriverAtACrossing, YieldsToWhomItMeetsInASecond) {
  cross(8.0, 8.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 13.75, 0.0), 1e-9);
}

TEST_F(LaneDriverAtACrossing, YieldsToWhomItMeetsInTwoSeconds) {
  cross(16.0, 8.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 13.75, 0.0), 1e-9);
}

// After a second 2.3 m and 2.5 m short of the path; it is met within 2.4 m.
TEST_F(LaneDriverAtACrossing, YieldsWithinTheMeetingRadius) {
  cross(10.3, 8.0);
  EXPECT_NEAR(acceleration(8.0), behind(8.0, 13.75, 0.0), 1e-9);
}

TEST_F(LaneDriverAtACrossing, DoesNotYieldBeyondTheMeetingRadius) {
  cross(10.5, 8.0);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// 5 m ahead of the bumper: 0.42 s at 12 m/s, more than 1.5 s before ours, which comes in 2 s;
// 0.63 s at 8 m/s: then it yields, and 1 m before the line it brakes as hard as it can.
TEST_F(LaneDriverAtACrossing, GoesFirstWhenOursIsStillFar) {
  cross(16.0, 8.0, 7.25);
  EXPECT_NEAR(acceleration(12.0), std::max(-4.5, freeAcceleration(12.0)), 1e-12);
  traffic_.remove("a");
  traffic_.remove("ours");
  cross(16.0, 8.0, 7.25);
  EXPECT_NEAR(acceleration(8.0), -8.0, 1e-12);
}

// 3.9 m ahead of the bumper is nearer than the 4 m that it would stop before.
TEST_F(LaneDriverAtACrossing, DoesNotStopWhereItIsTooLate) {
  cross(8.0, 8.0, 6.15);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// Slower than 1 m/s is not on its way: in two seconds it would be 1.7 m away.
TEST_F(LaneDriverAtACrossing, DoesNotYieldToWhoHardlyMoves) {
  cross(3.5, 0.9);
  EXPECT_NEAR(acceleration(8.0), freeAcceleration(8.0), 1e-12);
}

// Another car of the traffic meets the path at x = 150 m in one second (8 m at 8 m/s). From x = 100
// our driver needs (50 - 2.25) / 8 = 6 s and looks 34 m ahead: nothing to see. From 125 it needs
// 2.8 s and yields, 25 - 2.25 - 4 = 18.75 m; from 141 it needs 0.84 s and goes first.
TEST_F(LaneDriverAtACrossing, TheFirstToArriveGoesFirst) {
  const auto meets = [&](double x) {
    EXPECT_TRUE(traffic_.addBackground("b", {"across"}, 200.0 - 8.0 + 2.25, 0, 8.0, {}));
    const double result = acceleration(8.0, x);
    traffic_.remove("a");
    traffic_.remove("b");
    return result;
  };
  EXPECT_NEAR(meets(100.0), freeAcceleration(8.0), 1e-12);
  EXPECT_NEAR(meets(125.0), behind(8.0, 18.75, 0.0), 1e-9);
  EXPECT_NEAR(meets(141.0), freeAcceleration(8.0), 1e-12);
}

}  // namespace
}  // namespace cdiff::simulation
