// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "rendering/rig_renderer.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::session {

/// The cameras of the vehicles that a session drives: renders what the rig of a slot's vehicle
/// sees. One per thread.
class VehicleCameras {
 public:
  /// With the rigs of the setup.
  explicit VehicleCameras(const SessionSetup& setup) : VehicleCameras(setup, setup.rigs()) {}
  /// With other rigs for the setup's network.
  VehicleCameras(const SessionSetup& setup, const VehicleRigs& rigs);

  const VehicleRigs& rigs() const { return rigs_; }
  /// Appends an image per camera of the slot's rig, in its order. `slot`: that of a CBV, or
  /// traffic::kEgoSlot.
  void render(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle, int slot,
              std::vector<SlotImage>& images);

 private:
  VehicleRigs rigs_;
  std::vector<rendering::RigRenderer> renderers_;  ///< by VehicleRigs::indexOf
};

/// Gives each task the images of its slot, and the rig that they are of; what did not come stays
/// nullptr. Tasks without any image stay without rig.
void attachImages(const std::vector<SlotImage>& images, const VehicleRigs& rigs,
                  std::vector<planning::PlanningTask>& tasks);

}  // namespace cdiff::session
