// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/post_encroachment.h"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>

#include "metrics/cbv_measures.h"
#include "metrics/sample_statistics.h"

namespace cdiff::metrics {
namespace {

using geometry::OrientedBox;
using traffic::Vehicle;

/// Convex set of (s, u): the first box has gone the share s of its way, the second the share u.
/// Each of the eight cuts adds at most one corner to the unit square.
using Shares = boost::container::static_vector<Eigen::Vector2d, 16>;

/// The part with normal . (s, u) <= bound.
Shares cut(const Shares& shares, const Eigen::Vector2d& normal, double bound) {
  Shares kept;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const Eigen::Vector2d& corner = shares[i];
    const Eigen::Vector2d& next = shares[(i + 1) % shares.size()];
    const double over = normal.dot(corner) - bound;
    const double next_over = normal.dot(next) - bound;
    if (over <= 0.0) kept.push_back(corner);
    if ((over < 0.0 && next_over > 0.0) || (over > 0.0 && next_over < 0.0))
      kept.push_back(corner + over / (over - next_over) * (next - corner));
  }
  return kept;
}

double reach(const OrientedBox& box, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d forward = geometry::direction(box.heading);
  return 0.5 * (box.length * std::abs(forward.dot(axis)) +
                box.width * std::abs(geometry::leftNormal(forward).dot(axis)));
}

/// Where the shadows of both boxes on an axis overlap.
void cutByAxis(Shares& shares, const SweptBox& first, const SweptBox& second,
               const Eigen::Vector2d& axis) {
  const double offset = (second.box.center - first.box.center).dot(axis);
  const Eigen::Vector2d rate{-first.offset.dot(axis), second.offset.dot(axis)};
  const double both = reach(first.box, axis) + reach(second.box, axis);
  shares = cut(shares, rate, both - offset);
  shares = cut(shares, -rate, both + offset);
}

/// Whether circles around both ways keep clear of each other.
bool farApart(const SweptBox& first, const SweptBox& second) {
  const auto radius = [](const SweptBox& way) {
    return 0.5 * (std::hypot(way.box.length, way.box.width) + way.offset.norm());
  };
  const Eigen::Vector2d between =
      second.box.center + 0.5 * second.offset - first.box.center - 0.5 * first.offset;
  const double sum = radius(first) + radius(second);
  return between.squaredNorm() > sum * sum;
}

bool usable(const Vehicle* vehicle) {
  return vehicle != nullptr && vehicle->state.position.allFinite() &&
         std::isfinite(vehicle->state.heading);
}

}  // namespace

std::optional<TimeRange> timesBetween(const SweptBox& first, const SweptBox& second) {
  Shares shares = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  for (const OrientedBox* box : {&first.box, &second.box}) {
    const Eigen::Vector2d forward = geometry::direction(box->heading);
    cutByAxis(shares, first, second, forward);
    cutByAxis(shares, first, second, geometry::leftNormal(forward));
    if (shares.empty()) return std::nullopt;
  }
  const auto time = [&](const Eigen::Vector2d& share) {
    return second.begin - first.begin + share.y() * second.duration - share.x() * first.duration;
  };
  TimeRange range{time(shares.front()), time(shares.front())};
  for (const Eigen::Vector2d& share : shares) {
    range.shortest = std::min(range.shortest, time(share));
    range.longest = std::max(range.longest, time(share));
  }
  return range;
}

const SweptBox* PostEncroachmentTimes::extend(Track& track, const Vehicle* vehicle,
                                              double time) const {
  while (!track.ways.empty() && track.ways.front().begin < time - limit_ - 1.0)
    track.ways.pop_front();
  const bool moved = track.last && last_time_ && usable(vehicle);
  if (moved) {
    SweptBox way;
    way.box = vehicle->box();
    way.box.center = track.last->state.position;
    way.offset = vehicle->state.position - track.last->state.position;
    way.elevation = vehicle->state.elevation;
    way.begin = *last_time_;
    way.duration = time - *last_time_;
    track.ways.push_back(way);
  }
  track.last = usable(vehicle) ? std::optional<Vehicle>(*vehicle) : std::nullopt;
  return moved ? &track.ways.back() : nullptr;
}

void PostEncroachmentTimes::compare(Track& cbv, const SweptBox& ego_way,
                                    const SweptBox& cbv_way) const {
  const double best = cbv.seconds.value_or(limit_);
  const double apart =
      std::abs(cbv_way.begin - ego_way.begin) - std::max(ego_way.duration, cbv_way.duration);
  if (apart > best || farApart(ego_way, cbv_way) ||
      traffic::onDifferentLevels(ego_way.elevation, cbv_way.elevation)) {
    return;
  }
  const auto range = timesBetween(ego_way, cbv_way);
  if (!range) return;
  const bool at_once = range->shortest <= 0.0 && range->longest >= 0.0;
  const double seconds =
      at_once ? 0.0 : std::min(std::abs(range->shortest), std::abs(range->longest));
  if (seconds > limit_ || (cbv.seconds && seconds >= *cbv.seconds)) return;
  cbv.seconds = seconds;
  cbv.ego_first = range->shortest > 0.0;
}

void PostEncroachmentTimes::observe(const traffic::TrafficSnapshot& snapshot) {
  const SweptBox* ego_way = extend(ego_, snapshot.ego(), snapshot.time);
  for (const Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kCbv) cbvs_.try_emplace(vehicle.id);
  }
  for (auto& [id, cbv] : cbvs_) {
    const Vehicle* vehicle = snapshot.find(id);
    if (vehicle != nullptr && vehicle->role != traffic::VehicleRole::kCbv) vehicle = nullptr;
    const SweptBox* cbv_way = extend(cbv, vehicle, snapshot.time);
    if (cbv_way != nullptr) {
      for (const SweptBox& way : ego_.ways) compare(cbv, way, *cbv_way);
    }
    if (ego_way == nullptr) continue;
    for (const SweptBox& way : cbv.ways) {
      if (&way != cbv_way) compare(cbv, *ego_way, way);
    }
  }
  last_time_ = snapshot.time;
}

std::vector<PostEncroachment> PostEncroachmentTimes::times() const {
  std::vector<PostEncroachment> all;
  for (const auto& [id, cbv] : cbvs_) {
    all.push_back({id, cbv.seconds, cbv.ego_first, {}});
    if (!cbv.seconds) {
      all.back().reason = "ego and CBV were never at one place within " +
                          std::to_string(std::lround(limit_)) + " s";
    }
  }
  return all;
}

DistributionMeasure PostEncroachmentTimes::measure() const {
  SampleStatistics statistics;
  for (const auto& [id, cbv] : cbvs_) {
    if (cbv.seconds) statistics.add(*cbv.seconds);
  }
  return statistics.measure("s", cbvs_.empty()
                                     ? std::string(kNoCbv)
                                     : "no CBV was ever at one place with the ego within " +
                                           std::to_string(std::lround(limit_)) + " s");
}

}  // namespace cdiff::metrics
