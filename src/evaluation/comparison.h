// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/run_record.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {

/// One measure over its pairs.
struct MeasureComparison {
  std::string measure;
  double mean_a = 0.0;
  double mean_b = 0.0;
  Statistics difference;  ///< statistics of B - A; n is the number of pairs
};

/// Factors that change together with the one compared, each with its level in A and in B.
using Followers = std::map<std::string, std::pair<std::string, std::string>>;

/// Two sets of runs side by side: runs are paired by the factors that the sets share, and each
/// measure is compared over the pairs (paired t).
struct Comparison {
  std::string a;  ///< names for people
  std::string b;
  std::set<std::string> paired_by;  ///< factors
  Followers followers;              ///< factors that neither pair nor are compared
  std::size_t pairs = 0;            ///< whose runs are both complete
  std::size_t runs_a = 0;           ///< all of them
  std::size_t runs_b = 0;
  std::vector<MeasureComparison> measures;  ///< those with at least one pair
};

/// A set of runs and its name.
struct RunSet {
  std::string name;
  std::vector<RunRecord> records;
};

/// Scenario, seed, repetition, and every other factor of which both sets have a level in common.
std::set<std::string> sharedFactors(const RunSet& a, const RunSet& b);

/// Factors, other than scenario, seed and repetition, that have one level in A and another in B:
/// they follow `factor`, as the guidance profile follows the mode where nothing else sets it.
Followers followingFactors(const RunSet& a, const RunSet& b, const std::string& factor);

/// Measures of `names`, or all when empty. Runs of one side that agree in all of `paired_by` count
/// as one by their mean.
Comparison compareRuns(const RunSet& a, const RunSet& b, const std::set<std::string>& paired_by,
                       const std::vector<std::string>& names);

/// Each level of a factor against its baseline level, paired over all other factors but those that
/// follow it. Throws InputError for an unknown factor or a baseline that no run has, naming the
/// nearest.
std::vector<Comparison> compareLevels(const std::vector<RunRecord>& records,
                                      const std::string& factor, const std::string& baseline,
                                      const std::vector<std::string>& names);

/// Throws InputError naming the nearest measure for a name that is none.
void checkMeasureNames(const std::vector<std::string>& names);

std::string comparisonMarkdown(const std::vector<Comparison>& comparisons);
std::string comparisonCsv(const std::vector<Comparison>& comparisons);

}  // namespace cdiff::evaluation
