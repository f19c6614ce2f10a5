// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

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

const MeasureDefinition known::kEgoDistance = {
    "ego_distance_m",
    "/ego/distance_m",
    "Distance driven by the ego",
    "m",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Sum of the chords between the ego's positions at successive ticks; n counts ticks with the "
    "ego.",
    "RIFT does not report it.",
};

namespace {

class EgoDistance final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (tick.ego == nullptr || !tick.ego->state.position.allFinite()) {
      last_.reset();
      return;
    }
    const Eigen::Vector2d& position = tick.ego->state.position;
    if (last_) distance_ += (position - *last_).norm();
    last_ = position;
    ++ticks_;
  }
  void report(MetricSink& sink) const override {
    const std::optional<double> distance =
        ticks_ == 0 ? std::nullopt : std::optional<double>(distance_);
    sink.set(known::kEgoDistance, measureOrReason(distance, ticks_, kNoEgo));
  }

 private:
  std::optional<Eigen::Vector2d> last_;  ///< at the last tick, map frame [m]
  double distance_ = 0.0;                ///< [m]
  std::size_t ticks_ = 0;
};

}  // namespace

MetricDescriptor egoDistanceMetric() {
  return {
      "ego_distance", "How far the ego drove.", {known::kEgoDistance}, [](const MetricContext&) {
        return std::make_unique<EgoDistance>();
      }};
}

const MeasureDefinition known::kBlocked = {
    "ego_blocked",
    "/ego/blocked",
    "Ego blocked",
    "",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "1 when the session ended because the ego stood still for the protocol's blocked time, else 0.",
    "",
    3,
    false,
    kMeanToOne,
};

namespace {

class Blocked final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    blocked_ = tick.snapshot.status == traffic::SessionStatus::kBlocked;
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kBlocked, numberMeasure(blocked_ ? 1.0 : 0.0));
  }

 private:
  bool blocked_ = false;  ///< by the last tick
};

}  // namespace

MetricDescriptor egoBlockedMetric() {
  return {"ego_blocked",
          "Whether the session ended because the ego stood still.",
          {known::kBlocked},
          [](const MetricContext&) { return std::make_unique<Blocked>(); }};
}

const MeasureDefinition known::kEgoOffRoad = {
    "ego_off_road_percent",
    "/ego/off_road_percent",
    "Ego off the road",
    "%",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "100 x ticks with the center of the ego's box off the "
    "drivable area of its level / ticks with the ego.",
    "",
};

namespace {

class EgoOffRoad final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (tick.ego != nullptr && tick.ego->state.position.allFinite()) share_.add(tick.ego_off_road);
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kEgoOffRoad, share_.measure(kNoEgo));
  }

 private:
  TickShare share_;
};

}  // namespace

MetricDescriptor egoOffRoadMetric() {
  return {"ego_off_road",
          "Share of time that the ego was off the road.",
          {known::kEgoOffRoad},
          [](const MetricContext&) { return std::make_unique<EgoOffRoad>(); }};
}

}  // namespace cdiff::metrics
