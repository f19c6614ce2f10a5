// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/remaining_time.h"

#include <algorithm>

namespace cdiff::evaluation {

RemainingTime::RemainingTime(const std::vector<PlannedRun>& runs, int jobs) : jobs_(jobs) {
  for (const PlannedRun& run : runs) {
    Factors factors = run.factors;
    factors.erase("seed");
    factors.erase("repetition");
    waiting_.emplace(run.id, std::move(factors));
  }
}

void RemainingTime::ended(const std::string& id, std::optional<double> seconds) {
  const auto run = waiting_.find(id);
  if (run == waiting_.end()) return;
  if (seconds) {
    times_.emplace_back(run->second, *seconds);
    together_ += *seconds;
  }
  waiting_.erase(run);
}

double RemainingTime::predicted(const Factors& factors, const Effects& effects) const {
  double seconds = together_ / static_cast<double>(times_.size());
  for (const auto& [factor, level] : factors) {
    const auto of_factor = effects.find(factor);
    if (of_factor == effects.end()) continue;
    const auto effect = of_factor->second.find(level);
    if (effect != of_factor->second.end()) seconds *= effect->second;
  }
  return seconds;
}

/// Each effect in turn becomes the ratio of observed to predicted times of its level, with one run
/// as predicted added to both, so that few runs change it little.
RemainingTime::Effects RemainingTime::fitted() const {
  constexpr int kSweeps = 5;
  const double mean = together_ / static_cast<double>(times_.size());
  Effects effects;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [factor, any] : times_.front().first) {
      effects.erase(factor);
      std::map<std::string, std::pair<double, double>> sums;  // observed and predicted
      for (const auto& [factors, seconds] : times_) {
        auto& [observed, expected] = sums[factors.at(factor)];
        observed += seconds;
        expected += predicted(factors, effects);
      }
      for (const auto& [level, sum] : sums)
        effects[factor][level] = (sum.first + mean) / (sum.second + mean);
    }
  }
  return effects;
}

double RemainingTime::left(double elapsed) const {
  if (times_.empty() || !(together_ > 0.0) || waiting_.empty()) return 0.0;
  const Effects effects = fitted();
  double work = 0.0;
  for (const auto& [id, factors] : waiting_) work += predicted(factors, effects);
  const double at_a_time = std::min(jobs_, static_cast<double>(waiting_.size()));
  const double mean = work / static_cast<double>(waiting_.size());
  // What the runs under way have behind them: all processes' time less that of the ended runs.
  const double begun = std::clamp(jobs_ * elapsed - together_, 0.0, 0.5 * (jobs_ - 1.0) * mean);
  return std::max(0.0, work - begun) / at_a_time;
}

}  // namespace cdiff::evaluation
