// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>

#include "collection/collection_options.h"
#include "planners/pdm_lite/pdm_lite_options.h"

namespace cdiff::collection {

/// Who drives a vehicle in data collection: its target speed [m/s] and its style.
struct Driver {
  double target_speed;
  planners::DrivingStyle style;
};
/// Drawn by vehicle id and the session's seed.
Driver driverOf(const CollectionOptions& options, std::uint64_t seed,
                const std::string& vehicle_id);

}  // namespace cdiff::collection
