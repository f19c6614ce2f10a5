// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/body_motion.h"
#include "metrics/formulas/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr const char* kRepeats =
    "RIFT adds the whole history of each living CBV again at every tick (sample i of an n-tick "
    "life counts n - i times) and takes mean and deviation from the midpoints of its bins.";

constexpr MeasureDefinition kSpeedMean = {
    "cbv_speed_mean_mps",
    "/metrics/speed_mps/mean",
    "Speed of CBVs, mean",
    "m/s",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean speed of CBVs over CBV decisions.",
    kRepeats,
};
constexpr MeasureDefinition kSpeedDeviation = {
    "cbv_speed_std_mps",
    "/metrics/speed_mps/std",
    "Speed of CBVs, standard deviation",
    "m/s",
    Direction::kNeither,
    Subject::kCbvs,
    "Standard deviation (n - 1) of the speed of CBVs over CBV decisions.",
    kRepeats,
};
constexpr MeasureDefinition kSpeedMinimum = {
    "cbv_speed_min_mps",
    "/metrics/speed_mps/min",
    "Speed of CBVs, minimum",
    "m/s",
    Direction::kNeither,
    Subject::kCbvs,
    "Smallest speed of a CBV at a CBV decision.",
    "",
};
constexpr MeasureDefinition kAccelerationMean = {
    "cbv_acceleration_mean_mps2",
    "/metrics/acceleration_mps2/mean",
    "Acceleration of CBVs, mean magnitude",
    "m/s^2",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean over CBV decisions of the magnitude of acceleration, sqrt(longitudinal^2 + lateral^2); "
    "longitudinal = change of speed over the last simulation step / step, lateral = speed x yaw "
    "rate.",
    kRepeats,
};
constexpr MeasureDefinition kAccelerationDeviation = {
    "cbv_acceleration_std_mps2",
    "/metrics/acceleration_mps2/std",
    "Acceleration of CBVs, standard deviation of the magnitude",
    "m/s^2",
    Direction::kNeither,
    Subject::kCbvs,
    "Standard deviation (n - 1) of the same magnitudes.",
    kRepeats,
};
constexpr MeasureDefinition kAccelerationMinimum = {
    "cbv_acceleration_min_mps2",
    "/metrics/acceleration_mps2/min",
    "Acceleration of CBVs, smallest magnitude",
    "m/s^2",
    Direction::kNeither,
    Subject::kCbvs,
    "The smallest of the same magnitudes.",
    "",
};
constexpr MeasureDefinition kJerkMean = {
    "cbv_jerk_mean_mps3",
    "/metrics/jerk_mps3/mean",
    "Jerk of CBVs, mean",
    "m/s^3",
    Direction::kNeither,
    Subject::kCbvs,
    "Mean of the jerk of CBVs: change of the magnitude of acceleration from one CBV decision to "
    "the next / decision period, signed; a vehicle's first decision as CBV has none.",
    "RIFT takes the acceleration before the first decision as 0 and adds histories again at every "
    "tick (bins from -10 to 10 m/s^3).",
};
constexpr MeasureDefinition kJerkDeviation = {
    "cbv_jerk_std_mps3",
    "/metrics/jerk_mps3/std",
    "Jerk of CBVs, standard deviation",
    "m/s^3",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Standard deviation (n - 1) of the same jerks.",
    "RIFT takes it from the midpoints of its bins, with the same additions as for the mean.",
};
constexpr MeasureDefinition kJerkMinimum = {
    "cbv_jerk_min_mps3",
    "/metrics/jerk_mps3/min",
    "Jerk of CBVs, smallest",
    "m/s^3",
    Direction::kNeither,
    Subject::kCbvs,
    "The smallest (most negative) of the same jerks.",
    "",
};

/// Speed, magnitude of acceleration and jerk of CBVs at decisions; a value that is not finite is
/// left out.
class CbvMotion final : public Metric {
 public:
  explicit CbvMotion(double decision_period) : motions_(decision_period) {}

  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) speeds_.add(cbv.vehicle->state.speed);
    for (const BodyMotion& motion : motions_.observe(tick.cbvs)) {
      accelerations_.add(motion.acceleration.magnitude());
      if (motion.jerk) jerks_.add(*motion.jerk);
    }
  }

  void report(MetricSink& sink) const override {
    const DistributionMeasure speed = speeds_.measure(kNoCbv);
    sink.set(kSpeedMean, speed.mean);
    sink.set(kSpeedDeviation, speed.standard_deviation);
    sink.set(kSpeedMinimum, speed.minimum);
    const DistributionMeasure acceleration = accelerations_.measure(kNoCbv);
    sink.set(kAccelerationMean, acceleration.mean);
    sink.set(kAccelerationDeviation, acceleration.standard_deviation);
    sink.set(kAccelerationMinimum, acceleration.minimum);
    const DistributionMeasure jerk = jerks_.measure(
        accelerations_.count() == 0 ? kNoCbv : "no CBV was driven for two decisions in a row");
    sink.set(kJerkMean, jerk.mean);
    sink.set(kJerkDeviation, jerk.standard_deviation);
    sink.set(kJerkMinimum, jerk.minimum);
  }

 private:
  BodyMotions motions_;
  SampleStatistics speeds_;
  SampleStatistics accelerations_;
  SampleStatistics jerks_;
};

}  // namespace

MetricDescriptor cbvMotionMetric() {
  return {"cbv_motion",
          "Speed, acceleration and jerk of CBVs.",
          {kSpeedMean, kSpeedDeviation, kSpeedMinimum, kAccelerationMean, kAccelerationDeviation,
           kAccelerationMinimum, kJerkMean, kJerkDeviation, kJerkMinimum},
          [](const MetricContext& context) {
            return std::make_unique<CbvMotion>(context.options.decision_period);
          }};
}

namespace {

constexpr MeasureDefinition kUncomfortable = {
    "cbv_uncomfortable_percent",
    "/cbv/uncomfortable_rate_percent",
    "Uncomfortable rate of CBVs",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x CBV decisions that are not within -4.05 < longitudinal acceleration < 2.40 m/s^2, "
    "|lateral acceleration| < 4.89 m/s^2 and |jerk| < 8.37 m/s^3 / CBV decisions (nuPlan's "
    "limits); lateral acceleration = speed x yaw rate.",
    "RIFT takes the acceleration before a CBV's first decision as 0, so that its first jerk can be "
    "beyond the limit.",
    3,
    true,
};

class CbvComfort final : public Metric {
 public:
  explicit CbvComfort(double decision_period) : motions_(decision_period) {}

  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const BodyMotion& motion : motions_.observe(tick.cbvs))
      uncomfortable_.add(isUncomfortable(motion.acceleration, motion.jerk));
  }
  void report(MetricSink& sink) const override {
    sink.set(kUncomfortable, uncomfortable_.measure(kNoCbv));
  }

 private:
  BodyMotions motions_;
  TickShare uncomfortable_;
};

}  // namespace

MetricDescriptor cbvComfortMetric() {
  return {"cbv_comfort",
          "Share of decisions at which CBVs were beyond nuPlan's comfort limits.",
          {kUncomfortable},
          [](const MetricContext& context) {
            return std::make_unique<CbvComfort>(context.options.decision_period);
          }};
}

}  // namespace cdiff::metrics
