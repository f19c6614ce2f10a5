// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/hand_over_selector.h"

#include <algorithm>
#include <utility>

namespace cdiff::realism {

HandOverSelector::HandOverSelector(std::unique_ptr<cbv::VehicleSelector> inner, bool hands_over)
    : inner_(std::move(inner)), hands_over_(hands_over) {}

bool HandOverSelector::isFirst(const std::string& vehicle_id) const {
  return std::any_of(first_.begin(), first_.end(), [&](const cbv::CbvAssignment& assignment) {
    return assignment.vehicle_id == vehicle_id;
  });
}

cbv::CbvSelection HandOverSelector::update(const traffic::TrafficSnapshot& snapshot) {
  const cbv::CbvSelection all = inner_->update(snapshot);
  if (first_.empty()) first_ = all.assignments;
  cbv::CbvSelection kept;
  kept.tick = all.tick;
  if (!hands_over_) return kept;
  for (const cbv::CbvAssignment& assignment : all.assignments) {
    if (isFirst(assignment.vehicle_id)) kept.assignments.push_back(assignment);
  }
  for (const cbv::ReleasedCbv& released : all.released) {
    if (isFirst(released.vehicle_id)) kept.released.push_back(released);
  }
  return kept;
}

}  // namespace cdiff::realism
