// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The ego against the vehicles around it at one tick: smallest times to collision [s] and distance
/// between boxes [m].
#pragma once

#include "e2e_cdiff/metrics/metric_tick.h"

namespace cdiff::metrics {

struct InteractionOptions {
  double radius = 60.0;        ///< of centres, for times to collision [m]
  double time_limit = 3600.0;  ///< a longer time counts as never [s]
  bool variants = false;       ///< whether ttc_lon_lat, rift_ttc and rift_act are computed
};

/// `ego` is one of the snapshot's vehicles. Vehicles with a value that is not finite are passed
/// over.
Interaction interactionOf(const traffic::Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
                          const InteractionOptions& options);

}  // namespace cdiff::metrics
