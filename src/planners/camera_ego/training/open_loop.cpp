// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/open_loop.h"

#include <algorithm>
#include <cmath>

namespace cdiff::planners {
namespace {

constexpr std::size_t kSecond = 2;  // waypoints a second

/// The box at a waypoint, heading from the one before.
geometry::OrientedBox egoBox(const EgoWaypoints& plan, std::size_t i) {
  const Eigen::Vector2d before = i > 0 ? plan[i - 1] : Eigen::Vector2d::Zero();
  const Eigen::Vector2d way = plan[i] - before;
  const double heading = way.norm() > 0.1 ? std::atan2(way.y(), way.x()) : 0.0;
  return {plan[i], heading, kEgoBoxLength, kEgoBoxWidth};
}

bool touchesAt(const EgoExample& example, const EgoWaypoints& plan, std::size_t i) {
  const geometry::OrientedBox own = egoBox(plan, i);
  return std::any_of(example.others.begin(), example.others.end(), [&](const AgentLabel& other) {
    return i < other.future.known && geometry::overlap(own, futureBox(other, i));
  });
}

std::string second(std::size_t index) { return std::to_string(index + 1) + "s"; }

double ratio(double sum, double count) { return count > 0.0 ? sum / count : 0.0; }

}  // namespace

geometry::OrientedBox futureBox(const AgentLabel& label, std::size_t i) {
  const Eigen::Vector2d start(label.box[0], label.box[1]);
  const Eigen::Vector2d before = i > 0 ? label.future.places[i - 1] : start;
  const Eigen::Vector2d way = label.future.places[i] - before;
  const double heading = way.norm() > 0.5 ? std::atan2(way.y(), way.x()) : label.heading;
  return {label.future.places[i], heading, label.size.length, label.size.width};
}

EgoWaypoints atConstantVelocity(double speed) {
  EgoWaypoints places;
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = {speed * kEgoWaypointPeriod * static_cast<double>(i + 1), 0.0};
  return places;
}

void PlanMeasures::add(const EgoExample& example, const EgoWaypoints& plan) {
  double l2 = 0.0, collisions = 0.0;
  bool all_free = true;
  for (std::size_t i = 0; i < example.driven.known; ++i) {
    Sums& sums = sums_[i];
    const double distance = (plan[i] - example.driven.places[i]).norm();
    const bool free = !touchesAt(example, example.driven.places, i);
    const double hit = free && touchesAt(example, plan, i) ? 1.0 : 0.0;
    sums.l2 += distance;
    sums.collisions += hit;
    sums.count += 1.0;
    sums.free += free ? 1.0 : 0.0;
    l2 += distance;
    collisions += hit;
    all_free = all_free && free;
    if ((i + 1) % kSecond != 0) continue;
    const std::size_t to = i / kSecond;
    l2_sum_to_[to] += l2 / static_cast<double>(i + 1);
    count_to_[to] += 1.0;
    if (!all_free) continue;
    collisions_to_[to] += collisions / static_cast<double>(i + 1);
    free_to_[to] += 1.0;
  }
}

void PlanMeasures::merge(const PlanMeasures& other) {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    sums_[i].l2 += other.sums_[i].l2;
    sums_[i].collisions += other.sums_[i].collisions;
    sums_[i].count += other.sums_[i].count;
    sums_[i].free += other.sums_[i].free;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    l2_sum_to_[i] += other.l2_sum_to_[i];
    collisions_to_[i] += other.collisions_to_[i];
    count_to_[i] += other.count_to_[i];
    free_to_[i] += other.free_to_[i];
  }
}

void PlanMeasures::report(learning::Measures& measures) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const Sums& at = sums_[kSecond * (i + 1) - 1];
    measures[name_ + "l2_at_" + second(i) + "_m"] = ratio(at.l2, at.count);
    measures[name_ + "l2_to_" + second(i) + "_m"] = ratio(l2_sum_to_[i], count_to_[i]);
    measures[name_ + "collisions_at_" + second(i) + "_percent"] =
        100.0 * ratio(at.collisions, at.free);
    measures[name_ + "collisions_to_" + second(i) + "_percent"] =
        100.0 * ratio(collisions_to_[i], free_to_[i]);
  }
}

void DetectionMeasures::add(const EgoExample& example, std::vector<Detection> detections) {
  std::stable_sort(
      detections.begin(), detections.end(),
      [](const Detection& left, const Detection& right) { return left.score > right.score; });
  std::vector<bool> taken(example.agents.size(), false);
  labels_ += static_cast<double>(example.agents.size());
  for (const Detection& detection : detections) {
    double nearest = kReach;
    std::size_t best = taken.size();
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const AgentBox& box = example.agents[i].box;
      const double distance = (detection.center - Eigen::Vector2d(box[0], box[1])).norm();
      if (taken[i] || distance >= nearest) continue;
      nearest = distance;
      best = i;
    }
    if (best < taken.size()) taken[best] = true;
    found_.emplace_back(detection.score, best < taken.size());
  }
}

void DetectionMeasures::merge(const DetectionMeasures& other) {
  found_.insert(found_.end(), other.found_.begin(), other.found_.end());
  labels_ += other.labels_;
}

double DetectionMeasures::averagePrecision() const {
  constexpr double kLeast = 0.1;
  std::vector<std::pair<double, bool>> found = found_;
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& left, const auto& right) { return left.first > right.first; });
  std::vector<double> precision, recall;
  double right = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    right += found[i].second ? 1.0 : 0.0;
    precision.push_back(right / static_cast<double>(i + 1));
    recall.push_back(ratio(right, labels_));
  }
  for (std::size_t i = precision.size(); i-- > 1;)
    precision[i - 1] = std::max(precision[i - 1], precision[i]);
  double area = 0.0;
  std::size_t at = 0;
  for (int percent = 11; percent <= 100; ++percent) {
    while (at < recall.size() && recall[at] < 0.01 * percent) ++at;
    if (at < recall.size()) area += std::max(0.0, precision[at] - kLeast);
  }
  return area / (90.0 * (1.0 - kLeast));
}

ConstantDetections::ConstantDetections(const std::vector<std::vector<Eigen::Vector2d>>& centers,
                                       std::size_t count) {
  constexpr double kCell = 2.0;  // [m]
  struct Cell {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0.0;
  };
  std::map<std::pair<long, long>, Cell> cells;
  for (const auto& moment : centers) {
    for (const Eigen::Vector2d& center : moment) {
      Cell& cell = cells[{std::lround(center.x() / kCell), std::lround(center.y() / kCell)}];
      cell.sum += center;
      cell.count += 1.0;
    }
  }
  for (const auto& [place, cell] : cells)
    detections_.push_back(
        {cell.sum / cell.count,
         cell.count / static_cast<double>(std::max<std::size_t>(1, centers.size()))});
  std::stable_sort(
      detections_.begin(), detections_.end(),
      [](const Detection& left, const Detection& right) { return left.score > right.score; });
  if (detections_.size() > count) detections_.resize(count);
}

namespace {

using Points = std::vector<Eigen::Vector2d>;

Points pointsOf(const std::vector<BevLine>& lines, MapKind kind) {
  constexpr int kBetween = 3;  // points from one to the next
  Points points;
  for (const BevLine& line : lines) {
    for (std::size_t i = 0; line.kind == kind && i + 1 < line.points.size(); ++i) {
      for (int k = 0; k <= kBetween; ++k)
        points.push_back(line.points[i] + (line.points[i + 1] - line.points[i]) * k / kBetween);
    }
  }
  return points;
}

double meanDistance(const Points& from, const Points& to) {
  double sum = 0.0;
  for (const Eigen::Vector2d& point : from) {
    double nearest = MapMeasures::kMissing;
    for (const Eigen::Vector2d& other : to) nearest = std::min(nearest, (point - other).norm());
    sum += nearest;
  }
  return sum / static_cast<double>(from.size());
}

}  // namespace

void MapMeasures::add(const std::vector<BevLine>& lines, const std::vector<BevLine>& labels) {
  for (const MapKind kind : {MapKind::kEdge, MapKind::kDivider, MapKind::kCenter}) {
    const Points found = pointsOf(lines, kind), wanted = pointsOf(labels, kind);
    if (found.empty() && wanted.empty()) continue;
    const bool both = !found.empty() && !wanted.empty();
    sum_ += both ? 0.5 * (meanDistance(found, wanted) + meanDistance(wanted, found)) : kMissing;
    count_ += 1.0;
  }
}

void MapMeasures::merge(const MapMeasures& other) {
  sum_ += other.sum_;
  count_ += other.count_;
}

std::vector<BevLine> straightRoad(const BevGrid& bev) {
  constexpr double kLane = 3.5;  // [m]
  const Eigen::Vector2d low = bev.origin(), high = bev.fromShare({1.0, 1.0});
  const auto line = [&](MapKind kind, double y) {
    BevLine straight;
    straight.kind = kind;
    for (std::size_t i = 0; i < kLinePoints; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(kLinePoints - 1);
      straight.points[i] = {low.x() + share * (high.x() - low.x()), y};
    }
    return straight;
  };
  return {line(MapKind::kCenter, 0.0), line(MapKind::kCenter, kLane),
          line(MapKind::kDivider, 0.5 * kLane), line(MapKind::kEdge, -0.5 * kLane),
          line(MapKind::kEdge, 1.5 * kLane)};
}

}  // namespace cdiff::planners
