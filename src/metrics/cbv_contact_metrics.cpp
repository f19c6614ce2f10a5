// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

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
const MeasureDefinition known::kCbvMovingEgoCollisions = {
    "cbv_moving_ego_collisions",
    "/cbv/collisions_with_moving_ego",
    "Collisions of CBVs with the moving ego",
    "count",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Those collisions of CBVs with the ego at whose first tick the ego is not slower than the "
    "protocol's collision_minimum_speed (0.1 m/s).",
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
    "1000 x collisions of CBVs with anyone / distance driven as CBV in meters; n counts CBVs "
    "(paper's CPK: lower is better in naturalistic mode, higher in safety-critical mode).",
    "RIFT divides collided CBVs by the distance summed over decision ticks.",
    3,
    true,
};
const MeasureDefinition known::kCbvEgoCollisionsPerKm = {
    "cbv_ego_collisions_per_km",
    "/cbv/collisions_with_ego_per_km",
    "Collisions of CBVs with the ego per km",
    "1/km",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "1000 x collisions of CBVs with the ego / distance driven as CBV in meters; n counts CBVs.",
    "RIFT does not record the partner.",
};

namespace {

/// Contacts of CBVs with anyone and with the ego alone; a contact of two CBVs counts once.
class CbvCollisions final : public Metric {
 public:
  explicit CbvCollisions(double standing_speed) : standing_speed_(standing_speed) {}

  void observe(const MetricTick& tick) override {
    const bool moving = tick.ego != nullptr && tick.ego->state.speed >= standing_speed_;
    for (const ContactSighting& contact : tick.contacts) {
      if (contact.cbvs.empty()) continue;
      ++collisions_;
      if (contact.ego_partner.empty()) continue;
      ++ego_collisions_;
      if (moving) ++moving_ego_collisions_;
    }
    travel_.observe(tick);
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kCbvCollisions, countMeasure(collisions_));
    sink.set(known::kCbvEgoCollisions, countMeasure(ego_collisions_));
    sink.set(known::kCbvMovingEgoCollisions, countMeasure(moving_ego_collisions_));
    sink.set(known::kCollisionsPerKm,
             collisionsPerKilometer(collisions_, travel_.distance(), travel_.vehicles()));
    sink.set(known::kCbvEgoCollisionsPerKm,
             collisionsPerKilometer(ego_collisions_, travel_.distance(), travel_.vehicles()));
  }

 private:
  double standing_speed_;  ///< [m/s]
  CbvTravel travel_;
  std::size_t collisions_ = 0;
  std::size_t ego_collisions_ = 0;
  std::size_t moving_ego_collisions_ = 0;
};

}  // namespace

MetricDescriptor cbvCollisionsMetric() {
  return {
      "cbv_collisions",
      "Collisions of CBVs, as counts and per kilometer.",
      {known::kCbvCollisions, known::kCbvEgoCollisions, known::kCbvMovingEgoCollisions,
       known::kCollisionsPerKm, known::kCbvEgoCollisionsPerKm},
      [](const MetricContext& context) {
        return std::make_unique<CbvCollisions>(context.options.infractions.collision_minimum_speed);
      }};
}

namespace {

constexpr MeasureDefinition kCbvStruckBackground = {
    "cbv_contacts_struck_background",
    "/cbv/struck_background",
    "Contacts in which a CBV struck a background vehicle",
    "count",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Contacts of a CBV with a background vehicle that are the CBV's fault: the rule for the ego's "
    "contacts with the CBV in the ego's place (docs/protocols.md).",
    "RIFT does not record who struck whom.",
    0,
};
constexpr MeasureDefinition kCbvByBackground = {
    "cbv_contacts_by_background",
    "/cbv/struck_by_background",
    "Contacts in which a background vehicle struck a CBV",
    "count",
    Direction::kNeither,
    Subject::kCbvs,
    "Contacts of a CBV with a background vehicle that are that vehicle's fault, by the same rule.",
    "RIFT does not record who struck whom.",
    0,
};
constexpr MeasureDefinition kCbvWithCbv = {
    "cbv_contacts_with_cbv",
    "/cbv/contacts_with_cbvs",
    "Contacts of two CBVs",
    "count",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "Contacts of a CBV with another CBV, each once.",
    "RIFT counts one for each of the two.",
    0,
};
constexpr MeasureDefinition kCbvStruckBackgroundPerKm = {
    "cbv_contacts_struck_background_per_km",
    "/cbv/struck_background_per_km",
    "Contacts in which a CBV struck a background vehicle, per km",
    "1/km",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "1000 x cbv_contacts_struck_background / distance driven as CBV in meters; n counts CBVs.",
    "RIFT does not record who struck whom.",
};
constexpr MeasureDefinition kCbvByBackgroundPerKm = {
    "cbv_contacts_by_background_per_km",
    "/cbv/struck_by_background_per_km",
    "Contacts in which a background vehicle struck a CBV, per km",
    "1/km",
    Direction::kNeither,
    Subject::kCbvs,
    "1000 x cbv_contacts_by_background / distance driven as CBV in meters; n counts CBVs.",
    "RIFT does not record who struck whom.",
};
constexpr MeasureDefinition kCbvWithCbvPerKm = {
    "cbv_contacts_with_cbv_per_km",
    "/cbv/contacts_with_cbvs_per_km",
    "Contacts of two CBVs per km",
    "1/km",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "1000 x cbv_contacts_with_cbv / distance driven as CBV in meters; n counts CBVs.",
    "RIFT counts one for each of the two.",
};

/// Contacts of CBVs without the ego.
class CbvContactKinds final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    travel_.observe(tick);
    for (const ContactSighting& contact : tick.contacts) {
      if (contact.cbvs.empty() || !contact.ego_partner.empty()) continue;
      if (contact.cbvs.size() == 2) {
        ++with_cbv_;
      } else if (!contact.striker.empty()) {
        ++(contact.striker == contact.cbvs.front() ? struck_background_ : by_background_);
      }
    }
  }
  void report(MetricSink& sink) const override {
    set(sink, kCbvStruckBackground, kCbvStruckBackgroundPerKm, struck_background_);
    set(sink, kCbvByBackground, kCbvByBackgroundPerKm, by_background_);
    set(sink, kCbvWithCbv, kCbvWithCbvPerKm, with_cbv_);
  }

 private:
  void set(MetricSink& sink, const MeasureDefinition& counted, const MeasureDefinition& per_km,
           std::size_t count) const {
    sink.set(counted, countMeasure(count));
    sink.set(per_km, collisionsPerKilometer(count, travel_.distance(), travel_.vehicles()));
  }

  CbvTravel travel_;
  std::size_t struck_background_ = 0;
  std::size_t by_background_ = 0;
  std::size_t with_cbv_ = 0;
};

}  // namespace

MetricDescriptor cbvContactsMetric() {
  return {"cbv_contacts",
          "Who struck whom in the contacts of CBVs without the ego.",
          {kCbvStruckBackground, kCbvStruckBackgroundPerKm, kCbvByBackground, kCbvByBackgroundPerKm,
           kCbvWithCbv, kCbvWithCbvPerKm},
          [](const MetricContext&) { return std::make_unique<CbvContactKinds>(); }};
}

}  // namespace cdiff::metrics
