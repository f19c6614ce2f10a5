// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>

#include "e2e_cdiff/map/route.h"

namespace cdiff::page {

/// A road network from above as a whole SVG file, for people who look for the names of its edges:
/// lanes for cars in their widths, each edge's id along its lanes and in a tool tip with length,
/// lanes and limit, and `route`, where there is one, with its start and goal. North is up; at least
/// 3 pixels a meter, so that names can be read and searched for in a browser.
std::string edgeMapSvg(const map::RoadNetwork& network, const std::optional<map::Route>& route);

}  // namespace cdiff::page
