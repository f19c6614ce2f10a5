// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/collisions_per_km.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kCbvCollisions = {
    "cbv_collisions",
    "/cbv/collisions",
    "Collisions of CBVs",
    "count",
    Direction::kNeither,
    Subject::kCbvs,
    "Contacts of a CBV's box with any other vehicle's box on the same level; a contact of two CBVs "
    "counts once.",
    "RIFT counts at most one collision per CBV, and one for each of two CBVs that collide.",
    0,
};
const MeasureDefinition known::kCbvEgoCollisions = {
    "cbv_ego_collisions",
    "/cbv/collisions_with_ego",
    "Collisions of CBVs with the ego",
    "count",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Those collisions of CBVs whose other vehicle is the ego.",
    "",
    0,
};
const MeasureDefinition known::kCollisionsPerKm = {
    "cbv_collisions_per_km",
    "/cbv/collisions_per_km",
    "Collisions of CBVs per km (CPK)",
    "1/km",
    Direction::kNeither,
    Subject::kCbvs,
    "1000 x collisions of CBVs with anyone / distance driven as CBV in metres; n counts CBVs "
    "(paper's CPK: lower is better in naturalistic mode, higher in safety-critical mode).",
    "RIFT divides collided CBVs by the distance summed over decision ticks.",
    3,
    true,
};

namespace {

constexpr MeasureDefinition kEgoCollisionsPerKm = {
    "cbv_ego_collisions_per_km",
    "/cbv/collisions_with_ego_per_km",
    "Collisions of CBVs with the ego per km",
    "1/km",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "1000 x collisions of CBVs with the ego / distance driven as CBV in metres; n counts CBVs.",
    "RIFT does not record the partner.",
};

/// Contacts of CBVs with anyone and with the ego alone; a contact of two CBVs counts once.
class CbvCollisions final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const ContactSighting& contact : tick.contacts) {
      if (contact.cbvs.empty()) continue;
      ++collisions_;
      if (!contact.ego_partner.empty()) ++ego_collisions_;
    }
    travel_.observe(tick);
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvCollisions, countMeasure(collisions_));
    sink.set(known::kCbvEgoCollisions, countMeasure(ego_collisions_));
    sink.set(known::kCollisionsPerKm,
             collisionsPerKilometre(collisions_, travel_.distance(), travel_.vehicles()));
    sink.set(kEgoCollisionsPerKm,
             collisionsPerKilometre(ego_collisions_, travel_.distance(), travel_.vehicles()));
  }

 private:
  CbvTravel travel_;
  std::size_t collisions_ = 0;
  std::size_t ego_collisions_ = 0;
};

}  // namespace

MetricDescriptor cbvCollisionsMetric() {
  return {"cbv_collisions",
          "Collisions of CBVs, as counts and per kilometre.",
          {known::kCbvCollisions, known::kCbvEgoCollisions, known::kCollisionsPerKm,
           kEgoCollisionsPerKm},
          [](const MetricContext&) { return std::make_unique<CbvCollisions>(); }};
}

}  // namespace cdiff::metrics
