// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "suite/network_generator.h"
#include "suite/suite.h"

namespace cdiff::suite {

// Whole suites from a seed: 220 training routes on 38 networks, 10 development routes on 7 others.
// The draws of the two come from streams of their own, so no network of one is in the other.

/// What a route of the suite is to have: maneuver, density of traffic, and network.
struct RouteWish {
  std::string manoeuvre;
  std::string density;
  std::string network;  ///< empty: any, in turn
};

std::vector<NetworkSpec> networkSpecs(const std::string& kind);
std::vector<RouteWish> routeWishes(const std::string& kind);

/// "development", "train".
const std::vector<std::string>& suiteKinds();

/// Routes of each maneuver in a suite of this kind.
std::map<std::string, int> routeCounts(const std::string& kind);

/// Seed of a suite when none is asked for; that of the shipped development suite.
std::int64_t defaultSeed(const std::string& kind);

/// Writes the suite; same kind, seed and SUMO version: same bytes. The folder appears when all of
/// it is there. Throws InputError for a folder that is not empty, a network that netconvert
/// refuses, or fewer usable routes than the suite needs.
Suite generateSuite(const std::string& kind, std::int64_t seed,
                    const std::filesystem::path& folder);

}  // namespace cdiff::suite
