// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvSpeedError = {
    "cbv_speed_error_mps",
    "/cbv/speed_error_mps",
    "Speed error of CBVs",
    "m/s",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Mean over CBV decisions of |speed - smaller of target speed and lane limit|.",
    "",
};

namespace {

class CbvSpeedError final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (cbv.placed() && cbv.wanted_speed)
        errors_.add(std::abs(cbv.vehicle->state.speed - *cbv.wanted_speed));
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvSpeedError, errors_.measure(kNoCbv).mean);
  }

 private:
  SampleStatistics errors_;
};

}  // namespace

MetricDescriptor cbvSpeedErrorMetric() {
  return {"cbv_speed_error",
          "How far CBVs are from the speed that they aim at.",
          {known::kCbvSpeedError},
          [](const MetricContext&) { return std::make_unique<CbvSpeedError>(); }};
}

}  // namespace cdiff::metrics
