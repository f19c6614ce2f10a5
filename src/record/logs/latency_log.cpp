// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/latency_log.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"

namespace cdiff::record {

SampleFigures figuresOf(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (const double value : values) {
    if (std::isfinite(value)) sorted.push_back(value);
  }
  std::sort(sorted.begin(), sorted.end());
  SampleFigures figures;
  figures.n = sorted.size();
  if (sorted.empty()) return figures;
  figures.mean =
      std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  figures.percentile_95 = nearestRank(sorted, 95.0);
  figures.maximum = sorted.back();
  return figures;
}

double nearestRank(const std::vector<double>& sorted, double percent) {
  const double count = static_cast<double>(sorted.size());
  const double rank = std::clamp(std::ceil(percent / 100.0 * count), 1.0, count);
  return sorted[static_cast<std::size_t>(rank) - 1];
}

void LatencyLog::observe(const std::vector<session::PlannerLatency>& latencies) {
  for (const session::PlannerLatency& latency : latencies) {
    samples_[latency.planner].push_back(latency.milliseconds);
  }
}

std::map<std::string, LatencyFigures> LatencyLog::figures() const {
  std::map<std::string, LatencyFigures> figures;
  for (const auto& [planner, samples] : samples_) {
    std::vector<double> sorted = samples;
    std::sort(sorted.begin(), sorted.end());
    figures[planner] = {nearestRank(sorted, 50.0), nearestRank(sorted, 95.0), sorted.back(),
                        sorted.size()};
  }
  return figures;
}

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
