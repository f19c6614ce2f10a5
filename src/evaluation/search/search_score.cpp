// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search_score.h"

#include <algorithm>

#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

constexpr double kHalfSpeed = 10.0;    // [m/s]
constexpr double kHalfTime = 1.0;      // [s]
constexpr double kHalfDistance = 5.0;  // [m]

double contactScore(const RunContact& contact) {
  const double speed = std::max(contact.ego_speed, contact.other_speed);
  return (contact.ego_at_fault ? 2.0 : 1.0) + speed / (speed + kHalfSpeed);
}

/// 1 at zero, 1/2 at `half`; 0 for a measure that the session does not have.
double nearness(const RunRecord& record, const std::string& measure, double half) {
  const auto found = record.measures.find(measure);
  return found == record.measures.end() ? 0.0 : half / (half + std::max(0.0, found->second));
}

}  // namespace

SearchScore searchScoreOf(const RunRecord& record, const std::vector<RunContact>& contacts) {
  SearchScore score;
  if (!record.complete()) return score;
  for (const RunContact& contact : contacts) {
    const double value = contactScore(contact);
    if (contact.egoStood() || value <= score.value) continue;
    score.value = value;
    score.contact = contact;
  }
  if (score.contact) return score;
  // Boxes that touch a standing ego have a 2D-TTC of 0 and must stay below any contact.
  constexpr double kBelowContact = 0.999;
  const double near = nearness(record, metrics::known::kTtcMinimum.name, kHalfTime) +
                      nearness(record, metrics::known::kCbvMinimumDistance.name, kHalfDistance);
  score.value = std::min(kBelowContact, near / 2.0);
  return score;
}

}  // namespace cdiff::evaluation
