// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/free_road.h"

#include <algorithm>
#include <string>

#include "metrics/measures/road_strip.h"

namespace cdiff::metrics {
namespace {

using traffic::TrafficSnapshot;
using traffic::Vehicle;

constexpr double kFreeAhead = 10.0;    // [m] of the route before the front
constexpr double kFreeBeside = 0.25;   // [m] beside the vehicle
constexpr double kBeyondLine = 1.0;    // [m] a front may be beyond the line it stands at
constexpr double kYieldRadius = 25.0;  // [m]

/// Arc lengths on the route [m].
struct Stretch {
  double center = 0.0;
  double front = 0.0;
  double end = 0.0;
};

bool shows(const TrafficSnapshot& snapshot, const map::Route::Signal& signal,
           const std::string& letters) {
  for (const traffic::SignalState& light : snapshot.signals) {
    if (light.id != signal.id) continue;
    const auto link = static_cast<std::size_t>(signal.link);
    if (signal.link < 0 || link >= light.state.size()) return false;
    return letters.find(light.state[link]) != std::string::npos;
  }
  return false;
}

bool isStopped(const map::Route& route, const Stretch& stretch, const TrafficSnapshot& snapshot) {
  const auto& signals = route.signals();
  return std::any_of(signals.begin(), signals.end(), [&](const map::Route::Signal& signal) {
    const bool ahead =
        signal.arc_length >= stretch.front - kBeyondLine && signal.arc_length <= stretch.end;
    return ahead && shows(snapshot, signal, "ruyY");
  });
}

bool touchesJunction(const map::Route& route, const Stretch& stretch) {
  const auto& junctions = route.junctionStretches();
  return std::any_of(junctions.begin(), junctions.end(), [&](const auto& junction) {
    return junction.first <= stretch.end && junction.second >= stretch.center;
  });
}

}  // namespace

bool isRoadFree(const Vehicle& vehicle, const map::Route& route, const TrafficSnapshot& snapshot) {
  const double center = route.path().project(vehicle.state.position).arc_length;
  const double front = center + 0.5 * vehicle.dimensions.length;
  const Stretch stretch{center, front, std::min(front + kFreeAhead, route.length())};
  if (isStopped(route, stretch, snapshot)) return false;
  const auto strip = stripAlong(route.path(), stretch.front, stretch.end,
                                vehicle.dimensions.width + 2.0 * kFreeBeside);
  const bool junction = touchesJunction(route, stretch);
  for (const Vehicle& other : snapshot.vehicles) {
    if (other.id == vehicle.id || !other.state.position.allFinite()) continue;
    if (traffic::onDifferentLevels(vehicle, other)) continue;
    if (overlapsStrip(other.box(), strip)) return false;
    const double distance = (other.state.position - vehicle.state.position).norm();
    if (junction && other.state.speed >= kStandingSpeed && distance <= kYieldRadius) return false;
  }
  return true;
}

}  // namespace cdiff::metrics
