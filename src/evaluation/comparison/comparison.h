// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/comparison/comparison_differences.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/run_conditions.h"

namespace cdiff::evaluation {

/// One measure over its pairs: both sides, their difference and whether it can be chance.
struct MeasureComparison {
  std::string measure;
  std::size_t pairs = 0;  ///< with the measure on both sides
  PooledEstimate a;       ///< over the runs of these pairs
  PooledEstimate b;
  std::optional<double> difference;  ///< B - A
  std::optional<Interval> interval;  ///< of the difference; routes are drawn for both at once
  IntervalKind interval_kind = IntervalKind::kNone;
  std::optional<RateComparison> rates;  ///< of counts: exact conditional test and ratio B / A
  double p_exchange = 1.0;              ///< A and B exchanged by routes
  double p = 1.0;  ///< p_exchange; of counts the exact test's, or the larger where over-dispersed
  double p_holm = 1.0;  ///< p adjusted for the number of differences of its family
  /// The family that p_holm corrects for: headline measures (headlineMeasures) among themselves,
  /// all others among themselves. False where measures were named: these are one family.
  bool headline = false;
};

/// Factors that change together with the one compared, each with its levels in A and in B.
using Followers = std::map<std::string, std::pair<std::string, std::string>>;

/// Two sets of runs side by side: runs are paired by the factors that the sets share, and each
/// measure is compared over the pairs, with routes as what is drawn (docs/statistics.md).
struct Comparison {
  std::string a;  ///< names for people
  std::string b;
  std::set<std::string> paired_by;  ///< factors
  Followers followers;              ///< factors that neither pair nor are compared
  Differences differences;          ///< of the pairs' runs
  std::size_t pairs = 0;            ///< whose runs are both complete
  std::size_t runs_a = 0;           ///< all of them
  std::size_t runs_b = 0;
  std::string cluster = "scenario";  ///< factor whose levels are drawn
  std::size_t clusters = 0;          ///< of the pairs
  std::size_t seeds = 0;
  std::string conditions;                   ///< protocols and suite, for people
  std::vector<MeasureComparison> measures;  ///< those with at least one pair
};

/// Scenario, seed, repetition, and every other factor of which both sets have a level in common.
std::set<std::string> sharedFactors(const RunSet& a, const RunSet& b);

/// Factors, other than scenario, seed and repetition, of which A and B have no level in common and
/// that the other factors determine in each: they follow `factor`, as the guidance profile follows
/// mode and method where nothing else sets it.
Followers followingFactors(const RunSet& a, const RunSet& b, const std::string& factor);

/// Measures of `names`; all when empty, the headline measures first and marked. Runs of one side
/// that agree in all of `paired_by` count as one by their mean. Throws InputError as
/// requireComparable does.
Comparison compareRuns(const RunSet& a, const RunSet& b, const std::set<std::string>& paired_by,
                       const std::vector<std::string>& names);

/// Each level of a factor against its baseline level, paired over all other factors but those that
/// follow it. Throws InputError for an unknown factor or a baseline that no run has, naming the
/// nearest, and as requireComparable does.
std::vector<Comparison> compareLevels(const RunSet& runs, const std::string& factor,
                                      const std::string& baseline,
                                      const std::vector<std::string>& names);

/// Fills in p_holm over all measures of a family in all of them.
void adjustForNumber(std::vector<Comparison>& comparisons);

/// How many differences of one family the comparisons report, and how many are significant.
struct Multiplicity {
  std::size_t differences = 0;
  std::size_t apart = 0;                   ///< p <= 0.05
  std::vector<std::string> apart_by_holm;  ///< measures with p_holm <= 0.05
};
Multiplicity multiplicityOf(const std::vector<Comparison>& comparisons, bool headline);

/// Throws InputError naming the nearest measure for a name that is none.
void checkMeasureNames(const std::vector<std::string>& names);

}  // namespace cdiff::evaluation
