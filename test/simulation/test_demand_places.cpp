// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Where and how fast a generated vehicle may start, and which ways it takes, on roads written here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "simulation/crossing_world.h"
#include "simulation/demand_generator.h"
#include "support/network_text.h"

namespace cdiff::simulation {
namespace {

/// One lane, 4 m wide, along x from 0 to 300 m. A car of 4.5 x 1.8 m is to start with its center at
/// (100, 0). The gap behind a leader must be 8 m + 1.2 s (v - u) + (v^2 - u^2) / (2 x 3 m/s^2).
class FreeSpeed : public testing::Test {
 protected:
  std::optional<double> speed(double wanted, const std::vector<traffic::Vehicle>& others,
                              double front = 102.25) const {
    Insertion insertion;
    insertion.lane = 0;
    insertion.front = front;
    insertion.speed = wanted;
    return freeSpeed(network_, insertion, others);
  }
  static traffic::Vehicle car(double x, double y, double speed, double heading = 0.0) {
    traffic::Vehicle vehicle;
    vehicle.state.position = {x, y};
    vehicle.state.speed = speed;
    vehicle.state.heading = heading;
    return vehicle;
  }

  map::RoadNetwork network_ = test::NetworkText().edge("road", {"0,0 300,0"}).network();
};

TEST_F(FreeSpeed, AStateIsThatOfTheCenter) {
  Insertion insertion;
  insertion.lane = 0;
  insertion.front = 102.25;
  insertion.speed = 7.0;
  const traffic::VehicleState state = stateAt(network_, insertion);
  EXPECT_NEAR(state.position.x(), 100.0, 1e-9);
  EXPECT_NEAR(state.position.y(), 0.0, 1e-9);
  EXPECT_EQ(state.speed, 7.0);
}

// From 297 m it has 2 m to 1 m before the end: sqrt(2 x 3 x 2) m/s.
TEST_F(FreeSpeed, EndsBeforeTheLaneDoes) {
  EXPECT_EQ(speed(10.0, {}), 10.0);
  EXPECT_NEAR(speed(10.0, {}, 297.0).value(), std::sqrt(12.0), 1e-9);
  EXPECT_EQ(speed(10.0, {}, 299.5), 0.0);
}

// Gap 22.5 m less 8: 8.5 m/s need 10.2 + 12.04 = 22.2 m of the 22.5 m that a gap of 30.5 leaves,
// 9 m/s need 24.3 m. At 40.5 m the wish of 10 m/s needs 36.7 m.
TEST_F(FreeSpeed, LeavesRoomToBrakeBehindWhoStands) {
  EXPECT_EQ(speed(10.0, {car(145.0, 0.0, 0.0)}), 10.0);
  EXPECT_EQ(speed(10.0, {car(135.0, 0.0, 0.0)}), 8.5);
  EXPECT_EQ(speed(10.0, {car(135.0, 0.0, 5.0, core::kPi)}), 8.5) << "who comes counts as standing";
}

// Gap 20 m, 12 m above the least: 9 m/s behind 6 m/s need 3.6 + 7.5 = 11.1 m, 9.5 m/s 13.2 m.
TEST_F(FreeSpeed, IsThatBehindASlowerLeader) {
  EXPECT_EQ(speed(10.0, {car(124.5, 0.0, 6.0)}), 9.0);
}

// Bumpers 8.1 m and 7.9 m apart, nobody faster than the leader.
TEST_F(FreeSpeed, NeedsEightMetersBehindAFasterLeader) {
  EXPECT_EQ(speed(4.0, {car(112.6, 0.0, 12.0)}), 4.0);
  EXPECT_FALSE(speed(4.0, {car(112.4, 0.0, 12.0)}).has_value());
  EXPECT_EQ(speed(10.0, {car(112.6, 0.0, 0.0)}), 0.0);
}

// A follower at 10 m/s behind 4 m/s needs 8 + 7.2 + 14 = 29.2 m.
TEST_F(FreeSpeed, LeavesRoomForWhoFollows) {
  EXPECT_EQ(speed(4.0, {car(66.1, 0.0, 10.0)}), 4.0);
  EXPECT_FALSE(speed(4.0, {car(66.5, 0.0, 10.0)}).has_value());
  EXPECT_EQ(speed(4.0, {car(66.5, 0.0, 10.0, core::kPi)}), 4.0) << "it drives away";
}

// Two half widths of 0.9 m and 0.4 m between them.
TEST_F(FreeSpeed, LeavesRoomBeside) {
  EXPECT_FALSE(speed(4.0, {car(100.0, 2.15, 0.0)}).has_value());
  EXPECT_FALSE(speed(4.0, {car(104.8, 0.0, 9.0)}).has_value());
}

// Half a lane and half a car: 2.9 m beside, unless it is said to be on this lane.
TEST_F(FreeSpeed, LooksAtItsCorridorAndItsLane) {
  EXPECT_EQ(speed(4.0, {car(110.0, 2.95, 0.0)}), 4.0);
  EXPECT_EQ(speed(4.0, {car(110.0, -2.95, 0.0)}), 4.0);
  EXPECT_FALSE(speed(4.0, {car(110.0, 2.85, 0.0)}).has_value());
  traffic::Vehicle on_lane = car(110.0, 2.95, 0.0);
  on_lane.lane_id = "road_0";
  EXPECT_FALSE(speed(4.0, {on_lane}).has_value());
}

TEST_F(FreeSpeed, IsNotDisturbedFromAnotherLevel) {
  traffic::Vehicle above = car(101.0, 0.0, 0.0);
  above.state.elevation = 5.0;
  EXPECT_EQ(speed(4.0, {above}), 4.0);
}

/// Two lanes that end after 100 m: on (both lanes) along the ego's way, left (the left lane) away
/// from it, and back.
class Router : public testing::Test {
 protected:
  static map::RoadNetwork fork() {
    return test::NetworkText()
        .edge("a", {"0,0 100,0", "0,4 100,4"}, "n", "j")
        .edge("on", {"100,0 400,0", "100,4 400,4"}, "j", "k")
        .edge("left", {"100,20 100,200"}, "j", "l")
        .edge("back", {"100,8 0,8"}, "j", "n")
        .connection("a_0", "on_0")
        .connection("a_1", "on_1")
        .connection("a_1", "left_0", "", 'l')
        .connection("a_1", "back_0", "", 't')
        .network();
  }
  /// How many of 1100 vehicles go on, and how many to the left.
  std::pair<int, int> counts(const std::string& lane, double arc_length) const {
    std::pair<int, int> found{0, 0};
    for (std::uint32_t i = 0; i < 1100; ++i) {
      const auto way =
          router_.route(network_.findLane(lane), arc_length, 150.0, random_, {0, i, 0});
      EXPECT_EQ(way.size(), 2U);
      EXPECT_EQ(edges_.id(way.front()), "a");
      found.first += edges_.id(way.back()) == "on";
      found.second += edges_.id(way.back()) == "left";
    }
    return found;
  }

  map::RoadNetwork network_ = fork();
  map::LaneGraph lanes_{network_};
  EdgeGraph edges_{network_};
  map::Route ego_ = test::routeOnFirstLanes(lanes_, "a", "on");
  DemandRouter router_{edges_, ego_, 10.0};
  core::RandomStream random_{1, "traffic"};
};

// With 60 m to the junction both lanes on and the one to the left can be reached, weights 5, 5 and
// 1: 1000 and 100 of 1100, with a standard deviation of 9.5.
TEST_F(Router, PrefersEdgesNearTheEgosWay) {
  for (const std::string lane : {"a_0", "a_1"}) {
    const auto [on, left] = counts(lane, 39.0);
    EXPECT_EQ(on + left, 1100) << "nobody turns back";
    EXPECT_NEAR(left, 100, 40) << lane;
  }
}

// With less the own lane decides: from the left one 5 and 1, 183 of 1100 (deviation 12.4).
TEST_F(Router, TakesWaysOfTheLaneThatItIsOn) {
  EXPECT_EQ(counts("a_0", 41.0).first, 1100);
  const auto [on, left] = counts("a_1", 41.0);
  EXPECT_EQ(on + left, 1100);
  EXPECT_NEAR(left, 183, 45);
}

// 61 m are left of the first edge, then come 300 m and the network ends.
TEST_F(Router, EndsWhereItIsLongEnough) {
  const auto length = [&](double wanted) {
    return router_.route(network_.findLane("a_0"), 39.0, wanted, random_, {0, 1, 0}).size();
  };
  EXPECT_EQ(length(60.0), 1U);
  EXPECT_EQ(length(62.0), 2U);
  EXPECT_EQ(length(1000.0), 2U);
}

/// Roads of 100 m, one behind the other along x, and the generator's vehicles on them.
class Generated : public testing::Test {
 protected:
  static test::NetworkText roads(double limit) {
    test::NetworkText text;
    for (int i = 0; i < 12; ++i) {
      const std::string begin = std::to_string(100 * i), end = std::to_string(100 * i + 100);
      test::LaneText lane;
      lane.speed = limit;
      text.edge("e" + std::to_string(i), {begin + ",0 " + end + ",0"}, "n" + begin, "n" + end,
                lane);
      if (i > 0)
        text.connection("e" + std::to_string(i - 1) + "_0", "e" + std::to_string(i) + "_0");
    }
    return text;
  }
  /// What is placed at once around an ego on the second road, among others that are there.
  std::vector<DemandVehicle> fill(double limit, double ego_elevation = 0.0, bool warm_up = true,
                                  const std::vector<traffic::Vehicle>& present = {}) {
    const map::RoadNetwork network = roads(limit).network();
    const map::LaneGraph graph(network);
    const map::Route route = test::routeOnFirstLanes(graph, "e0", "e2");
    DemandGenerator generator(options_, graph, route, seed_);
    std::vector<DemandVehicle> vehicles;
    while (auto vehicle = generator.next(present, kEgo, ego_elevation, warm_up))
      vehicles.push_back(*vehicle);
    return vehicles;
  }
  static double placeOf(const DemandVehicle& vehicle) {
    return 100.0 * std::stod(vehicle.edges.front().substr(1)) + vehicle.depart_position;
  }

  inline static const Eigen::Vector2d kEgo{150.0, 0.0};
  DemandOptions options_;
  std::uint64_t seed_ = 1;
};

// 100 m less the place on the first road, and 100 m a road: the ninth makes it 800 m.
TEST_F(Generated, RoutesAreEightHundredMetersLong) {
  const std::vector<DemandVehicle> vehicles = fill(10.0);
  EXPECT_GT(vehicles.size(), 3U);
  for (const DemandVehicle& vehicle : vehicles) EXPECT_EQ(vehicle.edges.size(), 9U);
}

// 8 m/s, 0.7 of the limit where that is more, and never above the limit; 40 m before the end of its
// road nobody is slower for it.
TEST_F(Generated, TheFirstIsAsFastAsUsualOnItsRoad) {
  for (const auto& [limit, speed] : {std::pair{20.0, 14.0}, {10.0, 8.0}, {5.0, 5.0}}) {
    int found = 0;
    for (seed_ = 1; seed_ < 10; ++seed_) {
      const DemandVehicle first = fill(limit).at(0);
      if (first.depart_position > 60.0) continue;
      EXPECT_NEAR(first.depart_speed, speed, 1e-9);
      ++found;
    }
    EXPECT_GT(found, 0);
  }
}

// In a session vehicles begin out of sight, more than 60 m away; 30 m where the ego is on another
// level.
TEST_F(Generated, WhoCannotBeSeenBeginsNearer) {
  const auto nearest = [&](double elevation) {
    double least = 1e9;
    for (seed_ = 1; seed_ < 10; ++seed_) {
      for (const DemandVehicle& vehicle : fill(10.0, elevation, false))
        least = std::min(least, std::abs(placeOf(vehicle) - kEgo.x()));
    }
    return least;
  };
  EXPECT_GT(nearest(0.0), 60.0);
  EXPECT_GT(nearest(2.4), 60.0);
  EXPECT_GT(nearest(2.6), 30.0);
  EXPECT_LT(nearest(2.6), 60.0);
}

// One vehicle is wanted within 150 m: the ego is none, nor is who is farther away.
TEST_F(Generated, CountsWhoIsNearButNotTheEgo) {
  options_.density = 1;
  traffic::Vehicle present;
  present.id = "a";
  present.state.position = kEgo;
  present.role = traffic::VehicleRole::kEgo;
  EXPECT_EQ(fill(10.0, 0.0, true, {present}).size(), 1U);
  present.role = traffic::VehicleRole::kCbv;
  EXPECT_TRUE(fill(10.0, 0.0, true, {present}).empty());
  present.state.position = {299.0, 20.0};
  EXPECT_EQ(fill(10.0, 0.0, true, {present}).size(), 1U) << "150.3 m away";
}

}  // namespace
}  // namespace cdiff::simulation
