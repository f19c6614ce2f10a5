// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

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

}  // namespace cdiff::metrics
