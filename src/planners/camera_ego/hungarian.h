// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

namespace cdiff::planners {

/// The cheapest matching of rows to columns (Kuhn 1955, in the form of shortest augmenting paths,
/// Jonker and Volgenant 1987): `cost` [rows, columns] row-major, no more rows than columns. The
/// column of each row; every column is taken at most once. Deterministic: of equal costs the lowest
/// column is tried first. Throws std::invalid_argument where there are more rows than columns.
std::vector<int> hungarian(const std::vector<double>& cost, std::size_t rows, std::size_t columns);

}  // namespace cdiff::planners
