// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "record/logs/latency_log.h"
#include "session/session_observer.h"

namespace cdiff::record {

/// One objective at one decision of one vehicle.
struct GuidanceSample {
  double time = 0.0;  ///< [s]
  std::string vehicle_id;
  guidance::ObjectiveReport report;
};

/// One objective over the session.
struct GuidanceSeries {
  std::string objective;
  std::vector<GuidanceSample> samples;
};

/// Over the decisions in which the objective was active.
struct ObjectiveSummary {
  std::optional<double> weight;  ///< weight at the last decision
  // Means; values that are not finite are left out.
  std::optional<double> value;
  std::optional<double> gradient_norm;
  std::optional<double> capped_share;
  std::int64_t dropped = 0;  ///< denoising steps, over all decisions
  std::size_t n = 0;         ///< decisions
};

/// What guidance did to the plans of CBVs: every objective's report at every decision.
class GuidanceLog {
 public:
  void observe(const session::TickRecord& record);
  /// In the order in which objectives appeared first.
  const std::vector<GuidanceSeries>& series() const { return series_; }
  /// Share of guided steps in which the trust region acted, over decisions with guidance.
  SampleSummary trustRegion() const { return summaryOf(trust_region_shares_); }

 private:
  GuidanceSeries& seriesOf(const std::string& objective);
  std::vector<GuidanceSeries> series_;
  std::vector<double> trust_region_shares_;
};

ObjectiveSummary summaryOf(const GuidanceSeries& series);

}  // namespace cdiff::record
