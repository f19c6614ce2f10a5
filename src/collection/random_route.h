// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>

#include "e2e_cdiff/core/random.h"
#include "map/lane_graph.h"

namespace cdiff::collection {

/// Routes for data collection: from a place on a lane along the lane graph, with seeded random
/// turns and lane changes; lengths in meters.
struct RandomRouteOptions {
  double minimum_length = 120.0;
  double length = 250.0;            ///< wished; shorter where the network ends
  double lane_change_share = 0.15;  ///< share of changes on lanes of over 60 m
};

/// A route with turns drawn from `random` with `key` (elements from 64 on); ends outside junctions.
/// nullopt when it would be shorter than the minimum.
std::optional<map::Route> randomRoute(const map::LaneGraph& graph, const map::LanePosition& start,
                                      const RandomRouteOptions& options,
                                      const core::RandomStream& random, const core::RandomKey& key);

/// `route` and a random route on from its end, up to `length` in all; `route` itself where the
/// network ends.
map::Route extendedAtRandom(const map::LaneGraph& graph, const map::Route& route, double length,
                            const core::RandomStream& random);

}  // namespace cdiff::collection
