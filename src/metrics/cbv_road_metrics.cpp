// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <vector>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/quantiles.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/formulas/sorted_samples.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvOffRoad = {
    "cbv_off_road_percent",
    "/cbv/off_road_rate_percent",
    "Off-road rate of CBVs (ORR)",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x CBV ticks with the center of the box off the drivable area of its level / CBV ticks; n "
    "counts ticks (paper's ORR).",
    "RIFT counts decision ticks (10 Hz) and asks CARLA for a Driving or Parking waypoint at the "
    "center.",
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
    "100 x CBV ticks with the center or any corner of the box off the drivable area of its level / "
    "CBV ticks; never below the rate by the center.",
    "RIFT does not look at corners.",
};

class CbvOffRoad final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      center_.add(cbv.off_road);
      corner_.add(cbv.off_road || cbv.corner_off_road);
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvOffRoad, center_.measure(kNoCbv));
    sink.set(kCornerOffRoad, corner_.measure(kNoCbv));
  }

 private:
  TickShare center_;
  TickShare corner_;
};

}  // namespace

MetricDescriptor cbvOffRoadMetric() {
  return {"cbv_off_road",
          "Share of time that CBVs were off the road.",
          {known::kCbvOffRoad, kCornerOffRoad},
          [](const MetricContext&) { return std::make_unique<CbvOffRoad>(); }};
}

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
  explicit CbvEdgeDistance(std::pmr::memory_resource* memory) : distances_(memory) {}
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.edge_distance) continue;
      mean_.add(*cbv.edge_distance);
      distances_.add(*cbv.edge_distance);
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(kEdgeDistanceMean, measureOrReason(mean_.mean(), mean_.count(), kNoCbv));
    const std::pmr::vector<double>& sorted = distances_.sorted();
    if (sorted.empty()) return sink.set(kEdgeDistanceQuantile, absentMeasure(kNoCbv));
    const double quantile = sampleQuantileOf(sorted, 0.05, QuantileRule::kLinear);
    sink.set(kEdgeDistanceQuantile, {quantile, sorted.size(), {}, {}});
  }

 private:
  SampleStatistics mean_;
  SortedSamples distances_;  ///< [m]
};

}  // namespace

MetricDescriptor cbvEdgeDistanceMetric() {
  return {"cbv_edge_distance",
          "How far the boxes of CBVs stay from the edge of the road.",
          {kEdgeDistanceMean, kEdgeDistanceQuantile},
          [](const MetricContext& context) {
            return std::make_unique<CbvEdgeDistance>(context.memory);
          }};
}

const MeasureDefinition known::kCbvWrongWay = {
    "cbv_wrong_way_percent",
    "/cbv/wrong_way_percent",
    "Wrong-way driving of CBVs",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x distance that CBVs drove the wrong way / distance that they drove on lanes outside "
    "junctions, each CBV decision counting speed x decision period. A CBV is on the lanes whose "
    "width holds its center, on its level; it drives the wrong way where its heading is more than "
    "90 deg from each of them. n counts decisions on such lanes.",
    "RIFT does not compute it.",
};

namespace {

constexpr double kWidestHalf = 10.0;  // [m] no lane is broader to a side

enum class Way { kNotOnLane, kRight, kWrong };

Way wayOf(const traffic::VehicleState& state, const map::RoadNetwork& network) {
  bool on_lane = false;
  bool along = false;
  for (const map::LaneMatch& match :
       network.lanesNear(state.position, state.elevation, kWidestHalf, state.heading)) {
    const map::Lane& lane = network.lane(match.lane);
    if (match.projection.distance > 0.5 * lane.width) continue;
    if (lane.internal) return Way::kNotOnLane;
    on_lane = true;
    along = along || std::abs(match.heading_difference) <= core::degreesToRadians(90.0);
  }
  if (!on_lane) return Way::kNotOnLane;
  return along ? Way::kRight : Way::kWrong;
}

class CbvWrongWay final : public Metric {
 public:
  explicit CbvWrongWay(const map::RoadNetwork* network) : network_(network) {}

  void observe(const MetricTick& tick) override {
    if (network_ == nullptr || !tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      const traffic::VehicleState& state = cbv.vehicle->state;
      if (!cbv.placed() || !std::isfinite(state.heading) || !std::isfinite(state.speed)) continue;
      seen_ = true;
      const Way way = wayOf(state, *network_);
      if (way == Way::kNotOnLane) continue;
      ++decisions_;
      speeds_ += state.speed;
      if (way == Way::kWrong) wrong_speeds_ += state.speed;
    }
  }

  void report(MetricSink& sink) const override {
    if (network_ == nullptr) {
      sink.set(known::kCbvWrongWay, absentMeasure("no road network was given"));
    } else if (speeds_ > 0.0) {
      sink.set(known::kCbvWrongWay, {100.0 * wrong_speeds_ / speeds_, decisions_, {}, {}});
    } else {
      sink.set(known::kCbvWrongWay,
               absentMeasure(seen_ ? "no CBV drove on a lane outside junctions" : kNoCbv));
    }
  }

 private:
  const map::RoadNetwork* network_;
  bool seen_ = false;
  std::size_t decisions_ = 0;
  double speeds_ = 0.0;  ///< sum over decisions, in proportion to the distance [m/s]
  double wrong_speeds_ = 0.0;
};

}  // namespace

MetricDescriptor cbvWrongWayMetric() {
  return {"cbv_wrong_way",
          "Share of the distance that CBVs drove against the direction of their lane.",
          {known::kCbvWrongWay},
          [](const MetricContext& context) {
            return std::make_unique<CbvWrongWay>(context.options.network);
          }};
}

}  // namespace cdiff::metrics
