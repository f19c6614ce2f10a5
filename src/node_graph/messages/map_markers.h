// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "session/session_setup.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

/// What of a session never changes, in `map`: asphalt and pavements, lane markings, the ego's route
/// and its goal; starts with DELETEALL. Stays until the session ends.
visualization_msgs::MarkerArray mapMarkers(const session::SessionSetup& setup);

}  // namespace cdiff::node_graph
