// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/range_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::rendering {
namespace {

constexpr std::int64_t kMostBeams = 200000;

double step(const RangeSensorOptions& options) {
  return 2.0 * core::kPi / static_cast<double>(options.beams);
}

/// A point of the map frame as seen from the sensor: x along the vehicle's heading.
Eigen::Vector3d seenFrom(const Eigen::Vector3d& origin, double heading,
                         const Eigen::Vector3d& point) {
  const Eigen::Vector3d away = point - origin;
  const Eigen::Vector2d forward = geometry::direction(heading);
  return {forward.dot(away.head<2>()), geometry::cross(forward, away.head<2>()), away.z()};
}

/// Distance at which a ray from (0, 0, 0) meets a triangle (Moller-Trumbore); infinity where it
/// does not.
double distanceTo(const Eigen::Vector3d& direction, const Eigen::Vector3d& a,
                  const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kRounding = 1e-9;
  const Eigen::Vector3d first = b - a;
  const Eigen::Vector3d second = c - a;
  const Eigen::Vector3d across = direction.cross(second);
  const double determinant = first.dot(across);
  if (std::abs(determinant) < kRounding) return kInfinity;
  const double u = -a.dot(across) / determinant;
  if (u < -kRounding || u > 1.0 + kRounding) return kInfinity;
  const Eigen::Vector3d normal = (-a).cross(first);
  const double v = direction.dot(normal) / determinant;
  if (v < -kRounding || u + v > 1.0 + kRounding) return kInfinity;
  const double distance = second.dot(normal) / determinant;
  return distance > 0.0 ? distance : kInfinity;
}

/// An interval of the distance along a ray [m].
struct Span {
  double near = 0.0;
  double far = std::numeric_limits<double>::infinity();

  /// Leaves what lies between two parallel planes at `low` and `high` along an axis.
  void cut(double start, double along, double low, double high) {
    if (along == 0.0) {
      if (start < low || start > high) far = -1.0;
      return;
    }
    const double first = (low - start) / along;
    const double second = (high - start) / along;
    near = std::max(near, std::min(first, second));
    far = std::min(far, std::max(first, second));
  }
};

}  // namespace

void RangeSensorOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"rings", "", "Cones of beams."}, rings, 1, 128);
  visitor.integer({"beams", "", "Beams of a ring."}, beams, 8, 4096);
  visitor.number({"lowest", "rad", "Angle of the lowest ring above the horizon."}, lowest, -1.5,
                 1.5);
  visitor.number({"highest", "rad", "Angle of the highest ring."}, highest, -1.5, 1.5);
  visitor.number({"height", "m", "Height above the road."}, height, 0.05, 5.0);
  visitor.number({"range", "m", "Farther things are not seen."}, range, 1.0, 300.0);
}

void RangeSensorOptions::validate(const std::string& group) const {
  const bool ordered = rings == 1 ? lowest == highest : lowest < highest;
  if (!ordered) {
    throw core::InputError("keys '" + group + "lowest' (" + core::formatNumber(lowest) +
                           " rad) and '" + group + "highest' (" + core::formatNumber(highest) +
                           " rad) do not fit " + std::to_string(rings) +
                           " rings; expected lowest < highest, and the same for one ring");
  }
  if (rings * beams > kMostBeams) {
    throw core::InputError("keys '" + group + "rings' and '" + group + "beams' make " +
                           std::to_string(rings * beams) + " beams; expected at most " +
                           std::to_string(kMostBeams));
  }
}

double RangeSensorOptions::elevation(std::int64_t ring) const {
  if (rings == 1) return lowest;
  return lowest + (highest - lowest) * static_cast<double>(ring) / static_cast<double>(rings - 1);
}

double RangeSensorOptions::azimuth(std::int64_t beam) const {
  return -core::kPi + step(*this) * static_cast<double>(beam);
}

/// The beams that may hit a thing; `first` may be below 0 and counts around.
struct RangeSensor::Beams {
  std::int64_t first = 0;
  std::int64_t count = 0;
  std::int64_t lowest_ring = 0;
  std::int64_t highest_ring = -1;

  template <class Hit>
  void each(const RangeSensorOptions& options, Hit&& hit) const {
    for (std::int64_t ring = lowest_ring; ring <= highest_ring; ++ring) {
      for (std::int64_t i = first; i < first + count; ++i) {
        const std::int64_t beam = (i % options.beams + options.beams) % options.beams;
        hit(static_cast<std::size_t>(ring * options.beams + beam));
      }
    }
  }
};

RangeSensor::RangeSensor(const RangeSensorOptions& options, const map::RoadNetwork& network,
                         const std::string& group)
    : options_(options), surfaces_(surfacesOf(network)) {
  options_.validate(group);
  for (const Surface& surface : surfaces_)
    bounds_.push_back(boundOf(surface.corners.data(), surface.count));
  for (std::int64_t ring = 0; ring < options_.rings; ++ring) {
    const double up = options_.elevation(ring);
    for (std::int64_t beam = 0; beam < options_.beams; ++beam) {
      const Eigen::Vector2d flat = std::cos(up) * geometry::direction(options_.azimuth(beam));
      directions_.emplace_back(flat.x(), flat.y(), std::sin(up));
    }
  }
}

RangeScan RangeSensor::scan(const traffic::TrafficSnapshot& snapshot,
                            const std::string& vehicle_id) {
  const traffic::Vehicle* carrier = snapshot.find(vehicle_id);
  if (carrier == nullptr) {
    throw core::InputError("no scan from vehicle '" + vehicle_id + "': tick " +
                           std::to_string(snapshot.tick) +
                           " does not hold it; a vehicle that was removed has no sensors");
  }
  const traffic::VehicleState& state = carrier->state;
  const Eigen::Vector3d origin(state.position.x(), state.position.y(),
                               state.elevation + options_.height);
  RangeScan scan;
  scan.tick = snapshot.tick;
  scan.ranges.assign(directions_.size(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    if ((bounds_[i].center - origin).norm() - bounds_[i].radius <= options_.range)
      castAtSurface(surfaces_[i], origin, state.heading, scan.ranges);
  }
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (&vehicle != carrier) castAtVehicle(vehicle, origin, state.heading, scan.ranges);
  }
  return scan;
}

/// `corners` around a convex outline, as the sensor sees them.
RangeSensor::Beams RangeSensor::beamsToward(const Eigen::Vector3d* corners, int count) const {
  const Bound bound = boundOf(corners, count);
  const double away = bound.center.head<2>().norm();
  const double near = away - bound.radius;
  const double far = away + bound.radius;
  const Beams all = {0, options_.beams, 0, options_.rings - 1};
  if (near <= 0.0) return all;
  const double middle = std::atan2(bound.center.y(), bound.center.x());
  const double half_angle = std::asin(std::min(1.0, bound.radius / away));
  const double rise = bound.center.z() + bound.radius;
  const double fall = bound.center.z() - bound.radius;
  const double top = std::atan2(rise, rise > 0.0 ? near : far);
  const double bottom = std::atan2(fall, fall < 0.0 ? near : far);
  Beams beams;
  double right = half_angle;
  double left = -half_angle;
  for (int i = 0; i < count; ++i) {
    const double angle = core::angleDifference(std::atan2(corners[i].y(), corners[i].x()), middle);
    right = std::min(right, angle);
    left = std::max(left, angle);
  }
  const auto index = [&](double angle) { return (middle + angle + core::kPi) / step(options_); };
  beams.first = static_cast<std::int64_t>(std::floor(index(right)));
  beams.count = static_cast<std::int64_t>(std::ceil(index(left))) - beams.first + 1;
  beams.count = std::min(beams.count, options_.beams);
  while (beams.lowest_ring < options_.rings && options_.elevation(beams.lowest_ring) < bottom)
    ++beams.lowest_ring;
  beams.highest_ring = options_.rings - 1;
  while (beams.highest_ring >= 0 && options_.elevation(beams.highest_ring) > top)
    --beams.highest_ring;
  return beams;
}

void RangeSensor::castAtSurface(const Surface& surface, const Eigen::Vector3d& origin,
                                double heading, std::vector<float>& ranges) const {
  std::array<Eigen::Vector3d, 4> seen;
  for (int i = 0; i < surface.count; ++i) {
    const auto corner = static_cast<std::size_t>(i);
    seen[corner] = seenFrom(origin, heading, surface.corners[corner]);
  }
  beamsToward(seen.data(), surface.count).each(options_, [&](std::size_t beam) {
    const Eigen::Vector3d& direction = directions_[beam];
    double distance = distanceTo(direction, seen[0], seen[1], seen[2]);
    if (surface.count == 4)
      distance = std::min(distance, distanceTo(direction, seen[0], seen[2], seen[3]));
    if (distance <= options_.range)
      ranges[beam] = std::min(ranges[beam], static_cast<float>(distance));
  });
}

void RangeSensor::castAtVehicle(const traffic::Vehicle& vehicle, const Eigen::Vector3d& origin,
                                double heading, std::vector<float>& ranges) const {
  const geometry::OrientedBox box = vehicle.box();
  const double bottom = vehicle.state.elevation;
  const double top = bottom + vehicle.dimensions.height;
  std::array<Eigen::Vector3d, 8> seen;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::Vector2d corner = box.corners()[i % 4];
    seen[i] = seenFrom(origin, heading, {corner.x(), corner.y(), i < 4 ? bottom : top});
  }
  const Eigen::Vector3d center =
      seenFrom(origin, heading, {box.center.x(), box.center.y(), bottom});
  const Eigen::Vector2d forward = geometry::direction(box.heading - heading);
  const Eigen::Vector2d away = -center.head<2>();  // the sensor from the box
  const double along = forward.dot(away);
  const double beside = geometry::cross(forward, away);
  beamsToward(seen.data(), static_cast<int>(seen.size())).each(options_, [&](std::size_t beam) {
    const Eigen::Vector3d& direction = directions_[beam];
    Span span;
    span.cut(along, forward.dot(direction.head<2>()), -0.5 * box.length, 0.5 * box.length);
    span.cut(beside, geometry::cross(forward, direction.head<2>()), -0.5 * box.width,
             0.5 * box.width);
    span.cut(-center.z(), direction.z(), 0.0, vehicle.dimensions.height);
    if (span.near <= span.far && span.near <= options_.range)
      ranges[beam] = std::min(ranges[beam], static_cast<float>(span.near));
  });
}

std::vector<Eigen::Vector3f> RangeSensor::points(const RangeScan& scan) const {
  const Eigen::Vector3d mount(0.0, 0.0, options_.height);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    if (!std::isfinite(scan.ranges[beam])) continue;
    points.emplace_back(
        (mount + static_cast<double>(scan.ranges[beam]) * directions_[beam]).cast<float>());
  }
  return points;
}

}  // namespace cdiff::rendering
