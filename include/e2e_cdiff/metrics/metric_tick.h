// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// The ego against the vehicles on its level: minima over those where defined.
struct Interaction {
  std::optional<double> ttc_2d;            ///< vehicles within the radius [s]
  std::optional<double> ttc_2d_cbv;        ///< the same, CBVs alone [s]
  std::optional<double> ttc_lon_lat;       ///< by the paper's wording; at decision ticks [s]
  std::optional<double> rift_ttc;          ///< by RIFT's ray cast; at decision ticks [s]
  std::optional<double> rift_act;          ///< by RIFT's ACT; at decision ticks [s]
  std::optional<double> nearest_distance;  ///< between boxes, at any distance [m]
  const traffic::Vehicle* ttc_2d_partner =
      nullptr;  ///< whose time `ttc_2d` is; the first of equals
};

/// A CBV of the tick.
struct CbvSighting {
  const traffic::Vehicle* vehicle = nullptr;
  bool off_road = false;                     ///< whether its center is off the drivable area
  std::optional<double> wanted_speed = {};   ///< target speed capped by the lane's limit [m/s]
  std::optional<double> ego_distance = {};   ///< distance between the centers of ego and CBV [m]
  bool corner_off_road = false;              ///< whether any corner of its box is off the road
  double chord = 0.0;                        ///< driven since the last tick, where it was CBV [m]
  std::optional<double> edge_distance = {};  ///< smallest signed distance of its corners to the
                                             ///< edge of the drivable area, positive inside [m]

  /// Whether its position is finite.
  bool placed() const { return vehicle->state.position.allFinite(); }
};

/// A contact that began at the tick, with the parts that ego and CBVs have in it.
struct ContactSighting {
  std::string ego_partner;        ///< id of the other vehicle; empty in a contact without the ego
  std::vector<std::string> cbvs;  ///< ids of the CBVs in it
  std::string striker;  ///< id of the vehicle at fault; empty: not judged (docs/protocols.md)
};

/// A contact of the ego and who is at fault (docs/protocols.md).
struct EgoContact {
  std::uint64_t tick = 0;  ///< first tick with overlap
  double seconds = 0.0;    ///< its time [s]
  std::string partner;     ///< id of the other vehicle
  bool ego_at_fault = false;
  std::string reason;          ///< why, in a short sentence
  double ego_speed = 0.0;      ///< at that tick [m/s]
  double partner_speed = 0.0;  ///< [m/s]
  std::string ego_side;        ///< "front", "rear", "left side", "right side"; empty: not known
  std::string partner_side;
  double x = 0.0;          ///< place of the contact, map frame [m]
  double y = 0.0;          ///< [m]
  bool avoidable = false;  ///< whether the ego could have avoided it by braking (docs/metrics.md)
};

/// One tick as metrics see it: the snapshot, the selection, and what several metrics need of them
/// (map frame, SI units). The actions are in the snapshot (`traffic::Vehicle::applied_action`).
struct MetricTick {
  const traffic::TrafficSnapshot& snapshot;
  const cbv::CbvSelection* selection = nullptr;  ///< at decision ticks, where known; else nullptr
  const traffic::Vehicle* ego = nullptr;         ///< nullptr without one
  bool ego_off_road = false;                     ///< whether its center is off the drivable area
  double ego_arc_length = 0.0;                   ///< farthest place reached along the ego route [m]
  double route_completion_percent = 0.0;  ///< the ego's route completion, by the protocol's rule
  Interaction interaction = {};
  std::vector<CbvSighting> cbvs = {};  ///< vehicles whose role is CBV, in the snapshot's order
  std::vector<ContactSighting> contacts = {};
  std::vector<EgoContact> ego_contacts = {};  ///< that began at this tick, judged
};

}  // namespace cdiff::metrics
