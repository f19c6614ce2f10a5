// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planners/course.h"
#include "planners/diffusion/diffusion_planner.h"
#include "rendering/front_camera.h"
#include "support/front_views.h"

namespace cdiff::planners {
namespace {

using testing::Points;

Points mirrored(Points points) {
  for (Eigen::Vector3d& point : points) point.y() = -point.y();
  return points;
}

traffic::CameraImage flipped(const traffic::CameraImage& image) {
  traffic::CameraImage result = image;
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t pixel = 0; pixel < image.rgb.size() / 3; ++pixel) {
    const std::size_t row = pixel / width;
    const std::size_t other = row * width + (width - 1 - pixel % width);
    for (std::size_t c = 0; c < 3; ++c) result.rgb[3 * pixel + c] = image.rgb[3 * other + c];
  }
  return result;
}

constexpr int kDraws = 64;

/// Mean and standard error of what is added.
class Tally {
 public:
  void add(double value) {
    ++count_;
    sum_ += value;
    squares_ += value * value;
  }
  double mean() const { return sum_ / count_; }
  double error() const {
    return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean()) / (count_ - 1.0));
  }

 private:
  double count_ = 0.0;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

struct MirrorSteers {
  Tally scene;
  Tally mirror;
};

/// Mean steer of the plan's first second.
double steerOf(const planning::PlannedAction& planned) {
  EXPECT_EQ(planned.fault, "");
  double sum = 0.0;
  for (std::size_t k = 0; k < 10; ++k) sum += planned.rollout.at(k).action.steer;
  return sum / 10.0;
}

/// A second vehicle in the mirrored place.
traffic::Vehicle twinOf(const traffic::Vehicle& vehicle) {
  traffic::Vehicle twin = vehicle;
  twin.id = "twin";
  twin.state.position.y() = -vehicle.state.position.y();
  twin.state.heading = -vehicle.state.heading;
  return twin;
}

/// Steer of the shipped model, unguided, for `vehicle` with the route `road` and in the mirrored
/// scene. Each draw is a decision of its own tick, so of its own noise, in the same place.
MirrorSteers steersOn(const Points& road, const traffic::Vehicle& vehicle) {
  const map::RoadNetwork network = testing::makeNetwork({{"road", road}});
  const map::RoadNetwork mirror = testing::makeNetwork({{"road", mirrored(road)}});
  const map::DrivableArea area(network);
  const map::Route route = testing::routeAlong(network, {"road"});
  const map::Route mirror_route = testing::routeAlong(mirror, {"road"});
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicle};
  traffic::CameraImage image = rendering::FrontCamera({}, network).render(snapshot, vehicle);
  traffic::CameraImage mirror_image = flipped(image);
  snapshot.vehicles.push_back(twinOf(vehicle));
  DiffusionPlanner planner({}, guidance::loadProfile("none"), {},
                           planning::PlanningContext{network, area});
  MirrorSteers steers;
  for (int draw = 0; draw < kDraws; ++draw) {
    snapshot.tick = static_cast<std::uint64_t>(2 * draw);
    image.tick = mirror_image.tick = snapshot.tick;
    const auto actions = planner.plan(
        snapshot,
        {{0, &snapshot.vehicles[0], &route, 8.0, test::frontViews(&image)},
         {1, &snapshot.vehicles[1], &mirror_route, 8.0, test::frontViews(&mirror_image)}});
    steers.scene.add(steerOf(actions[0]));
    steers.mirror.add(steerOf(actions[1]));
  }
  return steers;
}

/// The network is not symmetric by construction and has seen more left than right turns. Measured
/// with the shipped weights: the sums of the two steers are -0.003, 0.005 and 0.015 in the three
/// scenes below, 4 standard errors of a sum 0.015 at most. 0.05 holds both. With earlier weights
/// and an image that was not mirrored the sums were 0.11, 0.10 and 0.15, with a route that was not,
/// 0.16 in the bend; a steer of the wrong sign breaks the tests' first line. Measure again for
/// other weights.
constexpr double kTolerance = 0.05;

void expectMirrored(const MirrorSteers& steers) {
  EXPECT_NEAR(steers.scene.mean() + steers.mirror.mean(), 0.0, kTolerance)
      << steers.scene.mean() << " +- " << steers.scene.error() << " and " << steers.mirror.mean()
      << " +- " << steers.mirror.error();
  EXPECT_LT(4.0 * std::hypot(steers.scene.error(), steers.mirror.error()), 0.02);
  // So much that a sign error would break the bound above.
  EXPECT_GT(std::abs(steers.scene.mean() - steers.mirror.mean()), 2.0 * kTolerance);
}

TEST(MirrorSymmetry, LeftOfTheRoute) {
  const MirrorSteers steers =
      steersOn(testing::leftBend(40.0, 20.0, 60.0), testing::vehicleAt("v", 20.0, 0.65, 0.0, 6.0));
  EXPECT_LT(steers.scene.mean(), 0.0);  // back to the right
  expectMirrored(steers);
}

TEST(MirrorSymmetry, HeadingLeftOfTheRoute) {
  const MirrorSteers steers =
      steersOn(testing::leftBend(40.0, 20.0, 60.0), testing::vehicleAt("v", 20.0, 0.0, 0.1, 6.0));
  EXPECT_LT(steers.scene.mean(), 0.0);
  expectMirrored(steers);
}

TEST(MirrorSymmetry, StartOfALeftBend) {
  const MirrorSteers steers =
      steersOn(testing::leftBend(40.0, 20.0, 60.0), testing::vehicleAt("v", 39.0, 0.0, 0.0, 6.0));
  EXPECT_GT(steers.scene.mean(), 0.0);
  expectMirrored(steers);
}

}  // namespace
}  // namespace cdiff::planners
