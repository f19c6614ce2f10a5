// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/vehicle_cameras.h"

#include <algorithm>

namespace cdiff::session {

VehicleCameras::VehicleCameras(const SessionSetup& setup, const VehicleRigs& rigs) : rigs_(rigs) {
  for (const rendering::CameraRig& rig : rigs_.all()) {
    if (renderers_.empty()) {
      renderers_.emplace_back(rig, setup.network());
    } else {
      renderers_.emplace_back(rig, renderers_.front());
    }
  }
}

void VehicleCameras::render(const traffic::TrafficSnapshot& snapshot,
                            const traffic::Vehicle& vehicle, int slot,
                            std::vector<SlotImage>& images) {
  rendering::RigRenderer& renderer = renderers_[rigs_.indexOf(slot)];
  std::vector<rendering::RenderedView> views = renderer.render(snapshot, vehicle);
  for (std::size_t i = 0; i < views.size(); ++i)
    images.push_back({slot, std::move(views[i].image), renderer.rig().cameras[i].name});
}

void attachImages(const std::vector<SlotImage>& images, const VehicleRigs& rigs,
                  std::vector<planning::PlanningTask>& tasks) {
  for (planning::PlanningTask& task : tasks) {
    const rendering::CameraRig& rig = rigs.of(task.slot);
    planning::CameraViews views{&rig, std::vector<const traffic::CameraImage*>(rig.cameras.size())};
    bool any = false;
    for (const SlotImage& seen : images) {
      const rendering::RigCamera* camera = seen.slot == task.slot ? rig.find(seen.camera) : nullptr;
      if (camera == nullptr) continue;
      views.images[static_cast<std::size_t>(camera - rig.cameras.data())] = &seen.image;
      any = true;
    }
    if (any) task.views = std::move(views);
  }
}

}  // namespace cdiff::session
