// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/late_log.h"

#include <algorithm>

#include "core/text.h"
#include "record/latency_log.h"

namespace cdiff::record {

using session::AnswerTiming;

void LateLog::observe(const std::vector<AnswerTiming>& timings) {
  for (const AnswerTiming& timing : timings) {
    LateFigures& figures = counts_[timing.planner];
    ++figures.asked;
    if (timing.punctual()) continue;
    ++(timing.came ? figures.late : figures.missing);
    if (timing.came) lateness_[timing.planner].push_back(timing.lateness);
    figures.by_plan += timing.instead == AnswerTiming::Instead::kPlan;
    figures.by_full_brake += timing.instead == AnswerTiming::Instead::kFullBrake;
    figures.not_driven += timing.instead == AnswerTiming::Instead::kNotDriven;
  }
}

std::map<std::string, LateFigures> LateLog::figures() const {
  std::map<std::string, LateFigures> all = counts_;
  for (const auto& [planner, samples] : lateness_) {
    std::vector<double> sorted = samples;
    std::sort(sorted.begin(), sorted.end());
    LateFigures& figures = all[planner];
    figures.median = nearestRank(sorted, 50.0);
    figures.percentile_95 = nearestRank(sorted, 95.0);
    figures.maximum = sorted.back();
  }
  return all;
}

std::size_t lateAnswers(const std::map<std::string, LateFigures>& figures) {
  std::size_t count = 0;
  for (const auto& [planner, one] : figures) count += one.late + one.missing;
  return count;
}

std::string latenessText(const std::map<std::string, LateFigures>& figures) {
  const std::size_t late = lateAnswers(figures);
  if (late == 0) return "";
  std::size_t asked = 0;
  std::size_t by_plan = 0;
  std::size_t by_full_brake = 0;
  for (const auto& [planner, one] : figures) {
    asked += one.asked;
    by_plan += one.by_plan;
    by_full_brake += one.by_full_brake;
  }
  return std::to_string(late) + " of " + std::to_string(asked) + " (" +
         core::formatFixed(100.0 * static_cast<double>(late) / static_cast<double>(asked), 1) +
         " %); instead drove the last plan's next action " + std::to_string(by_plan) +
         " times, full braking " + std::to_string(by_full_brake) + " times";
}

}  // namespace cdiff::record
