// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/suite_route.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/route_source.h"

namespace cdiff::suite {
namespace {

constexpr double kMargin = 5.0;  ///< from both ends of the road [m]

/// Arc lengths of the whole maneuver: from the first junction to the last.
struct Stretch {
  double begin = 0.0;
  double end = 0.0;
};

Stretch manoeuvreOf(const map::Route& route) {
  const auto& junctions = route.junctionStretches();
  return {junctions.front().first, junctions.back().second};
}

}  // namespace

double turnAlong(const map::Route& route) {
  constexpr double kBeside = 3.0;  // [m]
  if (route.junctionStretches().empty()) return 0.0;
  const Stretch stretch = manoeuvreOf(route);
  const geometry::Polyline& path = route.path();
  double turn = 0.0;
  double before = path.headingAt(stretch.begin - kBeside);
  for (double arc = stretch.begin - kBeside; arc <= stretch.end + kBeside; arc += 1.0) {
    const double heading = path.headingAt(arc);
    turn += core::wrapAngle(heading - before);
    before = heading;
  }
  return turn / core::kDegree;
}

std::string manoeuvreAt(double turn) {
  constexpr double kLeastTurn = 45.0;
  constexpr double kMostTurn = 135.0;
  constexpr double kStraight = 25.0;
  if (std::abs(turn) <= kStraight) return "straight";
  if (std::abs(turn) < kLeastTurn || std::abs(turn) > kMostTurn) return "";
  return turn > 0.0 ? "left" : "right";
}

namespace {

/// The lane from which traffic comes onto an internal one.
map::LaneIndex approachOf(const map::RoadNetwork& network, map::LaneIndex lane) {
  while (network.lane(lane).internal && !network.lane(lane).previous.empty())
    lane = network.lane(lane).previous.front();
  return lane;
}

bool touches(const map::Lane& lane, const map::Route& route, const Stretch& stretch) {
  constexpr double kTouch = 1.5;  // between the middles of lanes [m]
  const double reach = lane.centerline.length() + kTouch + 1.0;
  const Eigen::Vector2d middle = route.path().positionAt(0.5 * (stretch.begin + stretch.end));
  const double far = reach + 0.5 * (stretch.end - stretch.begin);
  if ((lane.centerline.positionAt(0.0) - middle).norm() > far) return false;
  for (const Eigen::Vector3d& point : lane.centerline.resampled(1.0)) {
    const auto nearest = route.path().project(point.head<2>(), stretch.begin, stretch.end);
    if (nearest.distance < kTouch && std::abs(nearest.elevation - point.z()) < 2.0) return true;
  }
  return false;
}

}  // namespace

int conflictsAlong(const map::RoadNetwork& network, const map::Route& route) {
  if (route.junctionStretches().empty()) return 0;
  const Stretch stretch = manoeuvreOf(route);
  std::set<std::string> approaches;
  const std::set<map::LaneIndex> own(route.lanes().begin(), route.lanes().end());
  for (map::LaneIndex i = 0; i < static_cast<map::LaneIndex>(network.lanes().size()); ++i) {
    const map::Lane& lane = network.lane(i);
    if (!lane.internal || !touches(lane, route, stretch)) continue;
    const map::LaneIndex approach = approachOf(network, i);
    if (own.count(approach) == 0) approaches.insert(network.lane(approach).edge_id);
  }
  return static_cast<int>(approaches.size());
}

namespace {

/// A tenth of a meter, so that files hold short numbers.
double rounded(double value) { return std::round(10.0 * value) / 10.0; }

/// Draws how much of the roads before and after the maneuver is driven.
bool drawOffsets(const map::Route& whole, const Stretch& stretch, Draws& draws, SuiteRoute& route) {
  constexpr double kLeastApproach = 30.0;  // [m]
  constexpr double kLeastExit = 25.0;      // [m]
  const double wished = draws.uniform(110.0, 190.0);
  const double share = draws.uniform(0.45, 0.65);
  const double before = stretch.begin - 1.0;
  const double after = whole.length() - stretch.end - 1.0;
  if (before < kLeastApproach || after < kLeastExit) return false;
  const double spare = wished - (stretch.end - stretch.begin);
  const double approach = std::clamp(share * spare, kLeastApproach, before);
  const double exit = std::clamp(spare - approach, kLeastExit, after);
  route.start_offset = rounded(kMargin + stretch.begin - approach);
  route.end_offset = rounded(kMargin + whole.length() - stretch.end - exit);
  return true;
}

std::optional<map::Route> routeOf(const map::LaneGraph& graph, const SuiteRoute& route) {
  try {
    return map::routeAlongEdges(graph, route.edges, route.start_offset, route.end_offset);
  } catch (const core::InputError&) {
    return std::nullopt;  // lanes without a connection, or an edge that is too short
  }
}

}  // namespace

const std::vector<std::string>& manoeuvres() {
  static const std::vector<std::string> names = {"left", "right", "straight", "roundabout",
                                                 "merge"};
  return names;
}

const std::vector<std::string>& densities() {
  static const std::vector<std::string> names = {"low", "medium", "high"};
  return names;
}

int vehiclesAt(const std::string& density) {
  if (density == "low") return 9;
  return density == "medium" ? 12 : 16;
}

std::optional<SuiteRoute> planRoute(const map::LaneGraph& graph, const PlannedPath& path,
                                    Draws& draws) {
  SuiteRoute planned;
  planned.edges = path.edges;
  planned.start_offset = kMargin;
  planned.end_offset = kMargin;
  const std::optional<map::Route> whole = routeOf(graph, planned);
  if (!whole || whole->junctionStretches().empty()) return std::nullopt;
  if (!drawOffsets(*whole, manoeuvreOf(*whole), draws, planned)) return std::nullopt;
  const std::optional<map::Route> route = routeOf(graph, planned);
  if (!route || !route->laneChanges().empty()) return std::nullopt;
  if (route->length() < kShortestRoute || route->length() > kLongestRoute) return std::nullopt;
  planned.turn = rounded(turnAlong(*route));
  planned.length = rounded(route->length());
  planned.manoeuvre = path.purpose.empty() ? manoeuvreAt(planned.turn) : path.purpose;
  planned.conflicts = conflictsAlong(graph.network(), *route);
  if (planned.manoeuvre.empty() || planned.conflicts == 0) return std::nullopt;
  return planned;
}

std::string scenarioText(const SuiteRoute& route) {
  return "# SPDX-License-Identifier: BSD-3-Clause\n"
         "# Copyright (c) 2026 The e2e_cdiff authors\n"
         "#\n# Route of a suite: " +
         route.manoeuvre + ", traffic " + route.density +
         ".\n\nschema_version: 1\nname: " + route.name + "\nnetwork: ../networks/" + route.network +
         "/" + route.network + ".net.xml\nroute:\n  edges: [" + core::joinText(route.edges, ", ") +
         "]\n  start_offset: " + core::formatNumber(route.start_offset) +
         "\n  end_offset: " + core::formatNumber(route.end_offset) +
         "\n  start_speed: 6\ndemand: generated\ntraffic:\n  density: " +
         std::to_string(vehiclesAt(route.density)) +
         "\n  radius: 120\n  warm_up: 30\nprotocol:\n  preset: rift_dev10\n"
         "verdict:\n  minimum_route_completion: 90\n  statuses: [completed, timed_out, collided]\n"
         "  maximum_contacts_at_fault: 0\n  contact_without_fault: by_mode\n"
         "seed: " +
         std::to_string(route.seed) + "\n";
}

}  // namespace cdiff::suite
