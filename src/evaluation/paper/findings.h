// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/intervals/intervals.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

// Which findings of the paper a batch reproduces, by a rule that was written before any result. A
// finding is a difference that the paper prints: between its own system and another row of a table,
// or in Figure 4 between attack and naturalistic driving.

/// How a finding comes out. With d the paper's difference, D ours, and I the 95 % interval of D by
/// routes that both sides share:
enum class FindingOutcome {
  kReproduced,     ///< I excludes 0, D has the sign of d, and |D| is at least |d| / 2
  kNotReproduced,  ///< all of I lies short of d / 2, or beyond 0 on the other side
  kCannotBeTold,   ///< neither: too few routes, or an effect that is too small here
  kNotRun          ///< a side has no run, or the sides share fewer than two routes
};

/// "reproduced", "not reproduced", "cannot be told", "not run".
const char* toText(FindingOutcome outcome);

/// The rule. Without an interval (all routes equal) nothing can be told.
FindingOutcome outcomeOf(double paper_difference, double difference,
                         const std::optional<Interval>& interval);

/// A difference A - B of one figure.
struct Finding {
  std::string table;   ///< "table_1", "figure_4"
  std::string figure;  ///< name of the column, "2D-TTC"
  std::string unit;
  std::string a;  ///< names of the rows
  std::string b;
  double paper_difference = 0.0;
  std::optional<double> difference;
  std::optional<Interval> interval;
  std::size_t routes = 0;  ///< that both sides have
  FindingOutcome outcome = FindingOutcome::kNotRun;
};

/// The findings of Tables 1 to 6 and Figure 4, for the paper's own system by method paper. Figures
/// with a definition of RIFT's are taken by that one. Differences that the paper prints as 0 are
/// none.
std::vector<Finding> findingsOf(const std::vector<BatchRun>& runs);

/// The rule, a line for each finding, and how many came out how.
std::string findingsMarkdown(const std::vector<Finding>& findings);

}  // namespace cdiff::evaluation
