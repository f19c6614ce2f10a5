// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kTtcMean = {
    "ttc_mean_s",
    "/metrics/ttc_2d_s/mean",
    "2D-TTC, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Mean over decision ticks of the ego's smallest 2D time to collision: the first time at which "
    "its oriented box and that of any vehicle within 60 m on its level touch, both keeping "
    "velocity and heading; decisions without a contact ahead within 3600 s are left out (paper's "
    "2D-TTC).",
    "RIFT casts rays from corners onto bow-tie outlines, keeps times below 5 s at ego speeds of 3 "
    "to 10 m/s, and averages the midpoints of 0.5 s bins.",
    3,
    true,
};
const MeasureDefinition known::kTtcMinimum = {
    "ttc_min_s",
    "/metrics/ttc_2d_s/min",
    "2D-TTC, minimum",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "The smallest of the same values; 0 for overlapping boxes.",
    "RIFT gives no minimum.",
    3,
    true,
};

namespace {

constexpr MeasureDefinition kTtcDeviation = {
    "ttc_std_s",
    "/metrics/ttc_2d_s/std",
    "2D-TTC, standard deviation",
    "s",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Standard deviation (n - 1) of the same values.",
    "RIFT prints the variance of its bins as if it were the deviation.",
};
constexpr MeasureDefinition kTtcDefined = {
    "ttc_defined_percent",
    "/metrics/ttc_2d_defined_percent/value",
    "2D-TTC is defined",
    "%",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Share of decision ticks with an ego at which its 2D time to collision is defined.",
    "",
};

class Ttc2d final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick || tick.ego == nullptr) return;
    const std::optional<double>& time = tick.interaction.ttc_2d;
    if (time) times_.add(*time);
    defined_.add(time.has_value());
  }
  void report(MetricSink& sink) const override {
    const DistributionMeasure times =
        times_.measure("no vehicle was on a collision course with the ego");
    sink.set(known::kTtcMean, times.mean);
    sink.set(kTtcDeviation, times.standard_deviation);
    sink.set(known::kTtcMinimum, times.minimum);
    sink.set(kTtcDefined, defined_.measure(kNoEgo));
  }

 private:
  SampleStatistics times_;
  TickShare defined_;
};

}  // namespace

MetricDescriptor ttc2dMetric() {
  return {"ttc_2d",
          "2D time to collision of the ego with any vehicle (paper's 2D-TTC).",
          {known::kTtcMean, kTtcDeviation, known::kTtcMinimum, kTtcDefined},
          [](const MetricContext&) { return std::make_unique<Ttc2d>(); }};
}

}  // namespace cdiff::metrics
