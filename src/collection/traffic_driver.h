// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cbv/cbv_selector.h"
#include "collection/collection_options.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "map/lane_graph.h"
#include "planning/route_follower.h"

namespace cdiff::collection {

/// Routes for data collection: from a place on a lane along the lane graph, with seeded random
/// turns and lane changes; lengths in meters.
struct RandomRouteOptions {
  double minimum_length = 120.0;
  double length = 250.0;            ///< desired; shorter where the network ends
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

/// Reasons of release that CBV identification does not have.
inline constexpr const char* kStoodTooLong = "stood_too_long";
inline constexpr const char* kLeftRoad = "left_road";

/// Fills the slots of data collection with background vehicles near the ego, each on a random route
/// of its own, and releases them; speaks as CBV identification does, so that the world and the
/// records need not know. Distances in meters, times in seconds.
class TrafficDriver : public cbv::VehicleSelector {
 public:
  /// References must outlive the object.
  TrafficDriver(const CollectionOptions& options, const map::LaneGraph& graph,
                const map::DrivableArea& area, std::uint64_t seed);

  /// Remembers contacts.
  void observe(const traffic::TrafficSnapshot& snapshot) override;
  /// The conflict point of an assignment is the end of its route.
  cbv::CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;

 private:
  struct Held {
    cbv::CbvAssignment assignment;
    planning::RouteFollower follower;
    double standing_since = -1.0;
  };
  void updateHeld(const traffic::TrafficSnapshot& snapshot, cbv::CbvSelection& selection);
  const char* releaseReason(const traffic::TrafficSnapshot& snapshot, Held& held) const;
  void fill(const traffic::TrafficSnapshot& snapshot);
  std::vector<const traffic::Vehicle*> candidates(const traffic::TrafficSnapshot& snapshot) const;
  double spaceAround(const traffic::TrafficSnapshot& snapshot,
                     const traffic::Vehicle& vehicle) const;
  bool take(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle, int slot);

  CollectionOptions options_;
  const map::LaneGraph& graph_;
  const map::DrivableArea& area_;
  core::RandomStream random_;
  std::map<int, Held> slots_;
  std::map<std::string, double> not_before_;  ///< by vehicle: time it may be driven again
  std::set<std::string> contacted_;
};

}  // namespace cdiff::collection
