// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The runs of a batch that differ in seed and repetition alone, and their figures over seeds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "evaluation/run_record.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {

struct Cell {
  Factors factors;  ///< without seed and repetition
  std::size_t runs = 0;
  std::size_t failed = 0;   ///< broke
  std::size_t missing = 0;  ///< not run or interrupted
  /// By figure. Repetitions of a seed are averaged first: n counts the seeds that have the figure.
  std::map<std::string, Statistics> figures;
};

/// In the order in which they first appear.
std::vector<Cell> cellsOf(const std::vector<RunRecord>& records);

}  // namespace cdiff::evaluation
