// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/map/road_network.h"

namespace cdiff::node_graph {

// Whether messages can be what a session's nodes publish: bytes that were overwritten in a bag can
// still be a message, and so can what a node of the user's sends.

/// Why a snapshot cannot be used (unknown status or role, two egos, two vehicles of one id, a
/// number that is not finite or out of all range, a time that is not its tick's); empty when it
/// can. `simulation_step` in [s].
std::string unusable(const ::e2e_cdiff::TrafficSnapshot& message, double simulation_step);

/// The same for a selection (a lane that the network does not have, a route without points).
std::string unusable(const ::e2e_cdiff::CbvSelection& message, const map::RoadNetwork& network);

/// Why a message of another slot than its topic's cannot be used.
std::string wrongSlot(int slot);

/// The same for its slots: more assignments than slots, a slot that does not exist or is assigned
/// twice, a vehicle that is assigned twice.
std::string unusable(const ::e2e_cdiff::CbvSelection& message, int max_cbv);

}  // namespace cdiff::node_graph
