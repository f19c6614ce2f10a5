// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

/// Wall time that a batch still takes [s], from the runs that have ended: a run's time is the mean
/// times an effect of each of its levels (scenario, planners, mode ...), which the ended runs
/// estimate and which is 1 for a level that none has yet. For `cdiff evaluate`, whose runs come
/// in a fair order (runOrder), so that a tenth of them shows most levels.
class RemainingTime {
 public:
  /// Of runs that are to be run, `jobs` at a time.
  RemainingTime(const std::vector<PlannedRun>& runs, int jobs);

  /// A run of this id took `seconds`; absent: its result was there already.
  void ended(const std::string& id, std::optional<double> seconds);
  /// `elapsed`: wall time since the batch began [s]. 0 before the first run has ended.
  double left(double elapsed) const;

 private:
  /// Of a factor, by its level.
  using Effects = std::map<std::string, std::map<std::string, double>>;
  double predicted(const Factors& factors, const Effects& effects) const;
  Effects fitted() const;

  std::map<std::string, Factors> waiting_;         ///< by id
  std::vector<std::pair<Factors, double>> times_;  ///< of runs that ended [s]
  double together_ = 0.0;                          ///< [s]
  double jobs_;
};

}  // namespace cdiff::evaluation
