// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {

/// A number about the CBV of a slot, on a topic of its own: tools that plot take it without knowing
/// our messages.
struct SlotFigure {
  Topic topic;
  double value;  ///< NaN where it is not defined
};

/// Of each slot with a CBV, in slot order: time to collision with the ego in the plane [s], NaN
/// where both would miss each other; gap between their boxes [m]; interaction score at selection.
/// None without an ego.
std::vector<SlotFigure> slotFigures(const traffic::TrafficSnapshot& snapshot,
                                    const cbv::CbvSelection& selection);

}  // namespace cdiff::node_graph
