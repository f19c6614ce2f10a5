// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Whether recorded messages can be what a session published: bytes that were overwritten in a bag
/// can still be a message.
#pragma once

#include <string>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/map/road_network.h"

namespace cdiff::ros {

/// Why a snapshot cannot be used (unknown status or role, two egos, two vehicles of one id, a
/// number that is not finite or out of all range, a time that is not its tick's); empty when it
/// can. `simulation_step` in [s].
std::string unusable(const ::e2e_cdiff::TrafficSnapshot& message, double simulation_step);

/// The same for a selection (a lane that the network does not have, a route without points).
std::string unusable(const ::e2e_cdiff::CbvSelection& message, const map::RoadNetwork& network);

}  // namespace cdiff::ros
