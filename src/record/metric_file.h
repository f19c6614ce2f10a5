// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

namespace cdiff::record {

// One metric for every case of a file (SI units): ttc_2d of a CSV of box pairs, shapiro_wilk and
// wasserstein of a JSON of samples.

/// One line per case in the file's order; numbers in the shortest form that reads back to the same.
/// ttc_2d: "1: 2.35" or "1: inf" [s]. CSV with a header and the columns x_i y_i vx_i vy_i hx_i hy_i
/// length_i width_i and the same with _j, (hx, hy) along the heading; others are passed over.
/// shapiro_wilk: "1 (normal, n = 4): W = 0.81, p = 0.13" or "1 (n = 2): none, <reason>".
/// JSON {"cases": [{"x": [...], "kind": "..."}]}, kind optional.
/// wasserstein: "1 (n = 5, 7): 0.4" or "1 (n = 0, 7): none, a sample is empty".
/// JSON {"cases": [{"a": [...], "b": [...]}]}.
/// Throws InputError naming the file, the line or case, and what was expected.
std::vector<std::string> evaluateMetricFile(const std::string& metric, const std::string& file);

}  // namespace cdiff::record
