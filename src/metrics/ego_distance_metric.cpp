// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

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

}  // namespace cdiff::metrics
