// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// Mean, standard deviation (n - 1) and 95 % interval of the mean: of independent samples mean +-
/// t_{0.975, n-1} s / sqrt(n).
struct Statistics {
  std::size_t n = 0;
  std::optional<double> mean;                ///< absent without samples
  std::optional<double> standard_deviation;  ///< absent below two samples
  std::optional<Interval> interval;          ///< absent below two samples
};

Statistics statisticsOf(const std::vector<double>& samples);

/// The runs of a batch that differ in seed and repetition alone, and their measures over seeds.
struct Cell {
  Factors factors;  ///< without seed and repetition
  std::size_t runs = 0;
  std::size_t failed = 0;   ///< broke
  std::size_t missing = 0;  ///< not run or interrupted
  /// By measure. Repetitions of a seed are averaged first: n counts the seeds that have the
  /// measure. The mean of a share is that of all samples together. Intervals are exact Poisson of
  /// counts and rates (per km), by the bootstrap over seeds of bounded measures, Student's over
  /// seeds of all others.
  std::map<std::string, Statistics> measures;
};

/// In the order in which they first appear.
std::vector<Cell> cellsOf(const std::vector<RunRecord>& records);

/// The runs of a batch that differ in scenario, seed and repetition alone, and their measures over
/// routes.
struct System {
  Factors factors;  ///< without scenario, seed and repetition
  std::size_t runs = 0;
  std::size_t failed = 0;                          ///< broke
  std::size_t missing = 0;                         ///< not run or interrupted
  std::size_t routes = 0;                          ///< of complete runs
  std::size_t seeds = 0;                           ///< of complete runs
  std::map<std::string, PooledEstimate> measures;  ///< those that a complete run has
};

/// In the order in which they first appear.
std::vector<System> systemsOf(const std::vector<RunRecord>& records);

}  // namespace cdiff::evaluation
