// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <limits>
#include <optional>
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

}  // namespace cdiff::map
