// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kRouteCompletion = {
    "ego_completion_percent",
    "/ego/route_completion_percent",
    "Route completion",
    "%",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Share of the ego route's length up to the farthest place that the ego reached along it; 100 "
    "once the protocol's completion rule is met (CARLA leaderboard, RouteCompletionTest).",
    "",
    3,
    true,
    kMeanToHundred,
};

namespace {

class RouteCompletion final : public Metric {
 public:
  void observe(const MetricTick& tick) override { percent_ = tick.route_completion_percent; }
  void report(MetricSink& sink) const override {
    sink.set(known::kRouteCompletion, numberMeasure(percent_));
  }

 private:
  double percent_ = 0.0;
};

}  // namespace

MetricDescriptor egoRouteCompletionMetric() {
  return {"ego_route_completion",
          "How far the ego came along its route.",
          {known::kRouteCompletion},
          [](const MetricContext&) { return std::make_unique<RouteCompletion>(); }};
}

}  // namespace cdiff::metrics
