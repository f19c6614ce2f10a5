// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr MeasureDefinition kTtcCbvMean = {
    "ttc_cbv_mean_s",
    "/metrics/ttc_2d_cbv_s/mean",
    "2D-TTC to CBVs, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "As ttc_mean_s, of the CBVs alone.",
    "RIFT takes all vehicles.",
};
constexpr MeasureDefinition kTtcCbvDeviation = {
    "ttc_cbv_std_s",     "/metrics/ttc_2d_cbv_s/std", "2D-TTC to CBVs, standard deviation", "s",
    Direction::kNeither, Subject::kEgoAndOthers,      "As ttc_std_s, of the CBVs alone.",   "",
};
constexpr MeasureDefinition kTtcCbvMinimum = {
    "ttc_cbv_min_s",
    "/metrics/ttc_2d_cbv_s/min",
    "2D-TTC to CBVs, minimum",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "As ttc_min_s, of the CBVs alone.",
    "",
    3,
    true,
};
constexpr MeasureDefinition kTtcCbvDefined = {
    "ttc_cbv_defined_percent",
    "/metrics/ttc_2d_cbv_defined_percent/value",
    "2D-TTC to CBVs is defined",
    "%",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Share of decision ticks with an ego and a CBV at which the "
    "2D time to collision to a CBV is defined.",
    "",
    3,
    false,
    PoolingRule{Pooling::kShare, SessionWeight::kCbvDecisions},
};

class Ttc2dCbv final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick || tick.ego == nullptr) return;
    const std::optional<double>& time = tick.interaction.ttc_2d_cbv;
    if (time) times_.add(*time);
    if (!tick.cbvs.empty()) defined_.add(time.has_value());
  }
  void report(MetricSink& sink) const override {
    const bool no_cbv = defined_.ticks() == 0;
    const DistributionMeasure times =
        times_.measure(no_cbv ? kNoCbv : "no CBV was on a collision course with the ego");
    sink.set(kTtcCbvMean, times.mean);
    sink.set(kTtcCbvDeviation, times.standard_deviation);
    sink.set(kTtcCbvMinimum, times.minimum);
    sink.set(kTtcCbvDefined, defined_.measure(kNoCbv));
  }

 private:
  SampleStatistics times_;
  TickShare defined_;  ///< of decisions with a CBV
};

}  // namespace

MetricDescriptor ttc2dCbvMetric() {
  return {"ttc_2d_cbv",
          "2D time to collision of the ego with CBVs.",
          {kTtcCbvMean, kTtcCbvDeviation, kTtcCbvMinimum, kTtcCbvDefined},
          [](const MetricContext&) { return std::make_unique<Ttc2dCbv>(); }};
}

}  // namespace cdiff::metrics
