// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/cbv_log.h"

namespace cdiff::report {
namespace {

CbvRecord newRecord(const cbv::CbvAssignment& assignment) {
  CbvRecord record;
  record.slot = assignment.slot;
  record.vehicle_id = assignment.vehicle_id;
  record.selected_tick = assignment.selected_tick;
  record.interaction_score = assignment.interaction_score;
  record.conflict_point = assignment.conflict_point;
  record.route_length = assignment.conflict_aware_route.length();
  record.route = assignment.conflict_aware_route.path().points();
  return record;
}

bool sameStay(const CbvRecord& record, const cbv::CbvAssignment& assignment) {
  return record.vehicle_id == assignment.vehicle_id &&
         record.selected_tick == assignment.selected_tick;
}

}  // namespace

void CbvLog::observe(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection) {
  close(selection);
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    CbvRecord& record = recordOf(assignment);
    const traffic::Vehicle* vehicle = snapshot.find(assignment.vehicle_id);
    const bool driven = vehicle != nullptr && vehicle->role == traffic::VehicleRole::kCbv;
    if (driven) ++record.decisions_driven;
  }
  for (const cbv::RejectedCandidate& candidate : selection.rejected) ++rejected_[candidate.reason];
}

CbvRecord& CbvLog::recordOf(const cbv::CbvAssignment& assignment) {
  const auto known = open_.find(assignment.slot);
  if (known != open_.end()) return records_[known->second];
  open_[assignment.slot] = records_.size();
  records_.push_back(newRecord(assignment));
  return records_.back();
}

void CbvLog::close(const cbv::CbvSelection& selection) {
  for (auto slot = open_.begin(); slot != open_.end();) {
    CbvRecord& record = records_[slot->second];
    const cbv::CbvAssignment* assignment = selection.find(slot->first);
    if (assignment != nullptr && sameStay(record, *assignment)) {
      ++slot;
      continue;
    }
    record.released_tick = selection.tick;
    record.release_reason = "not_stated";
    for (const cbv::ReleasedCbv& released : selection.released) {
      const bool same = released.slot == record.slot && released.vehicle_id == record.vehicle_id;
      if (same) record.release_reason = released.reason;
    }
    slot = open_.erase(slot);
  }
}

}  // namespace cdiff::report
