// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>
#include <map>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvClosestDistance = {
    "cbv_closest_distance_m",
    "/cbv/closest_distance_m",
    "Closest approach of CBVs, mean",
    "m",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Mean over CBVs of each one's smallest distance of centres to the ego while it was CBV.",
    "",
};
const MeasureDefinition known::kCbvMinimumDistance = {
    "cbv_minimum_distance_m",
    "/cbv/minimum_distance_m",
    "Closest approach of CBVs, minimum",
    "m",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "The smallest distance of centres between the ego and any CBV.",
    "",
};

namespace {

class CbvApproach final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      cbv_driven_ = true;
      if (!cbv.ego_distance || !std::isfinite(*cbv.ego_distance)) continue;
      const auto [closest, first] = closest_.emplace(cbv.vehicle->id, *cbv.ego_distance);
      if (!first) closest->second = std::min(closest->second, *cbv.ego_distance);
    }
  }
  void report(MetricSink& sink) const override {
    SampleStatistics distances;
    for (const auto& [id, distance] : closest_) distances.add(distance);
    const DistributionMeasure measure = distances.measure(cbv_driven_ ? kNoEgo : kNoCbv);
    sink.set(known::kCbvClosestDistance, measure.mean);
    sink.set(known::kCbvMinimumDistance, measure.minimum);
  }

 private:
  bool cbv_driven_ = false;
  std::map<std::string, double> closest_;  ///< smallest distance to the ego, by vehicle [m]
};

}  // namespace

MetricDescriptor cbvApproachMetric() {
  return {"cbv_approach",
          "How near CBVs came to the ego.",
          {known::kCbvClosestDistance, known::kCbvMinimumDistance},
          [](const MetricContext&) { return std::make_unique<CbvApproach>(); }};
}

}  // namespace cdiff::metrics
