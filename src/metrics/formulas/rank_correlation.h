// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

namespace cdiff::metrics {

/// Spearman's rank correlation of pairs, -1 to 1; equal values share their mean rank. nullopt for
/// fewer than three pairs (two always agree or disagree wholly) and where all values of one side
/// are equal. Throws std::invalid_argument for sides of different lengths.
std::optional<double> rankCorrelation(const std::vector<double>& first,
                                      const std::vector<double>& second);

}  // namespace cdiff::metrics
