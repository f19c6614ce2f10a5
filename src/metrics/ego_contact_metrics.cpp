// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cstddef>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kEgoCollisions = {
    "ego_collisions",
    "/ego/collisions",
    "Collisions of the ego",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Contacts of the ego's box with any other vehicle's box on the same level; who touches it "
    "leaves at the next tick.",
    "",
    0,
    true,
};
const MeasureDefinition known::kContactsAtFault = {
    "ego_contacts_at_fault",
    "/ego/contacts_at_fault",
    "Contacts that are the ego's fault",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Contacts in which the ego strikes the other, by their motion at first touch; a standing ego "
    "is "
    "never at fault (docs/protocols.md).",
    "",
    0,
};

namespace {

class EgoCollisions final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    for (const ContactSighting& contact : tick.contacts) {
      if (!contact.ego_partner.empty()) ++contacts_;
    }
    for (const EgoContact& contact : tick.ego_contacts) {
      if (contact.ego_at_fault) ++at_fault_;
    }
  }
  void report(MetricSink& sink) const override {
    sink.set(known::kEgoCollisions, countMeasure(contacts_));
    sink.set(known::kContactsAtFault, countMeasure(at_fault_));
  }

 private:
  std::size_t contacts_ = 0;
  std::size_t at_fault_ = 0;
};

}  // namespace

MetricDescriptor egoCollisionsMetric() {
  return {"ego_collisions",
          "Contacts of the ego, and those that are its fault.",
          {known::kEgoCollisions, known::kContactsAtFault},
          [](const MetricContext&) { return std::make_unique<EgoCollisions>(); }};
}

namespace {

/// Events in batches: over the km of the ego, whoever else takes part.
constexpr PoolingRule kOverEgoKilometers = {Pooling::kCount, SessionWeight::kEgoKilometres};
constexpr PoolingRule kPerEgoKilometer = {Pooling::kRate, SessionWeight::kEgoKilometres};

}  // namespace

const MeasureDefinition known::kEgoStruckCbvs = {
    "ego_contacts_struck_cbv",
    "/ego/struck_cbvs",
    "Contacts in which the ego struck a CBV",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgoAndOthers,
    "Contacts of the ego with a CBV that are the ego's fault (docs/protocols.md).",
    "",
    0,
    false,
    kOverEgoKilometers,
};
const MeasureDefinition known::kEgoStruckByCbvs = {
    "ego_contacts_by_cbv",
    "/ego/struck_by_cbvs",
    "Contacts in which a CBV struck the ego",
    "count",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Contacts of the ego with a CBV that are the CBV's fault (docs/protocols.md).",
    "",
    0,
    false,
    kOverEgoKilometers,
};
const MeasureDefinition known::kEgoStruckStanding = {
    "ego_contacts_standing",
    "/ego/struck_standing",
    "Contacts with a standing ego",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgoAndOthers,
    "Contacts of the ego, with anyone, at whose first tick it is slower than the protocol's "
    "collision_minimum_speed (0.1 m/s).",
    "",
    0,
    false,
    kOverEgoKilometers,
};
const MeasureDefinition known::kEgoBrakingAvoids = {
    "ego_contacts_braking_avoids",
    "/ego/contacts_braking_avoids",
    "Contacts that braking alone avoids",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Contacts of the ego, whoever's fault, that braking at 6 m/s^2 from 0.5 s after the other's "
    "box "
    "came into its swept path would have prevented, on the path that it drove (docs/metrics.md).",
    "",
    0,
    false,
    kOverEgoKilometers,
};

namespace {

constexpr MeasureDefinition kEgoStruckBackground = {
    "ego_contacts_struck_background",
    "/ego/struck_background",
    "Contacts in which the ego struck a background vehicle",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgoAndOthers,
    "Contacts of the ego with a background vehicle that are the ego's fault (docs/protocols.md).",
    "",
    0,
    false,
    kOverEgoKilometers,
};
constexpr MeasureDefinition kEgoByBackground = {
    "ego_contacts_by_background",
    "/ego/struck_by_background",
    "Contacts in which a background vehicle struck the ego",
    "count",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Contacts of the ego with a background vehicle that are that vehicle's fault "
    "(docs/protocols.md).",
    "",
    0,
    false,
    kOverEgoKilometers,
};

/// Of a count by the ego's km.
constexpr MeasureDefinition egoRate(const char* name, const char* place, const char* label,
                                    Direction direction, const char* definition) {
  return {name,       place, label, "1/km", direction,       Subject::kEgoAndOthers,
          definition, "",    3,     false,  kPerEgoKilometer};
}

constexpr MeasureDefinition kContactsPerKm = egoRate(
    "ego_collisions_per_km", "/ego/collisions_per_km", "Collisions of the ego per km",
    Direction::kLowerIsBetter, "1000 x ego_collisions / distance driven by the ego in meters.");
constexpr MeasureDefinition kStruckCbvsPerKm =
    egoRate("ego_contacts_struck_cbv_per_km", "/ego/struck_cbvs_per_km",
            "Contacts in which the ego struck a CBV, per km", Direction::kLowerIsBetter,
            "1000 x ego_contacts_struck_cbv / distance driven by the ego in meters.");
constexpr MeasureDefinition kByCbvsPerKm =
    egoRate("ego_contacts_by_cbv_per_km", "/ego/struck_by_cbvs_per_km",
            "Contacts in which a CBV struck the ego, per km", Direction::kNeither,
            "1000 x ego_contacts_by_cbv / distance driven by the ego in meters.");
constexpr MeasureDefinition kEgoStruckBackgroundPerKm = egoRate(
    "ego_contacts_struck_background_per_km", "/ego/struck_background_per_km",
    "Contacts in which the ego struck a background vehicle, per km", Direction::kLowerIsBetter,
    "1000 x ego_contacts_struck_background / distance driven by the ego in meters.");
constexpr MeasureDefinition kEgoByBackgroundPerKm =
    egoRate("ego_contacts_by_background_per_km", "/ego/struck_by_background_per_km",
            "Contacts in which a background vehicle struck the ego, per km", Direction::kNeither,
            "1000 x ego_contacts_by_background / distance driven by the ego in meters.");
constexpr MeasureDefinition kEgoStandingPerKm =
    egoRate("ego_contacts_standing_per_km", "/ego/struck_standing_per_km",
            "Contacts with a standing ego per km", Direction::kLowerIsBetter,
            "1000 x ego_contacts_standing / distance driven by the ego in meters.");
constexpr MeasureDefinition kBrakingAvoidsPerKm =
    egoRate("ego_contacts_braking_avoids_per_km", "/ego/contacts_braking_avoids_per_km",
            "Contacts that braking alone avoids, per km", Direction::kLowerIsBetter,
            "1000 x ego_contacts_braking_avoids / distance driven by the ego in meters.");

/// Who struck whom in the contacts of the ego, and how many of them it could have helped.
class EgoContactKinds final : public Metric {
 public:
  explicit EgoContactKinds(double standing_speed) : standing_speed_(standing_speed) {}

  void observe(const MetricTick& tick) override {
    if (tick.ego != nullptr) travel(*tick.ego);
    for (const ContactSighting& contact : tick.contacts) count(contact);
    for (const EgoContact& contact : tick.ego_contacts) {
      if (contact.ego_speed < standing_speed_) ++standing_;
      if (contact.braking_avoids) ++braking_avoids_;
    }
  }

  void report(MetricSink& sink) const override {
    sink.set(kContactsPerKm, rate(contacts_));
    set(sink, known::kEgoStruckCbvs, kStruckCbvsPerKm, struck_cbvs_);
    set(sink, known::kEgoStruckByCbvs, kByCbvsPerKm, by_cbvs_);
    set(sink, kEgoStruckBackground, kEgoStruckBackgroundPerKm, struck_background_);
    set(sink, kEgoByBackground, kEgoByBackgroundPerKm, by_background_);
    set(sink, known::kEgoStruckStanding, kEgoStandingPerKm, standing_);
    set(sink, known::kEgoBrakingAvoids, kBrakingAvoidsPerKm, braking_avoids_);
  }

 private:
  void travel(const traffic::Vehicle& ego) {
    if (!ego.state.position.allFinite()) return;
    ++ticks_;
    if (last_) distance_ += (ego.state.position - *last_).norm();
    last_ = ego.state.position;
  }

  void count(const ContactSighting& contact) {
    if (contact.ego_partner.empty()) return;
    ++contacts_;
    if (contact.striker.empty()) return;
    const bool by_other = contact.striker == contact.ego_partner;
    const bool cbv = !contact.cbvs.empty();
    if (by_other) ++(cbv ? by_cbvs_ : by_background_);
    if (!by_other) ++(cbv ? struck_cbvs_ : struck_background_);
  }

  Measure rate(std::size_t count) const {
    return countPerKilometer(count, distance_, ticks_,
                             ticks_ == 0 ? kNoEgo : "the ego did not move");
  }
  void set(MetricSink& sink, const MeasureDefinition& counted, const MeasureDefinition& per_km,
           std::size_t count) const {
    sink.set(counted, countMeasure(count));
    sink.set(per_km, rate(count));
  }

  double standing_speed_;
  std::optional<Eigen::Vector2d> last_;
  double distance_ = 0.0;
  std::size_t ticks_ = 0;
  std::size_t contacts_ = 0;
  std::size_t struck_cbvs_ = 0;
  std::size_t by_cbvs_ = 0;
  std::size_t struck_background_ = 0;
  std::size_t by_background_ = 0;
  std::size_t standing_ = 0;
  std::size_t braking_avoids_ = 0;
};

}  // namespace

MetricDescriptor egoContactsMetric() {
  return {"ego_contacts",
          "Who struck whom in the ego's contacts, with the ego standing, and what braking alone "
          "avoids.",
          {kContactsPerKm, known::kEgoStruckCbvs, kStruckCbvsPerKm, known::kEgoStruckByCbvs,
           kByCbvsPerKm, kEgoStruckBackground, kEgoStruckBackgroundPerKm, kEgoByBackground,
           kEgoByBackgroundPerKm, known::kEgoStruckStanding, kEgoStandingPerKm,
           known::kEgoBrakingAvoids, kBrakingAvoidsPerKm},
          [](const MetricContext& context) {
            return std::make_unique<EgoContactKinds>(
                context.options.infractions.collision_minimum_speed);
          }};
}

}  // namespace cdiff::metrics
