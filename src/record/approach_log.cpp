// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/approach_log.h"

#include <cmath>

#include "record/image_data_uri.h"

namespace cdiff::record {

void ApproachLog::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  if (record.selection != nullptr) images_.clear();  // a decision
  if (record.images != nullptr) images_ = *record.images;
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role == traffic::VehicleRole::kCbv) compare(snapshot, *ego, vehicle);
  }
}

const Approach* ApproachLog::find(const std::string& vehicle_id) const {
  const auto found = index_by_id_.find(vehicle_id);
  return found == index_by_id_.end() ? nullptr : &approaches_[found->second];
}

void ApproachLog::compare(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
                          const traffic::Vehicle& cbv) {
  if (traffic::onDifferentLevels(ego, cbv)) return;
  const double gap = geometry::distance(ego.box(), cbv.box());
  if (!std::isfinite(gap)) return;
  const auto [known, added] = index_by_id_.emplace(cbv.id, approaches_.size());
  if (added) approaches_.emplace_back();
  Approach& best = approaches_[known->second];
  if (!added && best.gap <= gap) return;
  best.vehicle_id = cbv.id;
  best.gap = gap;
  best.center_distance = (ego.state.position - cbv.state.position).norm();
  best.snapshot = snapshot;
  best.cbv_image = imageOf(cbv.cbv_slot);
  best.ego_image = imageOf(-1);
}

traffic::CameraImage ApproachLog::imageOf(int slot) const {
  for (const session::SlotImage& seen : images_) {
    if (seen.slot == slot && isWhole(seen.image)) return seen.image;
  }
  return {};
}

}  // namespace cdiff::record
