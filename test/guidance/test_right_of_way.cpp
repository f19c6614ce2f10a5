// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/random.h"
#include "guidance/guidance_world.h"
#include "guidance/right_of_way.h"

namespace cdiff::guidance {
namespace {

using test::GuidanceWorld;

/// Two vehicles of 4.5 m x 1.8 m, each on a straight route of its own that starts where it is.
class TwoVehicles : public ::testing::Test {
 protected:
  /// Start and direction of a vehicle's route, `heading` in degrees.
  void add(const std::string& id, double x, double y, double heading, double speed) {
    const geometry::Pose2d frame{{x, y}, heading * core::kPi / 180.0};
    worlds_.push_back(std::make_unique<GuidanceWorld>(frame));
    RoutedVehicle vehicle;
    vehicle.id = id;
    vehicle.state = {frame.position, 0.0, frame.heading, speed};
    vehicle.dimensions.length = 4.5;
    vehicle.dimensions.width = 1.8;
    vehicle.route = worlds_.back()->scene().route;
    vehicle.target_speed = 8.0;
    vehicles_.push_back(vehicle);
  }
  /// "a", "b", "both", "none": who must wait.
  std::string waiting() const {
    const RightOfWay right(vehicles_);
    const bool a = !right.mayGo("a", "b");
    const bool b = !right.mayGo("b", "a");
    return a && b ? "both" : a ? "a" : b ? "b" : "none";
  }
  void clear() {
    worlds_.clear();
    vehicles_.clear();
  }

  std::vector<std::unique_ptr<GuidanceWorld>> worlds_;
  std::vector<RoutedVehicle> vehicles_;
};

TEST_F(TwoVehicles, TheFirstAtTheCrossingGoes) {
  add("a", -12.0, 0.0, 0.0, 5.0);
  add("b", 0.0, -20.0, 90.0, 5.0);
  EXPECT_EQ(waiting(), "b");
  vehicles_[1].state.speed = 9.0;  // 16.6 m in 1.8 s, a 8.6 m in 1.7 s: too near, so by name
  EXPECT_EQ(waiting(), "b");
  vehicles_[0].state.speed = 3.0;  // 2.9 s
  EXPECT_EQ(waiting(), "a");
}

TEST_F(TwoVehicles, TheOneInTheWayGoes) {
  add("b", 0.0, 0.0, 0.0, 0.0);  // a leader that stands
  add("a", -10.0, 0.3, 0.0, 8.0);
  EXPECT_EQ(waiting(), "a");
  clear();
  add("a", -10.0, 0.0, 0.0, 8.0);
  add("b", -1.0, -2.0, 60.0, 0.0);  // its front in a's lane
  EXPECT_EQ(waiting(), "a");
}

TEST_F(TwoVehicles, OfTwoSideBySideTheOneAheadGoes) {
  add("a", 0.0, 0.0, 0.0, 4.0);
  add("b", 0.5, 2.0, -8.0, 4.0);
  EXPECT_EQ(waiting(), "a");
  vehicles_[1].state.position.x() = -0.5;
  EXPECT_EQ(waiting(), "b");
}

TEST_F(TwoVehicles, BothWaitWhereTheyFaceEachOther) {
  add("a", 0.0, 0.0, 0.0, 4.0);
  add("b", 10.0, 0.5, 180.0, 4.0);
  EXPECT_EQ(waiting(), "both");
}

TEST_F(TwoVehicles, NoneWaitsWhereTheirWaysDoNotMeet) {
  add("a", 0.0, 0.0, 0.0, 8.0);
  add("b", 0.0, 3.5, 0.0, 8.0);
  EXPECT_EQ(waiting(), "none");
  vehicles_[1].state.position = {60.0, -40.0};  // beyond 3.2 s
  EXPECT_EQ(waiting(), "none");
  EXPECT_TRUE(RightOfWay().mayGo("a", "b"));
}

// 500 pairs that cross or converge by 15 to 145 degrees, both before the crossing or on it.
TEST_F(TwoVehicles, OneOfTwoThatCrossWaits) {
  const core::RandomStream random(3, "pairs");
  for (std::uint32_t trial = 0; trial < 500; ++trial) {
    const auto draw = [&](std::uint32_t element, double low, double high) {
      return random.uniform({0, trial}, element, low, high);
    };
    const double angle = draw(1, 15.0, 145.0) * (trial % 2 == 0 ? 1.0 : -1.0);
    const Eigen::Vector2d way = draw(3, 0.0, 12.0) * geometry::direction(angle * core::kPi / 180.0);
    clear();
    add("a", -draw(2, 0.0, 12.0), 0.0, 0.0, draw(0, 0.0, 9.0));
    add("b", -way.x(), -way.y(), angle, draw(4, 0.0, 9.0));
    const std::string first = waiting();
    EXPECT_TRUE(first == "a" || first == "b") << first << ", trial " << trial;
    std::swap(vehicles_[0], vehicles_[1]);
    EXPECT_EQ(waiting(), first);
  }
}

}  // namespace
}  // namespace cdiff::guidance
