// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/planning/perception.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {

msgs::Perception toMsg(const planning::Perception& perception);
/// Without occupancy whose cells are not rows x columns.
planning::Perception fromMsg(const msgs::Perception& message);

}  // namespace cdiff::node_graph
