// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Ticks of messages that carry a stamp alone.
#pragma once

#include <cstdint>

#include "ros/time.h"

namespace cdiff::ros {

/// Tick whose stamp is nearest; `simulation_step` in [s].
std::uint64_t nearestTick(const ::ros::Time& stamp, double simulation_step);

}  // namespace cdiff::ros
