// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/collisions_per_km.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvDistance = {
    "cbv_distance_m",
    "/cbv/distance_m",
    "Distance driven as CBV",
    "m",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Sum over CBVs of the chords between successive ticks at which they were CBV.",
    "RIFT's reached progress (RP) sums the chords between decision ticks.",
};

namespace {

class CbvDistance final : public Metric {
 public:
  void observe(const MetricTick& tick) override { travel_.observe(tick); }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvDistance, numberMeasure(travel_.distance()));
  }

 private:
  CbvTravel travel_;
};

}  // namespace

MetricDescriptor cbvDistanceMetric() {
  return {"cbv_distance",
          "How far vehicles drove as CBVs.",
          {known::kCbvDistance},
          [](const MetricContext&) { return std::make_unique<CbvDistance>(); }};
}

}  // namespace cdiff::metrics
