// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Off-road rate (paper's ORR) [%]: 100 x ticks with the centre (or any corner) off the drivable
/// area / ticks.
#pragma once

#include "metrics/tick_share.h"

namespace cdiff::metrics {

using OffRoadRate = TickShare;

}  // namespace cdiff::metrics
