// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory_resource>
#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::record {

/// The size of a vehicle's box [m], by its id.
using SizesById = std::unordered_map<std::string, traffic::VehicleDimensions>;

/// Sizes [m] of all vehicles of a session, which trace.csv does not hold.
class SizeLog {
 public:
  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit SizeLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : sizes_(memory), ids_(memory) {}
  /// Every tick. A vehicle keeps the size that it had first.
  void observe(const traffic::TrafficSnapshot& snapshot);
  /// Text of vehicles.csv: a row per vehicle in the order of appearance, sizes in meters.
  std::string csv() const;

 private:
  std::pmr::unordered_map<std::string, traffic::VehicleDimensions> sizes_;
  std::pmr::vector<std::string> ids_;  ///< in the order of appearance
};

/// Reads vehicles.csv back. Throws InputError naming file and line for anything else.
SizesById readSizes(const std::filesystem::path& file);

}  // namespace cdiff::record
