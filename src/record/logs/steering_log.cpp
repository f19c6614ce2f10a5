// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/steering_log.h"

#include <algorithm>

namespace cdiff::record {

void SteeringLog::observe(const session::TickRecord& record) {
  for (const traffic::SteeringChange& change : record.snapshot->steering) {
    session::SteeringRecord entry{record.snapshot->tick, change, {}};
    if (change.what == traffic::steered::kChoose && record.selection != nullptr) {
      for (const cbv::RejectedCandidate& candidate : record.selection->rejected) {
        if (candidate.vehicle_id == change.after) entry.refused = candidate.reason;
      }
    }
    records_.push_back(std::move(entry));
  }
}

bool SteeringLog::byHand() const {
  return std::any_of(records_.begin(), records_.end(),
                     [](const session::SteeringRecord& record) { return record.byHand(); });
}

std::string steeringText(const session::SteeringRecord& record) {
  const auto& [by, what, before, after] = record.change;
  std::string text = what + " " + before;
  if (!before.empty() && !after.empty()) text += " -> ";
  text += after;
  return record.refused.empty() ? text : text + " (refused: " + record.refused + ")";
}

}  // namespace cdiff::record
