// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "map/lane_graph.h"

namespace cdiff::suite {

/// A route for an ego that a network offers: whole edges, and how much of the first and the last is
/// left out.
struct SuggestedRoute {
  std::vector<std::string> edges;  ///< in driving order
  double start_offset = 5.0;       ///< from the first edge's start [m]
  double end_offset = 5.0;         ///< from the last edge's end [m]
  double length = 0.0;             ///< driven [m]
  int conflicts = 0;               ///< edges from which other streams cross or join it
  std::string manoeuvre;           ///< "left", "right", "straight" or "bends"
};

/// The ends that a user wishes; empty: any.
struct RouteEnds {
  std::string from;  ///< first edge
  std::string to;    ///< last edge
};

/// Routes for a test, best first, at most `count`. With both ends: the shortest way from one edge
/// to the other. Else routes through one junction or a few, with some 80 m before and after the
/// turn; many conflicts, no lane changes and left turns come first, ties by the edges' names, and
/// about a third of them is of each maneuver. In a
/// network without junctions: the longest edges. Throws InputError naming an unknown edge with the
/// nearest one, ends without a way for cars between them, and a network without a road for cars.
std::vector<SuggestedRoute> suggestRoutes(const map::LaneGraph& graph, const RouteEnds& ends,
                                          std::size_t count);

/// "left, 183 m, 3 conflicts".
std::string routeText(const SuggestedRoute& route);

}  // namespace cdiff::suite
