// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "suite/network_generator.h"
#include "suite/route_suggester.h"

namespace cdiff::suite {

/// A scenario file to be written.
struct NewScenario {
  std::string name;
  std::string network;  ///< as the file names it
  std::int64_t seed = 1;
  SuggestedRoute route;
  std::vector<SuggestedRoute> others;  ///< in a comment
};

/// Its text: route, traffic, protocol and rules, each with a comment; it runs as it is.
std::string newScenarioText(const NewScenario& scenario);

/// A network that needs no file of the user's: "grid" (four by four crossings, 120 m apart),
/// "crossing" or "roundabout" (of four arms, drawn from `seed`). Text of the SUMO network; the same
/// seed gives the same bytes. Throws InputError as buildNetwork does.
std::string generatedNetwork(const std::string& kind, std::int64_t seed);

}  // namespace cdiff::suite
