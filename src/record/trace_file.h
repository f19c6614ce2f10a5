// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Reads trace.csv back (map frame, SI units).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::record {

/// One vehicle at one tick.
struct TraceRow {
  std::uint64_t tick = 0;
  std::string id;
  traffic::VehicleRole role = traffic::VehicleRole::kBackground;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< centre of the box [m]
  double heading = 0.0;                                ///< [rad]
  double speed = 0.0;                                  ///< [m/s]
};

/// All rows in the file's order: by tick, the ego first, then CBVs. Throws InputError naming file
/// and line for anything that is no trace.
std::vector<TraceRow> readTrace(const std::filesystem::path& file);

}  // namespace cdiff::record
