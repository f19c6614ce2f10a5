// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "map/border_index.h"

namespace cdiff::map {

/// Fewest strips and polygons whose union is kept in the cache folder: that of fewer takes less
/// than a few milliseconds.
inline constexpr std::size_t kLeastKeptOutlines = 500;

/// As uniteOutlines, whose result is kept in the cache folder for later processes. Without a cache
/// that can be written, every process unites anew.
std::vector<Ring> keptUnion(const std::vector<Strip>& strips, const std::vector<Ring>& polygons);

}  // namespace cdiff::map
