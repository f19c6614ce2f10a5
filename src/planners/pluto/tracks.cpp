// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/tracks.h"

#include <algorithm>
#include <cmath>

#include "planners/pluto/pluto_weights.h"

namespace cdiff::planners {

const TrackPoint* TrackFrame::find(std::uint32_t vehicle) const {
  const auto found = std::lower_bound(
      points.begin(), points.end(), vehicle,
      [](const TrackPoint& point, std::uint32_t number) { return point.vehicle < number; });
  return found == points.end() || found->vehicle != vehicle ? nullptr : &*found;
}

std::uint32_t VehicleTable::numberOf(const traffic::Vehicle& vehicle) {
  const auto next = static_cast<std::uint32_t>(ids_.size());
  const auto [entry, added] = numbers_.emplace(vehicle.id, next);
  if (added) {
    ids_.push_back(vehicle.id);
    sizes_.push_back(vehicle.dimensions);
  }
  return entry->second;
}

TrackFrame frameOf(const traffic::TrafficSnapshot& snapshot, VehicleTable& vehicles) {
  TrackFrame frame;
  frame.time = snapshot.time;
  frame.points.reserve(snapshot.vehicles.size());
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    TrackPoint point;
    point.vehicle = vehicles.numberOf(vehicle);
    point.acceleration = static_cast<float>(vehicle.acceleration);
    if (vehicle.applied_action) {
      point.steer = static_cast<float>(vehicle.applied_action->steer);
      point.brake = static_cast<float>(vehicle.applied_action->brake);
    }
    point.state = vehicle.state;
    frame.points.push_back(point);
  }
  std::sort(frame.points.begin(), frame.points.end(),
            [](const TrackPoint& a, const TrackPoint& b) { return a.vehicle < b.vehicle; });
  return frame;
}

void RecentTracks::add(const traffic::TrafficSnapshot& snapshot) {
  constexpr double kRounding = 0.5;  // of a period
  const bool follows = !frames_.empty() && std::abs(snapshot.time - frames_.back().time - period_) <
                                               kRounding * period_;
  if (!follows) frames_.clear();
  if (frames_.size() > static_cast<std::size_t>(kPlutoHistory)) frames_.pop_front();
  frames_.push_back(frameOf(snapshot, vehicles_));
}

std::vector<const TrackFrame*> RecentTracks::frames() const {
  std::vector<const TrackFrame*> all;
  for (const TrackFrame& frame : frames_) all.push_back(&frame);
  return all;
}

}  // namespace cdiff::planners
