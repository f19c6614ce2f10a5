// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

namespace cdiff::metrics {

// The 1-Wasserstein distance of an empirical sample to another or to a normal distribution, in the
// samples' unit: W1 = integral |F_a(x) - F_b(x)| dx.

/// Samples of any two sizes; nullopt when one is empty or holds a value that is not finite.
std::optional<double> wassersteinDistance(std::vector<double> first, std::vector<double> second);

/// Distance to the normal distribution, exact: between two order statistics F_a is a constant c,
/// and |c - Phi| has the antiderivative +-(c z - z Phi(z) - phi(z)), split where Phi(z) = c. A
/// deviation of 0 puts all mass at the mean. nullopt as above, and for parameters that are not
/// finite or a negative deviation.
std::optional<double> wassersteinDistanceToNormal(std::vector<double> samples, double mean,
                                                  double standard_deviation);

}  // namespace cdiff::metrics
