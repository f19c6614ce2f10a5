// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>

#include "suite/draws.h"
#include "suite/road_plan.h"

namespace cdiff::suite {

// SUMO networks from drawn sources, by netconvert with networks/netconvert.netccfg.

/// Writes FOLDER/NAME.nod.xml, .edg.xml, .con.xml (where there are connections) and .net.xml;
/// answers the network's text, which is without netconvert's comment (date, version, paths): the
/// same sources and SUMO version give the same bytes. Throws InputError with netconvert's own words
/// when it fails.
std::string buildNetwork(const RoadPlan& plan, const std::filesystem::path& folder);

// Road networks drawn at random: crossings and T junctions, roundabouts, on-ramps, short
// districts; angles, lanes, limits, bends and elevation come from the draws (SI units, map frame).

/// What kind of junction or road a generated network consists of.
enum class NetworkKind { kCrossing, kRoundabout, kMerge, kDistrict };

/// What is given about a network; the draws decide the rest.
struct NetworkSpec {
  std::string name;
  NetworkKind kind = NetworkKind::kCrossing;
  int arms = 4;                      ///< arms of a crossing (3, 4) or a roundabout (3 to 5)
  int lanes = 1;                     ///< most lanes a direction (1 to 3; a roundabout 1 or 2)
  std::string control = "priority";  ///< priority, right_before_left or traffic_light
  bool elevation = false;            ///< whether roads climb or fall
};

RoadPlan drawNetwork(const NetworkSpec& spec, Draws& draws);

}  // namespace cdiff::suite
