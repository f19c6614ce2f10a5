// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/free_road.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace cdiff::metrics {

namespace {

/// Of the circle around a box [m].
double radiusOf(const geometry::OrientedBox& box) {
  return 0.5 * std::hypot(box.length, box.width);
}

}  // namespace

std::vector<geometry::OrientedBox> stripAlong(const geometry::Polyline& line, double begin,
                                              double end, double width) {
  constexpr double kPiece = 2.0;  // [m]
  begin = std::max(begin, 0.0);
  end = std::min(end, line.length());
  std::vector<geometry::OrientedBox> strip;
  if (!(end > begin)) return strip;
  const int pieces = static_cast<int>(std::ceil((end - begin) / kPiece));
  Eigen::Vector2d from = line.positionAt(begin);
  for (int i = 1; i <= pieces; ++i) {
    const Eigen::Vector2d to = line.positionAt(begin + (end - begin) * i / pieces);
    const Eigen::Vector2d chord = to - from;
    strip.push_back({0.5 * (from + to), std::atan2(chord.y(), chord.x()), chord.norm(), width});
    from = to;
  }
  return strip;
}

bool overlapsStrip(const geometry::OrientedBox& box,
                   const std::vector<geometry::OrientedBox>& strip) {
  const double radius = radiusOf(box);
  return std::any_of(strip.begin(), strip.end(), [&](const geometry::OrientedBox& piece) {
    const double reach = radius + radiusOf(piece);
    return (piece.center - box.center).squaredNorm() <= reach * reach && overlap(piece, box);
  });
}

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
