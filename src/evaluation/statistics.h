// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Mean, standard deviation (n - 1) and half width of the 95 % interval of the mean: t_{0.975, n-1}
/// s / sqrt(n).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace cdiff::evaluation {

struct Statistics {
  std::size_t n = 0;
  std::optional<double> mean;                ///< absent without samples
  std::optional<double> standard_deviation;  ///< absent below two samples
  std::optional<double> half_width;          ///< absent below two samples
};

Statistics statisticsOf(const std::vector<double>& samples);

}  // namespace cdiff::evaluation
