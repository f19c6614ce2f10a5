// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cdiff::planners {
namespace {

/// Reference lines in the frame of a plan, followed by a point that moves along them.
class LineFollower {
 public:
  LineFollower(const std::vector<ReferenceLine>& lines, const Eigen::Vector2d& origin)
      : places_(lines.size(), 0) {
    for (const ReferenceLine& line : lines) {
      lines_.emplace_back();
      for (const geometry::Pose2d& pose : line.poses)
        lines_.back().push_back({pose.position - origin, geometry::direction(pose.heading)});
    }
  }

  void restart() { std::fill(places_.begin(), places_.end(), 0); }

  /// Offset and heading error of a planned place from the nearest line's nearest point; lines are
  /// searched from where the last place was.
  void measure(const Eigen::Vector2d& place, const Eigen::Vector2d& direction, RiftStep& step) {
    double nearest = std::numeric_limits<double>::infinity();
    const Point* best = nullptr;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Point& point = lines_[i][advanced(i, place)];
      const double distance = (place - point.position).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      best = &point;
    }
    if (best == nullptr) return;
    step.offset = geometry::cross(best->direction, place - best->position);
    step.heading_error =
        std::atan2(geometry::cross(best->direction, direction), best->direction.dot(direction));
  }

 private:
  struct Point {
    Eigen::Vector2d position;
    Eigen::Vector2d direction;
  };
  /// The point of a line at which the distance stops to fall.
  std::size_t advanced(std::size_t line, const Eigen::Vector2d& place) {
    const std::vector<Point>& poses = lines_[line];
    std::size_t& i = places_[line];
    double here = (place - poses[i].position).squaredNorm();
    while (i + 1 < poses.size()) {
      const double next = (place - poses[i + 1].position).squaredNorm();
      if (next > here) break;
      here = next;
      ++i;
    }
    return i;
  }

  std::vector<std::vector<Point>> lines_;
  std::vector<std::size_t> places_;
};

geometry::OrientedBox boxAt(const RiftRollout& rollout, std::size_t i,
                            const traffic::VehicleDimensions& size) {
  return {{rollout.x[i], rollout.y[i]}, rollout.heading[i], size.length, size.width};
}

/// z of the route after a way driven.
double elevationAfter(const RiftState& state, double way) {
  const auto last = static_cast<double>(state.elevations.size() - 1);
  return state.elevations[static_cast<std::size_t>(std::min(last, way + 0.5))];
}

bool offRoad(const geometry::OrientedBox& box, MaskWindow& window) {
  const auto corners = box.corners();
  return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    return !window.drivable(corner.x(), corner.y());
  });
}

}  // namespace

RiftObstacles::RiftObstacles(const std::vector<RiftNeighbor>& neighbors,
                             const Eigen::Vector2d& origin) {
  constexpr double kMovingSpeed = 1.0;  // [m/s]
  constexpr double kLonger = 2.0;
  constexpr double kWider = 1.3;
  constexpr double kLarger = 1.1;
  for (std::size_t i = 0; i < kRiftSteps; ++i) {
    Step& step = steps_[i];
    for (const RiftNeighbor& neighbor : neighbors) {
      const traffic::VehicleState& state = neighbor.states[i];
      const bool moves = state.speed >= kMovingSpeed;
      const double share = static_cast<double>(i + 1) / static_cast<double>(kRiftSteps);
      const double longer = kLarger * (moves ? kLonger : 1.0);
      const double wider = kLarger * (moves ? std::max(1.0, kWider * share) : 1.0);
      geometry::OrientedBox box{state.position - origin, state.heading,
                                longer * neighbor.size.length, wider * neighbor.size.width};
      step.x.push_back(static_cast<float>(box.center.x()));
      step.y.push_back(static_cast<float>(box.center.y()));
      step.reach.push_back(static_cast<float>(0.5 * std::hypot(box.length, box.width)));
      step.boxes.push_back(box);
    }
  }
}

bool RiftObstacles::hit(std::size_t step, const geometry::OrientedBox& box) const {
  const Step& at = steps_[step];
  const auto x = static_cast<float>(box.center.x());
  const auto y = static_cast<float>(box.center.y());
  const auto own = static_cast<float>(0.5 * std::hypot(box.length, box.width) + 1e-3);
  for (std::size_t i = 0; i < at.boxes.size(); ++i) {
    const float dx = at.x[i] - x;
    const float dy = at.y[i] - y;
    const float reach = at.reach[i] + own;
    if (dx * dx + dy * dy <= reach * reach && geometry::overlap(box, at.boxes[i])) return true;
  }
  return false;
}

std::vector<double> RiftEvaluator::returnsOf(const RiftState& state,
                                             const std::vector<PlutoTrajectory>& candidates,
                                             DrivableMask& mask) const {
  const RiftObstacles obstacles(state.neighbors, state.pose.position);
  LineFollower lines(state.lines, state.pose.position);
  MaskWindow window(mask, state.pose.position);
  std::vector<double> returns;
  for (const PlutoTrajectory& candidate : candidates) {
    const RiftPlan plan(candidate, state.pose.heading);
    const RiftRollout rollout = driver_.drive(plan, state.pose.heading, state.speed);
    const RiftSeries speed = smoothed(rollout.speed);
    const RiftSeries acceleration = rateOf(speed);
    const RiftSeries turn = rateOf(rateOf(rollout.heading));
    std::array<RiftStep, kRiftSteps> steps{};
    lines.restart();
    double way = 0.0;  // [m]
    for (std::size_t i = 0; i < kRiftSteps; ++i) {
      RiftStep& step = steps[i];
      const geometry::OrientedBox box = boxAt(rollout, i + 1, state.size);
      way += rollout.speed[i] * kPlutoPeriod;
      window.moveTo(elevationAfter(state, way));
      step.speed = speed[i + 1];
      step.acceleration = acceleration[i + 1];
      step.yaw_acceleration = turn[i + 1];
      lines.measure(plan.places[i], plan.directions[i], step);
      step.off_road = offRoad(box, window);
      step.collides = obstacles.hit(i, box);
      if (step.collides) break;  // nothing counts after it
    }
    returns.push_back(riftReturn(steps));
  }
  return returns;
}

}  // namespace cdiff::planners
