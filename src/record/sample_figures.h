// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Mean, 95th percentile (nearest rank) and maximum of a sample; values that are not finite are
/// left out.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace cdiff::record {

struct SampleFigures {
  std::optional<double> mean;  ///< absent when n = 0, and so on
  std::optional<double> percentile_95;
  std::optional<double> maximum;
  std::size_t n = 0;
};

SampleFigures figuresOf(const std::vector<double>& values);

}  // namespace cdiff::record
