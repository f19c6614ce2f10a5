// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr MeasureDefinition kTtcAxisMean = {
    "ttc_lon_lat_mean_s",
    "/metrics/ttc_lon_lat_s/mean",
    "Smaller of longitudinal and lateral TTC, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Mean over decision ticks of the ego's smallest time to collision by the paper's wording: in "
    "the ego's frame the smaller of gap / closing speed along and across, boxes taken as parallel, "
    "each valid where the other direction overlaps at that time; vehicles as for ttc_mean_s.",
    "RIFT does not report it.",
};
constexpr MeasureDefinition kTtcAxisDeviation = {
    "ttc_lon_lat_std_s",
    "/metrics/ttc_lon_lat_s/std",
    "Smaller of longitudinal and lateral TTC, standard deviation",
    "s",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Standard deviation (n - 1) of the values behind ttc_lon_lat_mean_s.",
    "",
};
constexpr MeasureDefinition kTtcAxisMinimum = {
    "ttc_lon_lat_min_s",
    "/metrics/ttc_lon_lat_s/min",
    "Smaller of longitudinal and lateral TTC, minimum",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "The smallest of the values behind ttc_lon_lat_mean_s.",
    "",
};
constexpr MeasureDefinition kTtcAxisDefined = {
    "ttc_lon_lat_defined_percent",
    "/metrics/ttc_lon_lat_defined_percent/value",
    "Longitudinal or lateral TTC is defined",
    "%",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Share of decision ticks with an ego at which the time behind ttc_lon_lat_mean_s is defined.",
    "",
};

class TtcLonLat final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick || tick.ego == nullptr) return;
    const std::optional<double>& time = tick.interaction.ttc_lon_lat;
    if (time) times_.add(*time);
    defined_.add(time.has_value());
  }
  void report(MetricSink& sink) const override {
    const DistributionMeasure times =
        times_.measure("no vehicle was on a collision course with the ego");
    sink.set(kTtcAxisMean, times.mean);
    sink.set(kTtcAxisDeviation, times.standard_deviation);
    sink.set(kTtcAxisMinimum, times.minimum);
    sink.set(kTtcAxisDefined, defined_.measure(kNoEgo));
  }

 private:
  SampleStatistics times_;
  TickShare defined_;
};

}  // namespace

MetricDescriptor ttcLonLatMetric() {
  return {"ttc_lon_lat",
          "Time to collision of the ego by the paper's wording.",
          {kTtcAxisMean, kTtcAxisDeviation, kTtcAxisMinimum, kTtcAxisDefined},
          [](const MetricContext&) { return std::make_unique<TtcLonLat>(); }};
}

}  // namespace cdiff::metrics
