// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <set>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvCount = {
    "cbv_count",
    "/cbv/count",
    "CBVs",
    "count",
    Direction::kNeither,
    Subject::kCbvs,
    "Vehicles whose role was CBV at one tick or more.",
    "",
    0,
    true,
    kPlainMean,
};
const MeasureDefinition known::kCbvDecisions = {
    "cbv_decisions",
    "/cbv/decisions",
    "Decisions with a CBV",
    "count",
    Direction::kNeither,
    Subject::kCbvs,
    "Decision ticks at which a vehicle was CBV, summed over CBVs.",
    "",
    0,
    false,
    kPlainMean,
};

namespace {

class CbvCount final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      driven_.insert(cbv.vehicle->id);
      if (tick.snapshot.decision_tick) ++decisions_;
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvCount, countMeasure(driven_.size()));
    sink.set(known::kCbvDecisions, countMeasure(decisions_));
  }

 private:
  std::set<std::string> driven_;
  std::size_t decisions_ = 0;
};

}  // namespace

MetricDescriptor cbvCountMetric() {
  return {"cbv_count",
          "How many vehicles were CBVs, and for how many decisions.",
          {known::kCbvCount, known::kCbvDecisions},
          [](const MetricContext&) { return std::make_unique<CbvCount>(); }};
}

}  // namespace cdiff::metrics
