// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/worst_moments.h"

#include <algorithm>
#include <tuple>

#include "core/text.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

/// A moment with what it is ranked by: the smaller tuple is the worse moment.
struct RankedMoment {
  WorstMoment moment;
  /// No contact, the ego stood, no fault, - speed [m/s] or distance [m].
  std::tuple<bool, bool, bool, double> rank;
};

RankedMoment contactMoment(std::size_t run, const RunContact& contact) {
  const std::string fault = contact.ego_at_fault ? " (the ego's fault): " : " (not its fault): ";
  return {{run, contact.seconds,
           "contact of the ego with " + contact.partnerText() + fault + contact.why},
          {false, contact.egoStood(), !contact.ego_at_fault,
           -std::max(contact.ego_speed, contact.other_speed)}};
}

std::optional<RankedMoment> approachMoment(std::size_t index, const RunRecord& record) {
  const auto found = record.measures.find(metrics::known::kCbvMinimumDistance.name);
  if (found == record.measures.end()) return std::nullopt;
  return RankedMoment{{index, std::nullopt,
                       "no contact; nearest CBV " + core::formatFixed(found->second, 1) +
                           " m away between centers"},
                      {true, true, true, found->second}};
}

}  // namespace

std::vector<WorstMoment> worstMoments(const std::vector<BatchRun>& runs, std::size_t most) {
  std::vector<RankedMoment> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const RunContact& contact : runs[i].contacts) all.push_back(contactMoment(i, contact));
    if (!runs[i].contacts.empty()) continue;
    if (auto approach = approachMoment(i, runs[i].record)) all.push_back(std::move(*approach));
  }
  std::stable_sort(all.begin(), all.end(), [](const RankedMoment& left, const RankedMoment& right) {
    return left.rank < right.rank;
  });
  std::vector<WorstMoment> worst;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    worst.push_back(std::move(all[i].moment));
  return worst;
}

}  // namespace cdiff::evaluation
