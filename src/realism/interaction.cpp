// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/interaction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::realism {
namespace {

/// How far two boxes reach into each other along an axis [m]; negative: apart.
double reach(const geometry::OrientedBox& first, const geometry::OrientedBox& second,
             const Eigen::Vector2d& axis) {
  return geometry::halfExtent(first, axis) + geometry::halfExtent(second, axis) -
         std::abs((first.center - second.center).dot(axis));
}

/// Gap ahead [m], or kNobody for a vehicle that is not followed.
double gapAhead(const geometry::OrientedBox& self, const geometry::OrientedBox& other) {
  constexpr double kLargestAngle = 75.0;
  constexpr double kSmallOverlapAngle = 10.0;
  constexpr double kSmallOverlap = 0.5;
  const Eigen::Vector2d ahead = geometry::direction(self.heading);
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const Eigen::Vector2d offset = other.center - self.center;
  const double gap = offset.dot(ahead) - 0.5 * self.length - geometry::halfExtent(other, ahead);
  const double beside =
      std::abs(offset.dot(left)) - 0.5 * self.width - geometry::halfExtent(other, left);
  const double angle = std::abs(core::angleDifference(other.heading, self.heading));
  const bool small = beside >= -kSmallOverlap;
  const double largest = core::degreesToRadians(small ? kSmallOverlapAngle : kLargestAngle);
  return gap > 0.0 && beside < 0.0 && angle <= largest ? gap : kNobody;
}

bool meet(const Track& self, const Track& other, std::size_t step) {
  return &self != &other && other.covers(step) &&
         !traffic::onDifferentLevels(self.at(step).elevation, other.at(step).elevation);
}

/// Cheap bound that spares the separating axes.
bool mayBeNearer(const geometry::OrientedBox& first, const geometry::OrientedBox& second,
                 double distance) {
  const double radii = 0.5 * (first.length + first.width + second.length + second.width);
  return (first.center - second.center).norm() - radii < distance;
}

/// Nearest object and time to collision of one step.
void addStep(const Recording& recording, const std::vector<Motion>& motions, std::size_t track,
             std::size_t step, Course& course) {
  const Track& self = recording.tracks[track];
  const geometry::OrientedBox box = self.box(step);
  double nearest = kNobody;
  std::vector<MovingBox> others;
  for (std::size_t i = 0; i < recording.tracks.size(); ++i) {
    const Track& other = recording.tracks[i];
    if (!meet(self, other, step)) continue;
    const geometry::OrientedBox its = other.box(step);
    if (mayBeNearer(box, its, nearest)) nearest = std::min(nearest, signedDistance(box, its));
    others.push_back({its, motions[i].speed[step - other.first]});
  }
  course[kNearestObject].push_back(nearest);
  course[kCollision].push_back(nearest < 0.0 ? 1.0 : 0.0);
  const double speed = motions[track].speed[step - self.first];
  course[kTimeToCollision].push_back(timeToCollision({box, speed}, others));
}

}  // namespace

double signedDistance(const geometry::OrientedBox& first, const geometry::OrientedBox& second) {
  const double apart = geometry::distance(first, second);
  if (apart > 0.0) return apart;
  double depth = std::numeric_limits<double>::infinity();
  for (const double heading : {first.heading, second.heading}) {
    const Eigen::Vector2d along = geometry::direction(heading);
    depth = std::min({depth, reach(first, second, along),
                      reach(first, second, Eigen::Vector2d(-along.y(), along.x()))});
  }
  return -std::max(0.0, depth);
}

double timeToCollision(const MovingBox& self, const std::vector<MovingBox>& others) {
  double gap = kNobody;
  double speed = 0.0;
  for (const MovingBox& other : others) {
    const double ahead = gapAhead(self.box, other.box);
    if (ahead >= gap) continue;
    gap = ahead;
    speed = other.speed;
  }
  const double closing = self.speed - speed;
  return closing > 0.0 ? std::min(gap / closing, kLongestTime) : kLongestTime;
}

Course courseOf(const Recording& recording, const std::vector<Motion>& motions, std::size_t track,
                std::size_t begin, std::size_t end) {
  const Track& self = recording.tracks[track];
  const Motion& motion = motions[track];
  const std::pair<Feature, const Series*> kinematics[] = {
      {kLinearSpeed, &motion.speed},
      {kLinearAcceleration, &motion.acceleration},
      {kAngularSpeed, &motion.yaw_rate},
      {kAngularAcceleration, &motion.yaw_acceleration}};
  Course course;
  for (std::size_t step = begin; step < end; ++step) {
    const bool there = self.covers(step);
    for (const auto& [feature, values] : kinematics)
      course[feature].push_back(there ? (*values)[step - self.first] : kNoValue);
    if (there) {
      addStep(recording, motions, track, step, course);
    } else {
      for (const Feature feature : {kNearestObject, kCollision, kTimeToCollision})
        course[feature].push_back(kNoValue);
    }
  }
  return course;
}

}  // namespace cdiff::realism
