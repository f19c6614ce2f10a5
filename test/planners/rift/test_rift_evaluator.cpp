// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/rift/rift_evaluator.h"
#include "planning/plan_tracker.h"

namespace cdiff::planners {
namespace {

using testing::straight;

/// Along a circle that turns left by `curvature` [1/m], at a speed.
PlutoTrajectory arc(double speed, double curvature) {
  PlutoTrajectory candidate = PlutoTrajectory::Zero();
  for (Eigen::Index i = 0; i < kPlutoSteps; ++i) {
    const double length = 0.1 * speed * static_cast<double>(i + 1);
    const double turn = curvature * length;
    const double x = curvature == 0.0 ? length : std::sin(turn) / curvature;
    const double y = curvature == 0.0 ? 0.0 : (1.0 - std::cos(turn)) / curvature;
    candidate.row(i) << static_cast<float>(x), static_cast<float>(y),
        static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)),
        static_cast<float>(speed * std::cos(turn)), static_cast<float>(speed * std::sin(turn));
  }
  return candidate;
}

/// Straight on, slowing down from 6 m/s by 3 m/s^2 to stand after 6 m.
PlutoTrajectory stop() {
  PlutoTrajectory candidate = arc(6.0, 0.0);
  for (Eigen::Index i = 0; i < kPlutoSteps; ++i) {
    const double time = std::min(2.0, 0.1 * static_cast<double>(i + 1));
    candidate(i, 0) = static_cast<float>(6.0 * time - 1.5 * time * time);
    candidate(i, 4) = static_cast<float>(6.0 - 3.0 * time);
  }
  return candidate;
}

/// What is left of a plan, in the body frame.
Eigen::MatrixX2d leftOf(const RiftPlan& plan, std::size_t step,
                        const traffic::VehicleState& state) {
  Eigen::MatrixX2d places(static_cast<Eigen::Index>(plan.places.size() - step), 2);
  for (Eigen::Index row = 0; row < places.rows(); ++row) {
    const Eigen::Vector2d& place = plan.places[step + static_cast<std::size_t>(row)];
    places.row(row) = state.pose().toBody(place).transpose();
  }
  return places;
}

// As a planner that makes no other plan for 4 s: speeding up, holding, turning either way and
// stopping.
TEST(RiftDriver, DrivesAsTheTrackerAndTheDynamicsDo) {
  const dynamics::BicycleModel model;
  const RiftDriver driver(model.options());
  const std::pair<PlutoTrajectory, double> cases[] = {
      {arc(8.0, 0.0), 5.0}, {arc(6.0, 0.04), 6.0}, {arc(5.0, -0.06), 7.0}, {arc(0.0, 0.0), 6.0}};
  for (const auto& [candidate, speed] : cases) {
    const double heading = 2.0;
    const RiftPlan plan(candidate, heading);
    const RiftRollout rollout = driver.drive(plan, heading, speed);
    planning::PlanTracker tracker;
    traffic::VehicleState state;
    state.heading = heading;
    state.speed = speed;
    for (std::size_t step = 0; step < kRiftSteps; ++step) {
      state = model.step(state, tracker.track(state.speed, leftOf(plan, step, state)), 0.1);
      EXPECT_NEAR(rollout.x[step + 1], state.position.x(), 1e-6) << step;
      EXPECT_NEAR(rollout.y[step + 1], state.position.y(), 1e-6) << step;
      EXPECT_NEAR(core::angleDifference(rollout.heading[step + 1], state.heading), 0.0, 1e-6);
      EXPECT_NEAR(rollout.speed[step + 1], state.speed, 1e-6) << step;
    }
  }
}

RiftNeighbor standing(double x, double speed) {
  RiftNeighbor neighbor;
  traffic::VehicleState state;
  state.position = {x, 0.0};
  state.speed = speed;
  neighbor.states.assign(kRiftSteps, state);
  return neighbor;
}

geometry::OrientedBox boxAt(double x, double y = 0.0) { return {{x, y}, 0.0, 4.5, 1.8}; }

// A standing car of 4.5 m counts as 4.95 m long: it is reached at 20 - 2.475 - 2.25 = 15.275 m. One
// that moves counts as 9.9 m: at 12.8 m.
TEST(RiftObstacles, AreLongerWhenTheyMove) {
  const RiftObstacles still({standing(20.0, 0.99)}, {0.0, 0.0});
  EXPECT_FALSE(still.hit(0, boxAt(15.27)));
  EXPECT_TRUE(still.hit(0, boxAt(15.28)));
  const RiftObstacles moving({standing(20.0, 1.0)}, {0.0, 0.0});
  EXPECT_FALSE(moving.hit(0, boxAt(12.79)));
  EXPECT_TRUE(moving.hit(0, boxAt(12.81)));
}

// Width 1.1 x 1.8 at first and 1.3 x 1.1 x 1.8 = 2.574 m after 4 s: half of it and half of 1.8.
TEST(RiftObstacles, GrowWiderWithTime) {
  const RiftObstacles moving({standing(20.0, 5.0)}, {0.0, 0.0});
  EXPECT_FALSE(moving.hit(0, boxAt(20.0, 1.90)));
  EXPECT_TRUE(moving.hit(0, boxAt(20.0, 1.88)));
  EXPECT_FALSE(moving.hit(39, boxAt(20.0, 2.19)));
  EXPECT_TRUE(moving.hit(39, boxAt(20.0, 2.18)));
}

TEST(RiftObstacles, AreMeasuredFromTheOrigin) {
  const RiftObstacles moved({standing(120.0, 0.0)}, {100.0, 0.0});
  EXPECT_TRUE(moved.hit(0, boxAt(16.0)));
  EXPECT_FALSE(moved.hit(0, boxAt(116.0)));
}

/// A road of 3.2 m along x.
class RiftEvaluatorTest : public ::testing::Test {
 protected:
  RiftEvaluatorTest() {
    state_.pose = {{20.0, 0.0}, 0.0};
    state_.speed = 6.0;
    ReferenceLine line;
    for (int i = 0; i <= 120; ++i) line.poses.push_back({{20.0 + i, 0.0}, 0.0});
    state_.lines = {line};
  }
  double returnOf(const PlutoTrajectory& candidate) {
    return evaluator_.returnsOf(state_, {candidate}, mask_).front();
  }

  map::RoadNetwork network_ = testing::makeNetwork({{"road", straight(-50.0, 0.0, 300.0, 0.0)}});
  map::DrivableArea area_{network_};
  DrivableMask mask_{area_};
  RiftEvaluator evaluator_{dynamics::BicycleModelOptions{}};
  RiftState state_;
};

TEST_F(RiftEvaluatorTest, CellsAreThoseOfTheArea) {
  MaskWindow window(mask_, {20.0, 0.0});
  for (double y = -3.9; y < 4.0; y += 0.1) {
    // The cell's own center decides.
    const double center = 0.5 * std::floor(y / 0.5) + 0.25;
    EXPECT_EQ(window.drivable(-5.0, y), area_.contains({15.0, center})) << y;
  }
  EXPECT_FALSE(window.drivable(150.0, 0.0)) << "beyond the window";
}

// Nothing in the way: 8 m/s along the line is worth more than stopping.
TEST_F(RiftEvaluatorTest, DrivingOnAFreeRoadIsWorthMoreThanStopping) {
  EXPECT_GT(returnOf(arc(8.0, 0.0)), returnOf(stop()));
}

// A car stands 15 m ahead, some 10 m between the boxes: at 8 m/s it is hit after 1.5 s. (One that
// is hit after 3 s costs less than the way until then is worth: RIFT's reward.)
TEST_F(RiftEvaluatorTest, ACollisionIsWorthLessThanStopping) {
  state_.neighbors = {standing(35.0, 0.0)};
  EXPECT_LT(returnOf(arc(8.0, 0.0)), returnOf(stop()) - 5.0);
}

TEST_F(RiftEvaluatorTest, LeavingTheRoadIsWorthLessThanStayingOnIt) {
  const double straight_on = returnOf(arc(6.0, 0.0));
  const double left = returnOf(arc(6.0, 0.1));
  const double right = returnOf(arc(6.0, -0.1));
  EXPECT_LT(left, straight_on - 20.0);
  EXPECT_NEAR(left, right, 1e-3) << "the road is as wide to both sides";
}

// A road that climbs 1 m in 5 m: 8 m/s are some 30 m or 6 m of height in 4 s, while the area of a
// level holds what is within 3 m of it. The return must be that on the flat road.
TEST_F(RiftEvaluatorTest, ARoadThatClimbsIsNotLeft) {
  const double flat = returnOf(arc(8.0, 0.0));
  const map::RoadNetwork hill =
      testing::makeNetwork({{"road", {{-50.0, 0.0, -10.0}, {300.0, 0.0, 60.0}}}});
  const map::DrivableArea area(hill);
  DrivableMask mask(area);
  state_.elevations.clear();
  for (int i = 0; i <= 100; ++i) state_.elevations.push_back(0.2 * (20.0 + i));
  EXPECT_NEAR(evaluator_.returnsOf(state_, {arc(8.0, 0.0)}, mask).front(), flat, 1e-9);
}

TEST_F(RiftEvaluatorTest, CandidatesAreJudgedEachByItself) {
  state_.neighbors = {standing(35.0, 0.0)};
  const std::vector<PlutoTrajectory> all = {arc(8.0, 0.0), arc(6.0, 0.05), arc(2.0, 0.0)};
  const std::vector<double> together = evaluator_.returnsOf(state_, all, mask_);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(together[i], returnOf(all[i])) << i;
}

// Two lines, the second 3 m beside the first and turned by 0.1: the nearest of all their points is
// looked for at each step, and what the steps are worth is added up here once more.
TEST_F(RiftEvaluatorTest, MeasuresFromTheNearestPointOfAllLines) {
  ReferenceLine beside;
  for (int i = 0; i <= 120; ++i)
    beside.poses.push_back({{20.0 + i * std::cos(0.1), 3.0 + i * std::sin(0.1)}, 0.1});
  state_.lines.push_back(beside);
  state_.pose.heading = 0.05;
  MaskWindow window(mask_, state_.pose.position);
  for (const PlutoTrajectory& candidate :
       {arc(8.0, 0.0), arc(6.0, 0.03), arc(5.0, -0.04), stop()}) {
    const RiftPlan plan(candidate, 0.05);
    const RiftRollout rollout = RiftDriver({}).drive(plan, 0.05, 6.0);
    std::array<RiftStep, kRiftSteps> steps{};
    for (std::size_t i = 0; i < kRiftSteps; ++i) {
      steps[i].speed = smoothed(rollout.speed)[i + 1];
      steps[i].acceleration = rateOf(smoothed(rollout.speed))[i + 1];
      steps[i].yaw_acceleration = rateOf(rateOf(rollout.heading))[i + 1];
      double nearest = 1e9;
      for (const ReferenceLine& line : state_.lines) {
        for (const geometry::Pose2d& pose : line.poses) {
          const Eigen::Vector2d away = plan.places[i] + state_.pose.position - pose.position;
          if (away.norm() >= nearest) continue;
          nearest = away.norm();
          steps[i].offset = away.dot(geometry::leftNormal(geometry::direction(pose.heading)));
          steps[i].heading_error = core::angleDifference(
              std::atan2(plan.directions[i].y(), plan.directions[i].x()), pose.heading);
        }
      }
      const geometry::OrientedBox box{
          {rollout.x[i + 1], rollout.y[i + 1]}, rollout.heading[i + 1], 4.5, 1.8};
      for (const Eigen::Vector2d& corner : box.corners())
        steps[i].off_road = steps[i].off_road || !window.drivable(corner.x(), corner.y());
    }
    EXPECT_NEAR(returnOf(candidate), riftReturn(steps), 1e-9);
  }
}

}  // namespace
}  // namespace cdiff::planners
