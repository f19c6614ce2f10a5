// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"
#include "metrics/measures/shapiro_wilk.h"

namespace cdiff::metrics {

namespace {

constexpr const char* kResamples =
    "RIFT draws 3000 values (NumPy's stream of seed 0) from a histogram in which early samples are "
    "counted again at every tick.";

}  // namespace

const MeasureDefinition known::kSpeedShapiroWilk = {
    "speed_shapiro_wilk",
    "/metrics/speed_shapiro_wilk/value",
    "Shapiro-Wilk W of CBV speeds",
    "",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Shapiro-Wilk W (Royston 1995, AS R94) of the speeds of CBVs at CBV decisions; of more than "
    "5000 samples every k-th is taken (paper's S-SW).",
    kResamples,
    3,
    true,
    kStatisticToOne,
};
const MeasureDefinition known::kAccelerationShapiroWilk = {
    "acceleration_shapiro_wilk",
    "/metrics/acceleration_shapiro_wilk/value",
    "Shapiro-Wilk W of CBV accelerations",
    "",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Shapiro-Wilk W of the signed longitudinal accelerations of CBVs at CBV decisions; samples as "
    "for speed_shapiro_wilk (paper's A-SW).",
    "RIFT takes the magnitude of the two-dimensional acceleration below 3 m/s^2, which is never "
    "negative, and draws 3000 values from its histogram.",
    3,
    true,
    kStatisticToOne,
};

namespace {

constexpr MeasureDefinition kSpeedP = {
    "speed_shapiro_wilk_p",
    "/metrics/speed_shapiro_wilk_p/value",
    "Shapiro-Wilk p of CBV speeds",
    "",
    Direction::kNeither,
    Subject::kCbvs,
    "Probability of a W as small as speed_shapiro_wilk for a normal sample of the same size "
    "(Royston 1995); neighbouring samples of one drive are not independent, so that it is no test "
    "at that level.",
    "RIFT reports W alone.",
    3,
    false,
    kStatisticToOne,
};
constexpr MeasureDefinition kAccelerationP = {
    "acceleration_shapiro_wilk_p",
    "/metrics/acceleration_shapiro_wilk_p/value",
    "Shapiro-Wilk p of CBV accelerations",
    "",
    Direction::kNeither,
    Subject::kCbvs,
    "Probability of a W as small as acceleration_shapiro_wilk for a normal sample of the same "
    "size.",
    "RIFT reports W alone.",
    3,
    false,
    kStatisticToOne,
};

/// Shapiro-Wilk of the speeds and the signed longitudinal accelerations of CBVs at decisions.
class CbvNormality final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      const traffic::Vehicle& vehicle = *cbv.vehicle;
      if (std::isfinite(vehicle.state.speed)) speeds_.push_back(vehicle.state.speed);
      if (std::isfinite(vehicle.acceleration)) accelerations_.push_back(vehicle.acceleration);
    }
  }
  void report(MetricSink& sink) const override {
    const NormalityMeasures speed = normalityMeasures(speeds_, kNoCbv);
    sink.set(known::kSpeedShapiroWilk, speed.w);
    sink.set(kSpeedP, speed.p);
    const NormalityMeasures acceleration = normalityMeasures(accelerations_, kNoCbv);
    sink.set(known::kAccelerationShapiroWilk, acceleration.w);
    sink.set(kAccelerationP, acceleration.p);
  }

 private:
  std::vector<double> speeds_;         ///< [m/s]
  std::vector<double> accelerations_;  ///< [m/s^2]
};

}  // namespace

MetricDescriptor cbvNormalityMetric() {
  return {"cbv_normality",
          "Whether speeds and accelerations of CBVs are normally distributed.",
          {known::kSpeedShapiroWilk, kSpeedP, known::kAccelerationShapiroWilk, kAccelerationP},
          [](const MetricContext&) { return std::make_unique<CbvNormality>(); }};
}

}  // namespace cdiff::metrics
