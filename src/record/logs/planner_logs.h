// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory_resource>
#include <optional>
#include <string>
#include <vector>

#include "session/session_observer.h"

namespace cdiff::record {

/// Mean, 95th percentile (nearest rank) and maximum of a sample; values that are not finite are
/// left out.
struct SampleSummary {
  std::optional<double> mean;  ///< absent when n = 0, as are the other two
  std::optional<double> percentile_95;
  std::optional<double> maximum;
  std::size_t n = 0;
};

SampleSummary summaryOf(const std::vector<double>& values);

/// Latencies [ms] of a planner over its decisions; percentiles by nearest rank.
struct LatencySummary {
  double median = 0.0;         ///< [ms]
  double percentile_95 = 0.0;  ///< [ms]
  double maximum = 0.0;        ///< [ms]
  std::size_t n = 0;           ///< decisions
};

/// Collects the wall time that each planner took per decision [ms].
class LatencyLog {
 public:
  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit LatencyLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : samples_(memory) {}
  void observe(const std::vector<session::PlannerLatency>& latencies);
  /// By planner name.
  std::map<std::string, LatencySummary> summaries() const;

 private:
  std::pmr::map<std::string, std::pmr::vector<double>> samples_;
};

/// How often one planner's answers were late in a paced session, how late, and what drove instead.
struct LateCounts {
  std::size_t asked = 0;          ///< answers that were due
  std::size_t late = 0;           ///< answers that came after their tick
  std::size_t missing = 0;        ///< answers that never came
  std::size_t by_plan = 0;        ///< late or missing: the last plan's next action drove instead
  std::size_t by_full_brake = 0;  ///< late or missing: full braking instead
  std::size_t not_driven = 0;     ///< late or missing: the vehicle was not taken over yet
  double median = 0.0;            ///< lateness of those that came late, wall time [s]
  double percentile_95 = 0.0;     ///< [s]
  double maximum = 0.0;           ///< [s]
};

/// Collects late answers by planner, in sessions that do not wait for them (real_time_factor > 0).
class LateLog {
 public:
  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit LateLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : lateness_(memory) {}
  void observe(const std::vector<session::AnswerTiming>& timings);
  /// By planner ("cbv_identification" for the selection); empty for sessions that wait for every
  /// answer.
  std::map<std::string, LateCounts> counts() const;

 private:
  std::map<std::string, LateCounts> counts_;
  std::pmr::map<std::string, std::pmr::vector<double>> lateness_;  ///< [s]
};

/// Answers of all planners that came late or never.
std::size_t lateAnswers(const std::map<std::string, LateCounts>& counts);
/// "342 of 802 answers came late or never and were replaced; ..." ; empty when none did.
std::string latenessText(const std::map<std::string, LateCounts>& counts);

/// One objective at one decision of one vehicle.
struct GuidanceSample {
  double time = 0.0;  ///< [s]
  std::string vehicle_id;
  // As in guidance::ObjectiveReport.
  double weight = 0.0;
  double value = 0.0;
  double gradient_norm = 0.0;
  double capped_share = 0.0;
  std::int64_t dropped = 0;
};

/// One objective over the session.
struct GuidanceSeries {
  std::string objective;
  std::pmr::vector<GuidanceSample> samples;
};

/// One objective summed up over the decisions at which it was active. Units of value and gradient
/// are the objective's own.
struct ObjectiveSummary {
  std::optional<double> weight;  ///< weight at the last decision
  // Means; values that are not finite are left out.
  std::optional<double> value;
  std::optional<double> gradient_norm;
  std::optional<double> capped_share;
  std::int64_t dropped = 0;  ///< denoising steps that left it out, over all decisions
  std::size_t n = 0;         ///< decisions
};

/// What mode challenging came to over a session.
struct ChallengeCounts {
  std::size_t decisions = 0;                     ///< of CBVs
  std::size_t attacking = 0;                     ///< decisions with a promise
  std::size_t attacks = 0;                       ///< promises
  std::map<std::string, std::size_t> withdrawn;  ///< decisions, by reason
  std::map<std::string, std::size_t> refused;    ///< plans, by reason
};

/// What guidance did to the plans of CBVs: every objective's report at every decision.
class GuidanceLog {
 public:
  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit GuidanceLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : trust_region_shares_(memory) {}
  void observe(const session::TickRecord& record);
  /// In the order in which objectives appeared first.
  const std::vector<GuidanceSeries>& series() const { return series_; }
  /// Without a decision unless the mode is challenging.
  const ChallengeCounts& challenge() const { return challenge_; }
  /// Share of guided steps in which the trust region acted, over decisions with guidance.
  SampleSummary trustRegion() const {
    return summaryOf({trust_region_shares_.begin(), trust_region_shares_.end()});
  }

 private:
  GuidanceSeries& seriesOf(const std::string& objective);
  std::vector<GuidanceSeries> series_;
  void observeChallenge(const planning::PlannedAction& action);
  std::pmr::vector<double> trust_region_shares_;
  ChallengeCounts challenge_;
  std::map<std::string, std::string> last_state_;  ///< by vehicle
};

ObjectiveSummary summaryOf(const GuidanceSeries& series);

}  // namespace cdiff::record
