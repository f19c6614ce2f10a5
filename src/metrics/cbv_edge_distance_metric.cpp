// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <vector>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr MeasureDefinition kEdgeDistanceMean = {
    "cbv_edge_distance_mean_m",
    "/metrics/cbv_edge_distance_m/mean",
    "Distance of CBVs to the road's edge, mean",
    "m",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Mean over CBV decisions of the smallest signed distance of the four corners of the box to the "
    "edge of the drivable area of its level, positive inside.",
    "RIFT does not compute it.",
};
constexpr MeasureDefinition kEdgeDistanceQuantile = {
    "cbv_edge_distance_p5_m",
    "/metrics/cbv_edge_distance_m/p5",
    "Distance of CBVs to the road's edge, 5 % quantile",
    "m",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "5 % quantile of the same distances, linear between order statistics (Hyndman and Fan 1996, "
    "type 7).",
    "RIFT does not compute it.",
};

class CbvEdgeDistance final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.edge_distance) continue;
      mean_.add(*cbv.edge_distance);
      distances_.push_back(*cbv.edge_distance);
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(kEdgeDistanceMean, measureOrReason(mean_.mean(), mean_.count(), kNoCbv));
    sink.set(kEdgeDistanceQuantile,
             measureOrReason(quantileOf(distances_, 0.05), distances_.size(), kNoCbv));
  }

 private:
  SampleStatistics mean_;
  std::vector<double> distances_;  ///< [m]
};

}  // namespace

MetricDescriptor cbvEdgeDistanceMetric() {
  return {"cbv_edge_distance",
          "How far the boxes of CBVs stay from the edge of the road.",
          {kEdgeDistanceMean, kEdgeDistanceQuantile},
          [](const MetricContext&) { return std::make_unique<CbvEdgeDistance>(); }};
}

}  // namespace cdiff::metrics
