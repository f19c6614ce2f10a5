// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/contact_counts.h"

#include <algorithm>

#include "core/text.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {

ContactCounts& ContactCounts::operator+=(const ContactCounts& other) {
  all += other.all;
  with_cbvs += other.with_cbvs;
  standing += other.standing;
  return *this;
}

ContactCounts contactCountsOf(const RunRecord& record) {
  const auto count = [&](const metrics::MeasureDefinition& measure) {
    const auto found = record.measures.find(measure.name);
    return found == record.measures.end() ? 0.0 : found->second;
  };
  namespace known = metrics::known;
  ContactCounts counts;
  counts.with_cbvs = count(known::kCbvEgoCollisions);
  counts.all = std::max(count(known::kEgoCollisions), counts.with_cbvs);
  counts.standing = count(known::kEgoStruckStanding);
  return counts;
}

std::string kindsText(const ContactCounts& counts) {
  if (counts.all == 0.0) return "";
  const auto number = [](double count) { return core::formatFixed(count, 0); };
  return number(counts.with_cbvs) + " with CBVs + " + number(counts.withBackground()) +
         " with background" +
         (counts.standing == 0.0 ? "" : ", " + number(counts.standing) + " with the ego standing");
}

}  // namespace cdiff::evaluation
