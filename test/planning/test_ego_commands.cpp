// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/dynamics/pedal_map.h"
#include "planning/ego_commands.h"
#include "support/error_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::planning {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// An ego that follows commands, a decision every 0.1 s.
struct Follower {
  EgoCommands commands{{}, 0.1};
  dynamics::BicycleModel model;
  traffic::Vehicle ego = test::vehicle("ego", {}, traffic::VehicleRole::kEgo);
  double now = 0.0;

  explicit Follower(double speed) { ego.state.speed = speed; }
  void drive(const traffic::ControlAction& action) {
    const double before = ego.state.speed;
    ego.state = model.step(ego.state, action, 0.1);
    ego.acceleration = (ego.state.speed - before) / 0.1;
    ego.applied_action = action;
    now += 0.1;
  }
  template <class Command>
  void follow(const Command& command, int decisions) {
    for (int i = 0; i < decisions; ++i) drive(commands.follow(ego, command));
  }
};

TEST(AckermannCommand, ReachesItsSpeedAndHoldsItsAngle) {
  Follower follower(3.0);
  AckermannCommand command;
  command.speed = 7.0;
  command.steering_angle = 0.1;
  follower.follow(command, 60);
  EXPECT_NEAR(follower.ego.state.speed, 7.0, 0.05);
  EXPECT_NEAR(follower.ego.applied_action->steer * 0.36848336, 0.1, 1e-9);
  command.speed = 0.0;
  follower.follow(command, 60);
  EXPECT_NEAR(follower.ego.state.speed, 0.0, 0.01);
}

TEST(AckermannCommand, KeepsToItsLimits) {
  Follower follower(5.0);
  AckermannCommand command;
  command.speed = 20.0;
  command.acceleration = 0.5;
  command.steering_angle = 0.3;
  command.steering_angle_velocity = 0.2;
  follower.follow(command, 10);
  // 5 m/s + 0.5 m/s^2 x 1 s; two ticks under one throttle differ by little. 0.2 rad/s x 1 s.
  EXPECT_NEAR(follower.ego.state.speed, 5.5, 0.02);
  EXPECT_NEAR(follower.ego.applied_action->steer * 0.36848336, 0.2, 1e-9);
  command.jerk = 1.0;  // from 0.5 m/s^2 down to -0.5 m/s^2 takes 1 s
  command.speed = 0.0;
  follower.drive(follower.commands.follow(follower.ego, command));
  EXPECT_GT(follower.ego.acceleration, 0.2);
}

TEST(AckermannCommand, DrivesByAccelerationAlone) {
  Follower follower(6.0);
  AckermannCommand command;
  command.by_acceleration = true;
  command.acceleration = -2.0;
  command.speed = kNaN;  // counts for nothing
  follower.follow(command, 10);
  EXPECT_NEAR(follower.ego.state.speed, 4.0, 0.02);
}

TEST(AckermannCommand, SaysWhatTheVehicleCannotDo) {
  const Follower follower(6.0);
  const auto error = [&](const AckermannCommand& command) {
    return test::errorOf([&] { follower.commands.follow(follower.ego, command); });
  };
  AckermannCommand command;
  command.steering_angle = 0.5;
  EXPECT_NE(error(command).find("steering_angle is 0.5 rad; the vehicle's largest is 0.36848336"),
            std::string::npos)
      << error(command);
  command.steering_angle = -0.3684834;  // its largest, rounded
  EXPECT_EQ(error(command), "no error");
  command.speed = kNaN;
  EXPECT_EQ(error(command).find("speed is nan"), 0U) << error(command);
  command.speed = -1.0;
  EXPECT_NE(error(command).find("does not reverse"), std::string::npos) << error(command);
  command.speed = 1.0;
  command.jerk = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error(command).find("jerk is inf"), 0U) << error(command);
}

TEST(VelocityCommand, DrivesTheCircleOfItsRates) {
  Follower follower(4.0);
  follower.follow(VelocityCommand{4.0, 0.4}, 20);
  // A radius of 10 m; 2 s at 0.4 rad/s.
  EXPECT_NEAR(follower.ego.state.heading, 0.8, 0.02);
  EXPECT_NEAR(follower.ego.state.speed, 4.0, 0.02);
}

TEST(VelocityCommand, StandsAndRefusesWhatIsTooTight) {
  const Follower follower(4.0);
  EXPECT_EQ(follower.commands.follow(follower.ego, VelocityCommand{0.0, 0.7}),
            traffic::ControlAction::failSafe());
  const auto error = [&](const VelocityCommand& command) {
    return test::errorOf([&] { follower.commands.follow(follower.ego, command); });
  };
  EXPECT_NE(error({1.0, 1.0}).find("is a turn of 1.00 m; the vehicle's smallest is 3.72 m"),
            std::string::npos)
      << error({1.0, 1.0});
  EXPECT_EQ(error({kNaN, 0.0}).find("linear.x is nan"), 0U);
  EXPECT_EQ(error({1.0, kNaN}).find("angular.z is nan"), 0U);
}

/// Along a circle of 40 m to the left at 6 m/s, from `begin` [s] on, a pose every 0.5 s.
std::vector<TimedPlace> circle(double begin) {
  std::vector<TimedPlace> places;
  for (int i = 0; i <= 6; ++i) {
    const double time = begin + 0.5 * i;
    const double angle = 6.0 * time / 40.0;
    places.push_back({time, {40.0 * std::sin(angle), 40.0 - 40.0 * std::cos(angle)}});
  }
  return places;
}

TEST(Trajectory, IsFollowedWhateverTheSpacingOfItsPoses) {
  Follower follower(6.0);
  for (int i = 0; i < 100; ++i)
    follower.drive(follower.commands.follow(follower.ego, follower.now, circle(follower.now)));
  const double radius = (follower.ego.state.position - Eigen::Vector2d(0.0, 40.0)).norm();
  EXPECT_NEAR(radius, 40.0, 0.5);
  const double angle = 6.0 * follower.now / 40.0;
  const Eigen::Vector2d planned(40.0 * std::sin(angle), 40.0 - 40.0 * std::cos(angle));
  EXPECT_LT((follower.ego.state.position - planned).norm(), 2.0);
}

TEST(Trajectory, WithPosesBehindIsFollowedFromNowOn) {
  Follower late(6.0);
  late.now = 1.0;
  late.ego.state.position = {40.0 * std::sin(0.15), 40.0 - 40.0 * std::cos(0.15)};
  late.ego.state.heading = 0.15;
  const traffic::ControlAction action = late.commands.follow(late.ego, 1.0, circle(0.0));
  EXPECT_GT(action.steer, 0.0);
  EXPECT_EQ(action.brake, 0.0);
}

TEST(Trajectory, SaysWhatIsWrongWithIt) {
  Follower follower(6.0);
  const auto error = [&](const std::vector<TimedPlace>& places) {
    return test::errorOf([&] { follower.commands.follow(follower.ego, 9.0, places); });
  };
  EXPECT_NE(error({}).find("has no poses"), std::string::npos);
  EXPECT_NE(error(circle(1.0)).find("lies in the past: its last pose is 5.00 s old"),
            std::string::npos)
      << error(circle(1.0));
  EXPECT_NE(error({{10.0, {0.0, 0.0}}, {10.0, {1.0, 0.0}}}).find("expected rising stamps"),
            std::string::npos);
  EXPECT_NE(error({{10.0, {kNaN, 0.0}}}).find("pose 0 of the trajectory is not finite"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::planning
