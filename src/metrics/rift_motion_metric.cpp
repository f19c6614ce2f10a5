// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <map>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/body_motion.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/rift_histogram.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kRiftAccelerationShapiroWilk = {
    "rift_compat_acceleration_shapiro_wilk",
    "/metrics/rift_compat/acceleration_shapiro_wilk/value",
    "RIFT: A-SW",
    "",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Shapiro-Wilk W of 3000 values drawn from that histogram.",
    "",
    3,
    false,
    kStatisticToOne,
};
const MeasureDefinition known::kRiftSpeedShapiroWilk = {
    "rift_compat_speed_shapiro_wilk",
    "/metrics/rift_compat/speed_shapiro_wilk/value",
    "RIFT: S-SW",
    "",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Shapiro-Wilk W of 3000 values drawn from RIFT's histogram of speeds.",
    "",
    3,
    false,
    kStatisticToOne,
};
const MeasureDefinition known::kRiftSpeedWasserstein = {
    "rift_compat_speed_wasserstein_mps",
    "/metrics/rift_compat/speed_wasserstein_mps/value",
    "RIFT: S-WD",
    "m/s",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "sqrt((mean - 8.5)^2 + deviation^2) of RIFT's histogram of speeds.",
    "",
    3,
    false,
    kPlainStatistic,
};

namespace {

constexpr MeasureDefinition kRiftAccelerationMean = {
    "rift_compat_acceleration_mean_mps2",
    "/metrics/rift_compat/acceleration_mean_mps2/value",
    "RIFT: acceleration, mean",
    "m/s^2",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean of the magnitude of acceleration from the midpoints of RIFT's bins below 3 m/s^2, "
    "histories repeated.",
    "",
};
constexpr MeasureDefinition kRiftAccelerationDeviation = {
    "rift_compat_acceleration_std_mps2",
    "/metrics/rift_compat/acceleration_std_mps2/value",
    "RIFT: acceleration, standard deviation",
    "m/s^2",
    Direction::kNeither,
    Subject::kCbvs,
    "Square root of the variance of that histogram's midpoints.",
    "",
};
constexpr MeasureDefinition kRiftJerkMean = {
    "rift_compat_jerk_mean_mps3",
    "/metrics/rift_compat/jerk_mean_mps3/value",
    "RIFT: jerk, mean",
    "m/s^3",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean of (magnitude of acceleration - the last one) / decision period, the first last one "
    "being 0, from 2 m/s^3 bins from -10 to 10, histories repeated.",
    "",
};
constexpr MeasureDefinition kRiftJerkDeviation = {
    "rift_compat_jerk_std_mps3",
    "/metrics/rift_compat/jerk_std_mps3/value",
    "RIFT: jerk, standard deviation",
    "m/s^3",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Square root of the variance of that jerk histogram's midpoints.",
    "",
};
constexpr MeasureDefinition kRiftSpeedMean = {
    "rift_compat_speed_mean_mps",
    "/metrics/rift_compat/speed_mean_mps/value",
    "RIFT: speed, mean",
    "m/s",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean speed from the midpoints of RIFT's bins below 14 m/s, histories repeated.",
    "",
};
constexpr MeasureDefinition kRiftSpeedDeviation = {
    "rift_compat_speed_std_mps",
    "/metrics/rift_compat/speed_std_mps/value",
    "RIFT: speed, standard deviation",
    "m/s",
    Direction::kNeither,
    Subject::kCbvs,
    "Square root of the variance of RIFT's histogram of speeds.",
    "",
};

constexpr std::size_t kDrawn = 3000;  // values that RIFT draws from a histogram

std::optional<double> rootOf(const std::optional<double>& variance) {
  return variance ? std::optional<double>(std::sqrt(*variance)) : std::nullopt;
}

/// Speed, acceleration and jerk of CBVs as in RIFT's code: from histograms in which sample i of an
/// n-tick life counts n - i times. n counts values before that.
class RiftMotion final : public Metric {
 public:
  explicit RiftMotion(double decision_period) : decision_period_(decision_period) {}

  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    std::map<std::string, Life> present;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      const std::string& id = cbv.vehicle->id;
      auto known = lives_.extract(id);
      const auto place =
          known ? present.insert(std::move(known)).position : present.emplace(id, Life{}).first;
      live(place->second, *cbv.vehicle);
    }
    lives_.swap(present);
  }

  void report(MetricSink& sink) const override {
    report(sink, speeds_, kRiftSpeedMean, kRiftSpeedDeviation);
    report(sink, accelerations_, kRiftAccelerationMean, kRiftAccelerationDeviation);
    report(sink, jerks_, kRiftJerkMean, kRiftJerkDeviation);
    sink.set(known::kRiftSpeedShapiroWilk, normality(speeds_));
    sink.set(known::kRiftAccelerationShapiroWilk, normality(accelerations_));
    std::optional<double> distance;
    if (const auto mean = speeds_.mean())
      distance = riftSpeedWasserstein(*mean, std::sqrt(*speeds_.variance()));
    Measure measure = measureOrReason(distance, n_, reason());
    measure.target = "8.5 m/s for all (30 km/h in RIFT's bins)";
    sink.set(known::kRiftSpeedWasserstein, measure);
  }

 private:
  /// A CBV since it became one.
  struct Life {
    RiftHistogram speeds = riftSpeedHistogram();
    RiftHistogram accelerations = riftAccelerationHistogram();
    RiftHistogram jerks = riftJerkHistogram();
    double last_acceleration = 0.0;  ///< RIFT starts a life with 0 [m/s^2]
  };

  void live(Life& life, const traffic::Vehicle& vehicle) {
    // RIFT's velocity is that of the rear axle, which points along the heading.
    const double magnitude = bodyAcceleration(vehicle).magnitude();
    const double jerk = (magnitude - life.last_acceleration) / decision_period_;
    life.last_acceleration = magnitude;
    life.speeds.add(vehicle.state.speed);
    life.accelerations.add(magnitude);
    life.jerks.add(jerk);
    speeds_.add(life.speeds);
    accelerations_.add(life.accelerations);
    jerks_.add(life.jerks);
    ++n_;
  }

  void report(MetricSink& sink, const RiftHistogram& histogram, const MeasureDefinition& mean,
              const MeasureDefinition& deviation) const {
    sink.set(mean, measureOrReason(histogram.mean(), n_, reason()));
    sink.set(deviation, measureOrReason(rootOf(histogram.variance()), n_, reason()));
  }

  Measure normality(const RiftHistogram& histogram) const {
    if (histogram.total() == 0) return measureOrReason(std::nullopt, n_, reason());
    return measureOrReason(shapiroWilk(histogram.resample(kDrawn)).w, n_, "");
  }

  /// Why a histogram is empty.
  const char* reason() const { return n_ == 0 ? kNoCbv : "no value lies inside RIFT's bins"; }

  double decision_period_;
  RiftHistogram speeds_ = riftSpeedHistogram();
  RiftHistogram accelerations_ = riftAccelerationHistogram();
  RiftHistogram jerks_ = riftJerkHistogram();
  std::map<std::string, Life> lives_;  ///< of the CBVs of the last decision tick
  std::size_t n_ = 0;
};

}  // namespace

MetricDescriptor riftMotionMetric() {
  return {"rift_motion",
          "Speed, acceleration and jerk of CBVs as RIFT's code computes them.",
          {kRiftAccelerationMean, known::kRiftAccelerationShapiroWilk, kRiftAccelerationDeviation,
           kRiftJerkMean, kRiftJerkDeviation, kRiftSpeedMean, known::kRiftSpeedShapiroWilk,
           kRiftSpeedDeviation, known::kRiftSpeedWasserstein},
          [](const MetricContext& context) {
            return std::make_unique<RiftMotion>(context.options.decision_period);
          }};
}

}  // namespace cdiff::metrics
