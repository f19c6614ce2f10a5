// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "planners/pluto/pluto.h"

namespace cdiff::planners {

/// Options of `rift`: those of `pluto` with its own weights.
struct RiftOptions : PlutoOptions {
  RiftOptions() { weights = kRift.planner; }
};

}  // namespace cdiff::planners
