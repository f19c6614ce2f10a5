// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr MeasureDefinition kOffRoad = {
    "ego_off_road_percent",
    "/ego/off_road_percent",
    "Ego off the road",
    "%",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "100 x ticks with the centre of the ego's box off the "
    "drivable area of its level / ticks with the ego.",
    "",
};

class EgoOffRoad final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (tick.ego != nullptr && tick.ego->state.position.allFinite()) share_.add(tick.ego_off_road);
  }
  void report(MetricSink& sink) const override { sink.set(kOffRoad, share_.measure(kNoEgo)); }

 private:
  TickShare share_;
};

}  // namespace

MetricDescriptor egoOffRoadMetric() {
  return {"ego_off_road",
          "Share of time that the ego was off the road.",
          {kOffRoad},
          [](const MetricContext&) { return std::make_unique<EgoOffRoad>(); }};
}

}  // namespace cdiff::metrics
