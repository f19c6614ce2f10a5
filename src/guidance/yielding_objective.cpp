// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/yielding_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cdiff::guidance {
namespace {

constexpr double kFree = std::numeric_limits<double>::infinity();
constexpr double kSpacing = 0.5;             // of the places looked at along the route [m]
constexpr double kGentleAcceleration = 1.5;  // [m/s^2]
constexpr double kSlowest = 0.1;             // speed that arrivals are divided by at least [m/s]

/// Part of the route [m]; nothing where begin is above end.
struct Stretch {
  double begin = kFree;
  double end = -kFree;

  bool empty() const { return begin > end; }
  void add(double arc_length) {
    begin = std::min(begin, arc_length);
    end = std::max(end, arc_length);
  }
};

/// The vehicle's box, with the gaps, at places along its route from where it is.
class Strip {
 public:
  Strip(const GuidanceScene& scene, const YieldingObjective& gaps, std::size_t rows)
      : start_(scene.route_arc_length) {
    const geometry::Polyline& path = scene.route->path();
    const double offset =
        path.projectNear(scene.state.position, start_, kRouteReach).lateral_offset;
    const double fastest = std::max(scene.state.speed, scene.target_speed);
    const double reach =
        fastest * traffic::kRolloutStep * static_cast<double>(rows) + scene.dimensions.length;
    for (double ahead = 0.0; ahead < reach && start_ + ahead <= path.length(); ahead += kSpacing) {
      const double heading = path.headingAt(start_ + ahead);
      const Eigen::Vector2d left = geometry::leftNormal(geometry::direction(heading));
      boxes_.push_back({path.positionAt(start_ + ahead) + offset * left, heading,
                        scene.dimensions.length + 2.0 * gaps.longitudinal_gap,
                        scene.dimensions.width + 2.0 * gaps.lateral_gap});
    }
  }

  /// Where the box meets another.
  Stretch meeting(const geometry::OrientedBox& other) const {
    Stretch met;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const double near = 0.5 * (std::hypot(boxes_[i].length, boxes_[i].width) +
                                 std::hypot(other.length, other.width));
      if ((boxes_[i].center - other.center).squaredNorm() > near * near) continue;
      if (geometry::overlap(boxes_[i], other)) met.add(start_ + kSpacing * static_cast<double>(i));
    }
    return met;
  }

 private:
  double start_;
  std::vector<geometry::OrientedBox> boxes_;
};

/// Where the other, as it is forecast, meets the strip: a stretch for each row.
std::vector<Stretch> meetings(const Strip& strip, const OtherMotion& other) {
  std::vector<Stretch> met;
  for (const traffic::VehicleState& state : other.predicted) {
    met.push_back(strip.meeting(
        {state.position, state.heading, other.dimensions.length, other.dimensions.width}));
  }
  return met;
}

/// When the vehicle is at an arc length, accelerating gently to its target speed [s].
double arrivalAt(const GuidanceScene& scene, double arc_length) {
  const double way = std::max(0.0, arc_length - scene.route_arc_length);
  const double speed = std::max(0.0, scene.state.speed);
  const double top = std::max(speed, scene.target_speed);
  const double to_top = (top * top - speed * speed) / (2.0 * kGentleAcceleration);
  if (way >= to_top)
    return (top - speed) / kGentleAcceleration + (way - to_top) / std::max(top, kSlowest);
  return (std::sqrt(speed * speed + 2.0 * kGentleAcceleration * way) - speed) / kGentleAcceleration;
}

/// When the vehicle is at an arc length at its present speed [s].
double heldArrivalAt(const GuidanceScene& scene, double arc_length) {
  const double way = std::max(0.0, arc_length - scene.route_arc_length);
  return way / std::max(scene.state.speed, kSlowest);
}

/// Place of the other's center along the vehicle's heading [m].
double placeAhead(const GuidanceScene& scene, const OtherMotion& other) {
  return geometry::direction(scene.state.heading).dot(other.now.position - scene.state.position);
}

/// Whether the vehicle lets the other through that meets its way as `met`.
bool givesWay(const GuidanceScene& scene, const OtherMotion& other, const std::vector<Stretch>& met,
              double margin) {
  const auto first =
      std::find_if(met.begin(), met.end(), [](const Stretch& m) { return !m.empty(); });
  if (first == met.end()) return false;
  const double ahead = placeAhead(scene, other);
  if (first->begin <= scene.route_arc_length) return ahead > 0.0;
  const double enters = traffic::kRolloutStep * static_cast<double>(first - met.begin() + 1);
  if (other.by_same_rules) return heldArrivalAt(scene, first->begin) >= enters;
  Stretch swept = *first;
  for (auto row = first; row != met.end(); ++row) swept.end = std::max(swept.end, row->end);
  return arrivalAt(scene, swept.end) + margin > enters;
}

/// Those to give way to: the vehicles around, and the other one.
std::vector<const OtherMotion*> othersOf(const GuidanceScene& scene) {
  std::vector<const OtherMotion*> others;
  for (const OtherMotion& vehicle : scene.traffic) others.push_back(&vehicle);
  const bool on_level =
      scene.other != nullptr &&
      !traffic::onDifferentLevels(scene.other->now.elevation, scene.state.elevation);
  if (on_level) others.push_back(scene.other);
  return others;
}

/// Lowers the limits to what `met` leaves, from `margin` [s] before each row to `margin` after it.
void limitBy(const std::vector<Stretch>& met, double margin, std::vector<double>& limits) {
  const auto rows = static_cast<long>(std::min(met.size(), limits.size()));
  const long spread = std::lround(margin / traffic::kRolloutStep);
  for (long row = 0; row < rows; ++row) {
    const double begin = met[static_cast<std::size_t>(row)].begin;
    for (long t = std::max(0L, row - spread); t <= std::min(rows - 1, row + spread); ++t) {
      double& limit = limits[static_cast<std::size_t>(t)];
      limit = std::min(limit, begin);
    }
  }
}

/// Arc length of a position on the route, straight on beyond its ends, and the heading there.
geometry::Projection placeOn(const GuidanceScene& scene, const Eigen::Vector2d& position) {
  const geometry::Polyline& path = scene.route->path();
  geometry::Projection place = path.projectNear(position, scene.route_arc_length, kRouteReach);
  if (place.arc_length > 0.0 && place.arc_length < path.length()) return place;
  place.arc_length +=
      geometry::direction(place.heading).dot(position - path.positionAt(place.arc_length));
  return place;
}

}  // namespace

void YieldingObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"longitudinal_gap", "m", "Kept between bumpers."}, longitudinal_gap, 0.0, 50.0);
  visitor.number({"lateral_gap", "m", "Kept between sides."}, lateral_gap, 0.0, 5.0);
  visitor.number({"margin", "s", "Time kept before and after the other vehicle."}, margin, 0.0,
                 3.0);
}

void YieldingObjective::prepare(const GuidanceScene& scene) {
  limits_.clear();
  const std::vector<const OtherMotion*> others = othersOf(scene);
  if (scene.route == nullptr || scene.route->empty() || others.empty()) return;
  const Strip strip(scene, *this, others.front()->predicted.size());
  limits_.assign(others.front()->predicted.size(), kFree);
  for (const OtherMotion* other : others) {
    const std::vector<Stretch> met = meetings(strip, *other);
    if (givesWay(scene, *other, met, margin)) limitBy(met, margin, limits_);
  }
}

double YieldingObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                   traffic::Rollout& gradient) const {
  double sum = 0.0;
  const auto known = static_cast<Eigen::Index>(limits_.size());
  for (Eigen::Index row = 0; row < std::min(rollout.rows(), known); ++row) {
    const double limit = limits_[static_cast<std::size_t>(row)];
    if (limit == kFree) continue;
    const geometry::Projection place = placeOn(scene, positionOnMap(scene, rollout, row));
    const double beyond = place.arc_length - limit;
    if (beyond <= 0.0) continue;
    sum += beyond * beyond;
    addPositionGradient(scene, 2.0 * beyond * geometry::direction(place.heading), row, gradient);
  }
  return sum;
}

std::unique_ptr<Objective> YieldingObjective::clone() const {
  return std::make_unique<YieldingObjective>(*this);
}

}  // namespace cdiff::guidance
