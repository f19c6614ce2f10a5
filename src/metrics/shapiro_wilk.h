// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The Shapiro-Wilk test of normality (Royston 1995, algorithm AS R94): W = (sum a_i x_(i))^2 / sum
/// (x_i - mean)^2 and its p-value, both without unit. The paper's S-SW and A-SW are W.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cdiff::metrics {

struct ShapiroWilk {
  std::optional<double> w;  ///< 0 to 1, near 1 for a normal sample
  std::optional<double> p;  ///< probability of a W this small for a normal sample
  std::string reason;       ///< why there is no W; empty otherwise
};

/// Sample sizes that the algorithm was fitted for.
inline constexpr std::size_t kShapiroWilkLeast = 3;
inline constexpr std::size_t kShapiroWilkMost = 5000;

/// No W for n < 3, n > 5000, equal values, or a value that is not finite.
ShapiroWilk shapiroWilk(std::vector<double> samples);

}  // namespace cdiff::metrics
