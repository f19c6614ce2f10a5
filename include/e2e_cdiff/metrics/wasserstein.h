// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The 1-Wasserstein distance of two empirical samples, in the samples' unit: W1 = integral |F_a(x)
/// - F_b(x)| dx.
#pragma once

#include <optional>
#include <vector>

namespace cdiff::metrics {

/// Samples of any two sizes; nullopt when one is empty or holds a value that is not finite.
std::optional<double> wassersteinDistance(std::vector<double> first, std::vector<double> second);

}  // namespace cdiff::metrics
