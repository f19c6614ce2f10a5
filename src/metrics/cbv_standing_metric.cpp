// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <map>
#include <set>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/free_road.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvStanding = {
    "cbv_standing_free",
    "/cbv/standing_on_free_road",
    "CBVs that stand on a free road",
    "count",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "CBVs that stood (below 0.1 m/s) at each decision of more than 3 s, each time with a free "
    "road: "
    "over 10 m of the conflict-aware route before the front no vehicle on its level, no red or "
    "yellow light and, near a junction, none within 25 m that moves (docs/metrics.md); n counts "
    "CBVs with a route.",
    "RIFT does not compute it.",
    0,
};

namespace {

constexpr MeasureDefinition kFreeStandPerKm = {
    "cbv_standing_free_per_km",
    "/cbv/standing_on_free_road_per_km",
    "CBVs that stand on a free road, per km",
    "1/km",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "1000 x cbv_standing_free / distance driven as CBV in meters; n counts CBVs.",
    "RIFT does not compute it.",
};
constexpr MeasureDefinition kFreeStandShare = {
    "cbv_standing_free_percent",
    "/cbv/standing_on_free_road_percent",
    "Time that CBVs stand on a free road",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x decisions in such stands of more than 3 s / decisions of CBVs with a route.",
    "RIFT does not compute it.",
};

constexpr double kLongestStand = 3.0;     // [s]
constexpr double kStandTolerance = 1e-6;  // [s]
constexpr const char* kNoRoute = "no CBV had a route at a decision";

/// Decisions in a row at which a CBV stood on a free road.
struct Stand {
  double since = 0.0;  ///< [s]
  std::size_t decisions = 0;
  bool long_enough = false;
};

class CbvStanding final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    travel_.observe(tick);
    if (!tick.snapshot.decision_tick) return;
    std::map<std::string, Stand> present;  // a CBV that comes back has not stood meanwhile
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      Stand& stand = present.emplace(cbv.vehicle->id, stands_[cbv.vehicle->id]).first->second;
      observeCbv(*cbv.vehicle, tick, stand);
    }
    stands_ = std::move(present);
  }

  void report(MetricSink& sink) const override {
    if (routed_.empty()) {
      const Measure absent = absentMeasure(travel_.vehicles() == 0 ? kNoCbv : kNoRoute);
      for (const MeasureDefinition* each :
           {&known::kCbvStanding, &kFreeStandPerKm, &kFreeStandShare})
        sink.set(*each, absent);
      return;
    }
    sink.set(known::kCbvStanding, {static_cast<double>(standing_.size()), routed_.size(), {}, {}});
    sink.set(kFreeStandPerKm,
             collisionsPerKilometer(standing_.size(), travel_.distance(), travel_.vehicles()));
    sink.set(kFreeStandShare,
             {100.0 * static_cast<double>(standing_decisions_) / static_cast<double>(decisions_),
              decisions_,
              {},
              {}});
  }

 private:
  static const map::Route* routeOf(const traffic::Vehicle& vehicle, const MetricTick& tick) {
    if (tick.selection == nullptr) return nullptr;
    for (const cbv::CbvAssignment& assignment : tick.selection->assignments) {
      if (assignment.vehicle_id != vehicle.id) continue;
      return assignment.conflict_aware_route.empty() ? nullptr : &assignment.conflict_aware_route;
    }
    return nullptr;
  }

  void observeCbv(const traffic::Vehicle& vehicle, const MetricTick& tick, Stand& stand) {
    const map::Route* route = routeOf(vehicle, tick);
    if (route != nullptr) {
      ++decisions_;
      routed_.insert(vehicle.id);
    }
    const bool stands = route != nullptr && vehicle.state.speed < kStandingSpeed &&
                        isRoadFree(vehicle, *route, tick.snapshot);
    if (!stands) {
      stand = {};
      return;
    }
    if (stand.decisions == 0) stand.since = tick.snapshot.time;
    ++stand.decisions;
    if (stand.long_enough) {
      ++standing_decisions_;
    } else if (tick.snapshot.time - stand.since > kLongestStand + kStandTolerance) {
      stand.long_enough = true;
      standing_.insert(vehicle.id);
      standing_decisions_ += stand.decisions;
    }
  }

  CbvTravel travel_;
  std::map<std::string, Stand> stands_;
  std::set<std::string> routed_;    ///< CBVs that had a route
  std::set<std::string> standing_;  ///< CBVs that stood for too long
  std::size_t decisions_ = 0;       ///< of CBVs with a route
  std::size_t standing_decisions_ = 0;
};

}  // namespace

MetricDescriptor cbvStandingMetric() {
  return {"cbv_standing",
          "CBVs that stand although their road is free.",
          {known::kCbvStanding, kFreeStandPerKm, kFreeStandShare},
          [](const MetricContext&) { return std::make_unique<CbvStanding>(); }};
}

}  // namespace cdiff::metrics
