// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

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
    "(Royston 1995); neighboring samples of one drive are not independent, so that it is no test "
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
  explicit CbvNormality(std::pmr::memory_resource* memory)
      : speeds_(memory), accelerations_(memory) {}
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
  std::pmr::vector<double> speeds_;         ///< [m/s]
  std::pmr::vector<double> accelerations_;  ///< [m/s^2]
};

}  // namespace

MetricDescriptor cbvNormalityMetric() {
  return {
      "cbv_normality",
      "Whether speeds and accelerations of CBVs are normally distributed.",
      {known::kSpeedShapiroWilk, kSpeedP, known::kAccelerationShapiroWilk, kAccelerationP},
      [](const MetricContext& context) { return std::make_unique<CbvNormality>(context.memory); }};
}

const MeasureDefinition known::kSpeedWasserstein = {
    "speed_wasserstein_mps",
    "/metrics/speed_wasserstein_mps/value",
    "Wasserstein distance of CBV speeds to the target",
    "m/s",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "1-Wasserstein distance between the speeds of CBVs at CBV decisions and the target that is "
    "named beside it: speeds of background vehicles within 150 m of the ego at decisions of the "
    "same session (default), a normal distribution (exact integral), or the samples of a file "
    "(paper's S-WD).",
    "RIFT computes the 2-Wasserstein distance of two normal distributions, sqrt((mean - 8.5)^2 + "
    "deviation^2), from its histogram; 8.5 m/s stands for CARLA's default limit of 30 km/h.",
    3,
    true,
    kPlainStatistic,
};

namespace {

constexpr double kBackgroundRadius = 150.0;  // [m] around the ego, for the sampled vehicles

/// Speeds of CBVs against a target: background vehicles of the session, a normal distribution, or
/// given samples.
class SpeedWasserstein final : public Metric {
 public:
  /// Throws InputError for samples that are not numbers.
  SpeedWasserstein(const MetricsOptions& options, std::pmr::memory_resource* memory)
      : options_(options), target_(memory), speeds_(memory) {
    if (options.speed_target != "file") return;
    for (const double sample : options.samples()) target_.add(sample);
  }

  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    if (tick.ego != nullptr && options_.speed_target == "background")
      sampleBackground(*tick.ego, tick.snapshot);
    for (const CbvSighting& cbv : tick.cbvs) {
      if (cbv.placed() && std::isfinite(cbv.vehicle->state.speed))
        speeds_.add(cbv.vehicle->state.speed);
    }
  }

  void report(MetricSink& sink) const override {
    Measure measure;
    measure.n = speeds_.size();
    measure.target = targetName();
    if (speeds_.empty()) {
      measure.reason = kNoCbv;
    } else if (options_.speed_target == "normal") {
      measure.value = wassersteinDistanceToNormal(speeds_, options_.speed_target_mean,
                                                  options_.speed_target_deviation);
    } else if (target_.empty()) {
      measure.reason = "no background vehicle within 150 m of the ego";
    } else {
      measure.value = wassersteinDistance(speeds_, target_);
    }
    sink.set(known::kSpeedWasserstein, measure);
  }

 private:
  void sampleBackground(const traffic::Vehicle& ego, const traffic::TrafficSnapshot& snapshot) {
    for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role != traffic::VehicleRole::kBackground) continue;
      if (!std::isfinite(vehicle.state.speed)) continue;
      const double distance = (vehicle.state.position - ego.state.position).norm();
      if (distance <= kBackgroundRadius) target_.add(vehicle.state.speed);
    }
  }

  std::string targetName() const {
    if (options_.speed_target == "normal") {
      return "normal distribution of mean " + core::formatNumber(options_.speed_target_mean) +
             " m/s and standard deviation " + core::formatNumber(options_.speed_target_deviation) +
             " m/s";
    }
    const std::string count = " (n = " + std::to_string(target_.size()) + ")";
    if (options_.speed_target == "file") return "file " + options_.speed_target_file + count;
    return "background vehicles within 150 m of the ego" + count;
  }

  MetricsOptions options_;
  SortedSamples target_;  ///< [m/s]
  SortedSamples speeds_;  ///< of CBVs [m/s]
};

}  // namespace

MetricDescriptor speedWassersteinMetric() {
  return {"speed_wasserstein",
          "Distance of the speeds of CBVs to a target distribution.",
          {known::kSpeedWasserstein},
          [](const MetricContext& context) {
            return std::make_unique<SpeedWasserstein>(context.options.metrics, context.memory);
          }};
}

}  // namespace cdiff::metrics
