// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a suite consists of: its networks, and its routes in order.
#pragma once

#include <string>
#include <vector>

#include "suite/network_generator.h"

namespace cdiff::suite {

struct RouteWish {
  std::string manoeuvre;
  std::string density;
  std::string network;  ///< empty: any, in turn
};

std::vector<NetworkSpec> networkSpecs(const std::string& kind);
std::vector<RouteWish> routeWishes(const std::string& kind);

}  // namespace cdiff::suite
