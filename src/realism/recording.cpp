// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/recording.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::realism {

namespace {

constexpr double kMovingSpeed = 1.0;     // above it, motion has a direction [m/s]
constexpr double kStandingSpeed = 0.02;  // up to it, noise [m/s]

/// Half of the difference of the neighbors.
template <class Difference>
Series centralDifference(const Series& values, Difference difference) {
  Series result(values.size(), kNoValue);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    result[i] = difference(values[i - 1], values[i + 1]) / 2.0;
  return result;
}

double plainDifference(double before, double after) { return after - before; }

double wrapped(double before, double after) { return core::angleDifference(after, before); }

void divide(Series& values, double divisor) {
  for (double& value : values) value /= divisor;
}

Series coordinate(const Track& track, int axis) {
  Series values;
  for (const TrackState& state : track.states) values.push_back(state.position[axis]);
  return values;
}

/// Headings without jumps.
Series unwrappedHeadings(const Track& track) {
  Series values;
  for (const TrackState& state : track.states) {
    const double before = values.empty() ? state.heading : values.back();
    values.push_back(before + core::angleDifference(state.heading, before));
  }
  return values;
}

/// Headings of motion where there is motion; elsewhere those of the nearest moving state.
void followMotion(const Series& vx, const Series& vy, const Series& speed, Track& track) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (speed[i] > kMovingSpeed) moving.push_back(i);
  }
  if (moving.empty()) return;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    const auto away = [&](std::size_t k) { return moving[k] > i ? moving[k] - i : i - moving[k]; };
    while (nearest + 1 < moving.size() && away(nearest + 1) < away(nearest)) ++nearest;
    track.states[i].heading = std::atan2(vy[moving[nearest]], vx[moving[nearest]]);
  }
}

}  // namespace

geometry::OrientedBox Track::box(std::size_t step) const {
  const TrackState& state = at(step);
  return {state.position, state.heading, length, width};
}

Motion centralMotion(const Track& track) {
  const Series dx = centralDifference(coordinate(track, 0), plainDifference);
  const Series dy = centralDifference(coordinate(track, 1), plainDifference);
  Motion motion;
  for (std::size_t i = 0; i < dx.size(); ++i)
    motion.speed.push_back(std::hypot(dx[i], dy[i]) / kStep);
  motion.acceleration = centralDifference(motion.speed, plainDifference);
  divide(motion.acceleration, kStep);
  Series headings;
  for (const TrackState& state : track.states) headings.push_back(state.heading);
  motion.yaw_rate = centralDifference(headings, wrapped);
  motion.yaw_acceleration = centralDifference(motion.yaw_rate, plainDifference);
  divide(motion.yaw_rate, kStep);
  divide(motion.yaw_acceleration, kStep * kStep);
  return motion;
}

Series smoothedDerivative(const Series& values) {
  // Least squares of a + b k + c k^2 over k = -5..5: b = sum k x_k / 110, c = sum (k^2 - 10) x_k /
  // 858; the derivative at k is b + 2 c k.
  constexpr std::ptrdiff_t kHalf = kSmoothingWindow / 2;
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  if (count < 2 * kHalf + 1) return {};
  Series result;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t center = std::clamp(i, kHalf, count - 1 - kHalf);
    double slope = 0.0;
    double curvature = 0.0;
    for (std::ptrdiff_t k = -kHalf; k <= kHalf; ++k) {
      const double value = values[static_cast<std::size_t>(center + k)];
      slope += static_cast<double>(k) * value / 110.0;
      curvature += static_cast<double>(k * k - 10) * value / 858.0;
    }
    result.push_back((slope + 2.0 * curvature * static_cast<double>(i - center)) / kStep);
  }
  return result;
}

Motion smoothedMotion(Track& track) {
  const Series none(track.states.size(), kNoValue);
  if (track.states.size() < kSmoothingWindow) return {none, none, none, none};
  const Series vx = smoothedDerivative(coordinate(track, 0));
  const Series vy = smoothedDerivative(coordinate(track, 1));
  Motion motion;
  for (std::size_t i = 0; i < vx.size(); ++i) {
    const double speed = std::hypot(vx[i], vy[i]);
    motion.speed.push_back(speed <= kStandingSpeed ? 0.0 : speed);
  }
  motion.acceleration = smoothedDerivative(motion.speed);
  followMotion(vx, vy, motion.speed, track);
  motion.yaw_rate = smoothedDerivative(unwrappedHeadings(track));
  motion.yaw_acceleration = smoothedDerivative(motion.yaw_rate);
  return motion;
}

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
  course[kCollision].push_back(nearest < 0.0 || self.touchesAt(step) ? 1.0 : 0.0);
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
