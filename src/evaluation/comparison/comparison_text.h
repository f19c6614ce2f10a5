// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/comparison/comparison.h"

namespace cdiff::evaluation {

// Comparisons as texts: a table for people and rows for programs.

/// The headline measures; with `all`, and where there are none, all others.
std::string comparisonMarkdown(const std::vector<Comparison>& comparisons, bool all = false);
/// All of them.
std::string comparisonCsv(const std::vector<Comparison>& comparisons);

}  // namespace cdiff::evaluation
