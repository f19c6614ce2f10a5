// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/planner_logs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"
#include "metrics/formulas/quantiles.h"

namespace cdiff::record {
namespace {

double nearestRank(const std::vector<double>& sorted, double share) {
  return metrics::quantileOf(sorted, share, metrics::QuantileRule::kNearestRank);
}

}  // namespace

SampleSummary summaryOf(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (const double value : values) {
    if (std::isfinite(value)) sorted.push_back(value);
  }
  std::sort(sorted.begin(), sorted.end());
  SampleSummary summary;
  summary.n = sorted.size();
  if (sorted.empty()) return summary;
  summary.mean =
      std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  summary.percentile_95 = nearestRank(sorted, 0.95);
  summary.maximum = sorted.back();
  return summary;
}

void LatencyLog::observe(const std::vector<session::PlannerLatency>& latencies) {
  for (const session::PlannerLatency& latency : latencies) {
    samples_[latency.planner].push_back(latency.milliseconds);
  }
}

std::map<std::string, LatencySummary> LatencyLog::summaries() const {
  std::map<std::string, LatencySummary> summaries;
  for (const auto& [planner, samples] : samples_) {
    std::vector<double> sorted(samples.begin(), samples.end());
    std::sort(sorted.begin(), sorted.end());
    summaries[planner] = {nearestRank(sorted, 0.5), nearestRank(sorted, 0.95), sorted.back(),
                          sorted.size()};
  }
  return summaries;
}

using session::AnswerTiming;

void LateLog::observe(const std::vector<AnswerTiming>& timings) {
  for (const AnswerTiming& timing : timings) {
    LateCounts& counts = counts_[timing.planner];
    ++counts.asked;
    if (timing.punctual()) continue;
    ++(timing.came ? counts.late : counts.missing);
    if (timing.came) lateness_[timing.planner].push_back(timing.lateness);
    counts.by_plan += timing.instead == AnswerTiming::Instead::kPlan;
    counts.by_full_brake += timing.instead == AnswerTiming::Instead::kFullBrake;
    counts.not_driven += timing.instead == AnswerTiming::Instead::kNotDriven;
  }
}

std::map<std::string, LateCounts> LateLog::counts() const {
  std::map<std::string, LateCounts> all = counts_;
  for (const auto& [planner, samples] : lateness_) {
    std::vector<double> sorted(samples.begin(), samples.end());
    std::sort(sorted.begin(), sorted.end());
    LateCounts& counts = all[planner];
    counts.median = nearestRank(sorted, 0.5);
    counts.percentile_95 = nearestRank(sorted, 0.95);
    counts.maximum = sorted.back();
  }
  return all;
}

std::size_t lateAnswers(const std::map<std::string, LateCounts>& counts) {
  std::size_t count = 0;
  for (const auto& [planner, one] : counts) count += one.late + one.missing;
  return count;
}

std::string latenessText(const std::map<std::string, LateCounts>& counts) {
  const std::size_t late = lateAnswers(counts);
  if (late == 0) return "";
  std::size_t asked = 0;
  std::size_t by_plan = 0;
  std::size_t by_full_brake = 0;
  for (const auto& [planner, one] : counts) {
    asked += one.asked;
    by_plan += one.by_plan;
    by_full_brake += one.by_full_brake;
  }
  return std::to_string(late) + " of " + std::to_string(asked) + " (" +
         core::formatFixed(100.0 * static_cast<double>(late) / static_cast<double>(asked), 1) +
         " %); instead drove the last plan's next action " + std::to_string(by_plan) +
         " times, full braking " + std::to_string(by_full_brake) + " times";
}

void GuidanceLog::observeChallenge(const planning::PlannedAction& action) {
  const guidance::ChallengeReport& report = action.guidance.challenge;
  if (report.state.empty()) return;
  ++challenge_.decisions;
  std::string& last = last_state_[action.vehicle_id];
  if (report.state == "attacks") {
    ++challenge_.attacking;
    if (last != "attacks") ++challenge_.attacks;
  }
  if (report.state == "withdrawn")
    ++challenge_.withdrawn[report.reason.empty() ? "braking is safer" : report.reason];
  for (const std::string& refusal : report.refusals) {
    if (!refusal.empty()) ++challenge_.refused[refusal];
  }
  last = report.state;
}

void GuidanceLog::observe(const session::TickRecord& record) {
  if (record.actions == nullptr) return;
  for (const planning::PlannedAction& action : *record.actions) {
    if (action.slot < 0 || action.guidance.objectives.empty()) continue;
    observeChallenge(action);
    trust_region_shares_.push_back(action.guidance.trust_region_share);
    for (const guidance::ObjectiveReport& report : action.guidance.objectives) {
      seriesOf(report.name)
          .samples.push_back({record.snapshot->time, action.vehicle_id, report.weight, report.value,
                              report.gradient_norm, report.capped_share, report.dropped});
    }
  }
}

GuidanceSeries& GuidanceLog::seriesOf(const std::string& objective) {
  const auto known =
      std::find_if(series_.begin(), series_.end(),
                   [&](const GuidanceSeries& series) { return series.objective == objective; });
  if (known != series_.end()) return *known;
  const std::pmr::polymorphic_allocator<GuidanceSample> memory =
      trust_region_shares_.get_allocator().resource();
  series_.push_back({objective, std::pmr::vector<GuidanceSample>(memory)});
  return series_.back();
}

ObjectiveSummary summaryOf(const GuidanceSeries& series) {
  const auto mean = [&](double GuidanceSample::*quantity) {
    std::vector<double> values;
    for (const GuidanceSample& sample : series.samples) values.push_back(sample.*quantity);
    return summaryOf(values).mean;
  };
  ObjectiveSummary summary;
  if (!series.samples.empty()) summary.weight = series.samples.back().weight;
  summary.value = mean(&GuidanceSample::value);
  summary.gradient_norm = mean(&GuidanceSample::gradient_norm);
  summary.capped_share = mean(&GuidanceSample::capped_share);
  for (const GuidanceSample& sample : series.samples) summary.dropped += sample.dropped;
  summary.n = series.samples.size();
  return summary;
}

}  // namespace cdiff::record
