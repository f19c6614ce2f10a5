// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "session/session_setup.h"

namespace cdiff::collection {

// Training samples from a session that the collection drove, just now or from its bag.

/// A stretch during which one vehicle follows one route: vehicle and the tick it was selected at.
using DriveKey = std::pair<std::string, std::uint64_t>;

/// The image that a driven vehicle was shown at a decision.
struct DrivenImage {
  int slot = traffic::kEgoSlot;
  traffic::CameraImage image;
};

/// A session in memory: what drove along which routes, and what it saw; samples are made of it.
struct DrivenSession {
  std::string name;  ///< scenario and seed
  std::unique_ptr<session::SessionSetup> setup;
  std::vector<traffic::TrafficSnapshot> decisions;          ///< at decision ticks, in order
  std::map<std::uint64_t, std::map<int, DriveKey>> drives;  ///< by tick, then slot
  std::map<DriveKey, map::Route> routes;
  std::set<std::pair<std::string, std::uint64_t>> disturbed;   ///< noise or fault: vehicle, tick
  std::map<std::string, std::vector<std::uint64_t>> contacts;  ///< ticks by vehicle
  std::vector<DrivenImage> images;                             ///< by tick, then slot
  double seconds = 0.0;                                        ///< simulated
};

// Training samples from a driven session: for every image of a driven vehicle what it then did, in
// its own frame (SI units; rows as in traffic/vehicle.h), and its route tokens.

/// By tick and slot. An image gives one if its vehicle was driven, without noise, contact or jump,
/// from the tick before it to the end of the horizon. Throws InputError for images of another size.
std::vector<learning::DrivingSample> samplesOf(const DrivenSession& session,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

}  // namespace cdiff::collection
