// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory_resource>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sorted_samples.h"

namespace cdiff::metrics {

/// The Shapiro-Wilk test of normality (Royston 1995, algorithm AS R94): W = (sum a_i x_(i))^2 / sum
/// (x_i - mean)^2 and its p-value, both without unit. The paper's S-SW and A-SW are W.
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

/// Shapiro-Wilk W and p of a session's samples (any unit), thinned out evenly where there are more
/// than the test allows.
struct NormalityMeasures {
  Measure w;
  Measure p;
};

/// More than 5000 samples: every k-th in time order, k the smallest that leaves no more; `reason`
/// then says "1 in k of N samples taken" and n counts those taken. Absent with a reason for fewer
/// than three, for equal values, and with `reason_when_empty` for none.
NormalityMeasures normalityMeasures(const std::pmr::vector<double>& samples,
                                    const char* reason_when_empty);

/// Quantile of the standard normal distribution at a probability in (0, 1).
double normalQuantile(double probability);

// The 1-Wasserstein distance of an empirical sample to another or to a normal distribution, in the
// samples' unit: W1 = integral |F_a(x) - F_b(x)| dx.

/// Samples of any two sizes; nullopt when one is empty or holds a value that is not finite.
std::optional<double> wassersteinDistance(const SortedSamples& first, const SortedSamples& second);

/// Distance to the normal distribution, exact: between two order statistics F_a is a constant c,
/// and |c - Phi| has the antiderivative +-(c z - z Phi(z) - phi(z)), split where Phi(z) = c. A
/// deviation of 0 puts all mass at the mean. nullopt as above, and for parameters that are not
/// finite or a negative deviation.
std::optional<double> wassersteinDistanceToNormal(const SortedSamples& samples, double mean,
                                                  double standard_deviation);

}  // namespace cdiff::metrics
