// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvOffRoad = {
    "cbv_off_road_percent",
    "/cbv/off_road_rate_percent",
    "Off-road rate of CBVs (ORR)",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x CBV ticks with the centre of the box off the drivable area of its level / CBV ticks; n "
    "counts ticks (paper's ORR).",
    "RIFT counts decision ticks (10 Hz) and asks CARLA for a Driving or Parking waypoint at the "
    "centre.",
    3,
    true,
};

namespace {

constexpr MeasureDefinition kCornerOffRoad = {
    "cbv_corner_off_road_percent",
    "/cbv/corner_off_road_rate_percent",
    "Off-road rate of CBVs, any corner",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x CBV ticks with the centre or any corner of the box off the drivable area of its level / "
    "CBV ticks; never below the rate by the centre.",
    "RIFT does not look at corners.",
};

class CbvOffRoad final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      centre_.add(cbv.off_road);
      corner_.add(cbv.off_road || cbv.corner_off_road);
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvOffRoad, centre_.measure(kNoCbv));
    sink.set(kCornerOffRoad, corner_.measure(kNoCbv));
  }

 private:
  TickShare centre_;
  TickShare corner_;
};

}  // namespace

MetricDescriptor cbvOffRoadMetric() {
  return {"cbv_off_road",
          "Share of time that CBVs were off the road.",
          {known::kCbvOffRoad, kCornerOffRoad},
          [](const MetricContext&) { return std::make_unique<CbvOffRoad>(); }};
}

}  // namespace cdiff::metrics
