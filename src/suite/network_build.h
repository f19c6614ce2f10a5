// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// SUMO networks from drawn sources, by netconvert with networks/netconvert.netccfg.
#pragma once

#include <filesystem>
#include <string>

#include "suite/road_plan.h"

namespace cdiff::suite {

/// Writes FOLDER/NAME.nod.xml, .edg.xml, .con.xml (where there are connections) and .net.xml;
/// answers the network's text, which is without netconvert's comment (date, version, paths): the
/// same sources and SUMO version give the same bytes. Throws InputError with netconvert's own words
/// when it fails.
std::string buildNetwork(const RoadPlan& plan, const std::filesystem::path& folder);

}  // namespace cdiff::suite
