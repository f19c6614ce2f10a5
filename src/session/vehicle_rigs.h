// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <vector>

#include "e2e_cdiff/rendering/camera_rig.h"
#include "session/scenario_options.h"

namespace cdiff::session {

/// The cameras of ego and CBVs in a session, by slot.
class VehicleRigs {
 public:
  /// The default front camera alone for every vehicle.
  VehicleRigs() = default;
  /// As the scenario says: the rigs that the planners name unless it sets others.
  explicit VehicleRigs(const ScenarioOptions& options);
  /// The front camera alone for every vehicle.
  static VehicleRigs front(const rendering::CameraOptions& camera);

  /// Of a CBV's slot, or of traffic::kEgoSlot. Stays where it is as long as this object does.
  const rendering::CameraRig& of(int slot) const { return rigs_[indexOf(slot)]; }
  /// The ego's, then those that the slots of CBVs have in turn.
  const std::vector<rendering::CameraRig>& all() const { return rigs_; }
  std::size_t indexOf(int slot) const;

 private:
  std::vector<rendering::CameraRig> rigs_ = {rendering::frontRig({}), rendering::frontRig({})};
};

}  // namespace cdiff::session
