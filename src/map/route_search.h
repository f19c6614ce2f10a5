// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "map/lane_graph.h"

namespace cdiff::map {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of a lane's centerline [m].
inline double lengthOf(const RoadNetwork& network, LaneIndex lane) {
  return network.lane(lane).centerline.length();
}

/// Ranking penalty of a change to the neighbor of a lane of which `available` meters are left [m]:
/// 5, more where that is too short to change comfortably, and inside junctions.
double laneChangePenalty(const Lane& lane, double available);

/// Arc length on a neighboring lane abreast of an arc length on `from` [m].
double arcLengthAbreast(const RoadNetwork& network, LaneIndex from, double arc_length,
                        LaneIndex to);

/// Whether a link enters a junction to turn round (SUMO's direction t). What has entered may leave.
bool turnsRound(const Lane& from, const LaneLink& link);

/// What a search may use.
struct SearchLimits {
  double max_length = std::numeric_limits<double>::infinity();  ///< driven [m]
  bool lane_changes = true;
  bool routable_only = true;                ///< the start's and the goal's lane always count
  const TurnRounds* turn_rounds = nullptr;  ///< the only ones to use; nullptr: all
};

/// One Dijkstra search over lanes from a place: driven length [m] ranks, with penalties for lane
/// changes.
class LaneSearch {
 public:
  LaneSearch(const RoadNetwork& network, const LanePosition& start, const SearchLimits& limits);

  /// The best route to a place.
  struct Arrival {
    double rank = std::numeric_limits<double>::infinity();    ///< driven length with penalties [m]
    double driven = std::numeric_limits<double>::infinity();  ///< [m]
    int node = -1;  ///< internal; -1 when there is no route
  };
  Arrival arrivalAt(const LanePosition& goal) const;
  std::optional<LanePath> pathTo(const LanePosition& goal) const;

  /// Driven length from the start to the start of a lane [m]: negative beside the start, infinity
  /// when not reached; for the start's own lane that of the way round.
  double lengthToStart(LaneIndex lane) const;

 private:
  // Node n < lane count: lane n entered at its start. Node lane count + n: lane n abreast of the
  // start.
  std::size_t count() const { return network_.lanes().size(); }
  LaneIndex laneOf(std::size_t node) const {
    return static_cast<LaneIndex>(node < count() ? node : node - count());
  }
  void run();
  void expand(std::size_t node);
  void relaxNeighbor(std::size_t node, LaneIndex neighbor);
  void relax(std::size_t node, std::size_t from, double rank, double driven);

  const RoadNetwork& network_;
  LanePosition start_;
  SearchLimits limits_;
  std::vector<double> rank_;
  std::vector<double>
      driven_;  ///< to the lane's beginning; negative for nodes abreast of the start
  std::vector<int> parent_;
  std::vector<std::pair<double, std::size_t>> queue_;
};

// Turns driven stretches of lanes into a route: points about 1 m apart on the centerlines (map
// frame [m]), lane changes blended with w(t) = 3 t^2 - 2 t^3.

/// The part of a lane that is driven; the next stretch follows the lane or lies on its neighbor (a
/// lane change at `end`).
struct LaneStretch {
  LaneIndex lane = kNoLane;
  double begin = 0.0;  ///< arc length [m]
  double end = 0.0;    ///< arc length [m]
};

/// Whether a link leads from one lane to the other.
bool follows(const RoadNetwork& network, LaneIndex from, LaneIndex to);

/// Adds a route from `start` on its first lane to `goal` on its last; the route goes on where
/// `drive` ends. Lane changes lie in the middle of the first 60 m that the route has for them.
void appendPath(const RoadNetwork& network, const LanePath& path, double start, double goal,
                std::vector<LaneStretch>& drive);

/// Throws InputError when the route is shorter than 1 cm.
Route buildRoute(const RoadNetwork& network, const std::vector<LaneStretch>& drive);

// Lanes that a point (map frame [m]) may lie on, and the cheapest choice of one lane for each point
// of a row.

/// A lane that a point may lie on.
struct LaneCandidate {
  LanePosition position;
  double cost = 0.0;  ///< grows with the distance to the centerline and the heading difference
};

/// A point of the input; neighbors that coincide have been merged.
struct InputPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::size_t index = 0;  ///< in the input
};

/// "(12.00, 3.50)".
std::string toText(const Eigen::Vector3d& point);

/// Points farther than `distance` [m] from the one kept before. Throws InputError when fewer than
/// two remain or a coordinate is not finite.
std::vector<InputPoint> distinctPoints(const std::vector<Eigen::Vector3d>& points, double distance);

/// Finds candidates: lanes whose centerline is within 1.5 m or whose half width covers the point,
/// on the point's level.
class CandidateFinder {
 public:
  /// Elevations are ignored when every point has z = 0 in a network with elevation.
  CandidateFinder(const RoadNetwork& network, const std::vector<InputPoint>& points);

  /// Candidates of a point that is passed with a heading; a heading difference of `heading_scale`
  /// [rad] costs 1. Throws InputError when there is none.
  std::vector<LaneCandidate> find(const InputPoint& point, double heading,
                                  double heading_scale) const;

 private:
  bool accepts(const LaneMatch& match) const;
  std::vector<LaneMatch> acceptedNear(const Eigen::Vector3d& point, double heading) const;
  [[noreturn]] void failOffLanes(const InputPoint& point) const;

  const RoadNetwork& network_;
  bool use_elevation_ = true;
  double radius_ = 0.0;
};

/// Candidates of each point, in order.
using CandidateLayers = std::vector<std::vector<LaneCandidate>>;
/// Cost from a candidate of layer i to each candidate of layer i + 1; infinity where there is no
/// route.
using TransitionCosts =
    std::function<std::vector<double>(std::size_t layer, const LaneCandidate& from)>;

/// The cheapest choice (Viterbi); ties go to the earlier candidate.
struct CheapestChoice {
  std::vector<LanePosition>
      positions;            ///< one for each layer; empty when some layer cannot be reached
  std::size_t reached = 0;  ///< last layer that can be reached
};
CheapestChoice cheapestChoice(const CandidateLayers& layers, const TransitionCosts& transitions);

}  // namespace cdiff::map
