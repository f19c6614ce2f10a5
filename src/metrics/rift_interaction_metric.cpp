// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/rift_histogram.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kRiftTtc = {
    "rift_compat_ttc_2d_s",
    "/metrics/rift_compat/ttc_2d_s/value",
    "RIFT: RTTC, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Per decision the smallest over vehicles within 60 m of RIFT's ray cast with bow-tie outlines, "
    "rounded to 0.01 s; mean of 0.5 s bins below 5 s at ego speeds of 3 to 10 m/s.",
    "",
};

namespace {

constexpr MeasureDefinition kTtcVariance = {
    "rift_compat_ttc_2d_variance_s2",
    "/metrics/rift_compat/ttc_2d_variance_s2/value",
    "RIFT: RTTC, variance",
    "s^2",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Variance of the RTTC bins' midpoints; RIFT prints it after +-.",
    "",
};
constexpr MeasureDefinition kAct = {
    "rift_compat_act_s",
    "/metrics/rift_compat/act_s/value",
    "RIFT: ACT, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Per decision the smallest over vehicles within 60 m of shortest corner-to-corner distance / "
    "approach speed of the centres, rounded to 0.01 s; mean of 0.5 s bins below 5 s at ego speeds "
    "of 3 to 10 m/s.",
    "",
};
constexpr MeasureDefinition kActVariance = {
    "rift_compat_act_variance_s2",
    "/metrics/rift_compat/act_variance_s2/value",
    "RIFT: ACT, variance",
    "s^2",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Variance of the same bins' midpoints.",
    "",
};

/// Times to collision as RIFT's code has them: in bins below 5 s at ego speeds of 3 to 10 m/s.
class RiftInteraction final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    constexpr double kLeastSpeed = 3.0;  // cells at or below this edge are not reported
    constexpr double kMostSpeed = 10.0;  // last edge of RIFT's bins of the ego's speed
    if (!tick.snapshot.decision_tick || tick.ego == nullptr) return;
    const double speed = tick.ego->state.speed;
    if (!(speed > kLeastSpeed) || !(speed < kMostSpeed)) return;
    if (tick.interaction.rift_ttc) times_.add(*tick.interaction.rift_ttc);
    if (tick.interaction.rift_act) approach_times_.add(*tick.interaction.rift_act);
  }

  void report(MetricSink& sink) const override {
    report(sink, times_, known::kRiftTtc, kTtcVariance);
    report(sink, approach_times_, kAct, kActVariance);
  }

 private:
  static void report(MetricSink& sink, const RiftHistogram& times, const MeasureDefinition& mean,
                     const MeasureDefinition& variance) {
    constexpr const char* kNoTime = "no time below 5 s at an ego speed of 3 to 10 m/s";
    const std::size_t n = times.total();
    sink.set(mean, measureOrReason(times.mean(), n, kNoTime));
    sink.set(variance, measureOrReason(times.variance(), n, kNoTime));
  }

  RiftHistogram times_ = riftTtcHistogram();
  RiftHistogram approach_times_ = riftTtcHistogram();
};

}  // namespace

MetricDescriptor riftInteractionMetric() {
  return {"rift_interaction",
          "Times to collision as RIFT's code computes them.",
          {known::kRiftTtc, kTtcVariance, kAct, kActVariance},
          [](const MetricContext&) { return std::make_unique<RiftInteraction>(); }};
}

}  // namespace cdiff::metrics
