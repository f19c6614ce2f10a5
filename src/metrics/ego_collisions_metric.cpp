// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/sample_statistics.h"

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
    "Of the ego's contacts, those in which it strikes the other, by their motion at first touch; a "
    "standing ego is never at fault (docs/protocols.md).",
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

}  // namespace cdiff::metrics
