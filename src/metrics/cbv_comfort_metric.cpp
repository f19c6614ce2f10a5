// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/measures/body_motion.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

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
