// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

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

const MeasureDefinition known::kCbvDistance = {
    "cbv_distance_m",
    "/cbv/distance_m",
    "Distance driven as CBV",
    "m",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Sum over CBVs of the chords between successive ticks at which they were CBV.",
    "RIFT's reached progress (RP) sums the chords between decision ticks.",
};

namespace {

class CbvDistance final : public Metric {
 public:
  void observe(const MetricTick& tick) override { travel_.observe(tick); }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvDistance, numberMeasure(travel_.distance()));
  }

 private:
  CbvTravel travel_;
};

}  // namespace

MetricDescriptor cbvDistanceMetric() {
  return {"cbv_distance",
          "How far vehicles drove as CBVs.",
          {known::kCbvDistance},
          [](const MetricContext&) { return std::make_unique<CbvDistance>(); }};
}

const MeasureDefinition known::kCbvClosestDistance = {
    "cbv_closest_distance_m",
    "/cbv/closest_distance_m",
    "Closest approach to the ego, mean over CBVs, between centers",
    "m",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Mean over CBVs of each one's smallest distance of centers to the ego while it was CBV.",
    "",
};
const MeasureDefinition known::kCbvMinimumDistance = {
    "cbv_minimum_distance_m",
    "/cbv/minimum_distance_m",
    "Closest approach of any CBV to the ego, between centers",
    "m",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "The smallest distance of centers between the ego and any CBV.",
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

const MeasureDefinition known::kCbvSpeedError = {
    "cbv_speed_error_mps",
    "/cbv/speed_error_mps",
    "Speed error of CBVs",
    "m/s",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Mean over CBV decisions of |speed - smaller of target speed and lane limit|.",
    "",
};

namespace {

class CbvSpeedError final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (!tick.snapshot.decision_tick) return;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (cbv.placed() && cbv.wanted_speed)
        errors_.add(std::abs(cbv.vehicle->state.speed - *cbv.wanted_speed));
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvSpeedError, errors_.measure(kNoCbv).mean);
  }

 private:
  SampleStatistics errors_;
};

}  // namespace

MetricDescriptor cbvSpeedErrorMetric() {
  return {"cbv_speed_error",
          "How far CBVs are from the speed that they aim at.",
          {known::kCbvSpeedError},
          [](const MetricContext&) { return std::make_unique<CbvSpeedError>(); }};
}

}  // namespace cdiff::metrics
