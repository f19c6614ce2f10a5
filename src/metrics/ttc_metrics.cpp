// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

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

const MeasureDefinition known::kTtcDefined = {
    "ttc_defined_percent",
    "/metrics/ttc_2d_defined_percent/value",
    "2D-TTC is defined",
    "%",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Share of decision ticks with an ego at which its 2D time to collision is defined.",
    "",
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
    sink.set(known::kTtcDefined, defined_.measure(kNoEgo));
  }

 private:
  SampleStatistics times_;
  TickShare defined_;
};

}  // namespace

MetricDescriptor ttc2dMetric() {
  return {"ttc_2d",
          "2D time to collision of the ego with any vehicle (paper's 2D-TTC).",
          {known::kTtcMean, kTtcDeviation, known::kTtcMinimum, known::kTtcDefined},
          [](const MetricContext&) { return std::make_unique<Ttc2d>(); }};
}

const MeasureDefinition known::kTtcCbvMean = {
    "ttc_cbv_mean_s",
    "/metrics/ttc_2d_cbv_s/mean",
    "2D-TTC to CBVs, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "As ttc_mean_s, of the CBVs alone.",
    "RIFT takes all vehicles.",
};
const MeasureDefinition known::kTtcCbvMinimum = {
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

namespace {

constexpr MeasureDefinition kTtcCbvDeviation = {
    "ttc_cbv_std_s",     "/metrics/ttc_2d_cbv_s/std", "2D-TTC to CBVs, standard deviation", "s",
    Direction::kNeither, Subject::kEgoAndOthers,      "As ttc_std_s, of the CBVs alone.",   "",
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
    sink.set(known::kTtcCbvMean, times.mean);
    sink.set(kTtcCbvDeviation, times.standard_deviation);
    sink.set(known::kTtcCbvMinimum, times.minimum);
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
          {known::kTtcCbvMean, kTtcCbvDeviation, known::kTtcCbvMinimum, kTtcCbvDefined},
          [](const MetricContext&) { return std::make_unique<Ttc2dCbv>(); }};
}

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
