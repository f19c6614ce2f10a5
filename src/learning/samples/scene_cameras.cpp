// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_cameras.h"

#include <stdexcept>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {

SceneCameras::World::World(const Scene& scene, const rendering::CameraRig& rig)
    : network(map::RoadNetwork::fromText(scene.network_text, scene.network_source)),
      renderer(rig, network) {}

SceneCameras::SceneCameras(const rendering::CameraRig& rig) : rig_(rig) { rig_.validate(); }

void SceneCameras::open(const Scene& scene) {
  std::unique_ptr<World>& world = worlds_[core::sha256(scene.network_text)];
  if (!world) world = std::make_unique<World>(scene, rig_);
  scene_ = &scene;
  world_ = world.get();
}

SceneCameras::World& SceneCameras::opened() const {
  if (world_ != nullptr) return *world_;
  throw std::logic_error("images were asked for before a scene was opened");
}

const traffic::TrafficSnapshot& SceneCameras::decisionOf(std::size_t index) const {
  opened();
  if (index < scene_->decisions.size()) return scene_->decisions[index];
  throw core::InputError(
      "scene '" + scene_->name + "' has " + std::to_string(scene_->decisions.size()) +
      " decisions; the images of decision " + std::to_string(index) + " were asked for");
}

std::vector<rendering::RenderedView> SceneCameras::render(std::size_t decision,
                                                          const std::string& vehicle_id,
                                                          rendering::Labels labels) {
  const traffic::Vehicle* vehicle = decisionOf(decision).find(vehicle_id);
  if (vehicle != nullptr) return render(decision, *vehicle, labels);
  throw core::InputError("scene '" + scene_->name + "', decision " + std::to_string(decision) +
                         ": no vehicle '" + vehicle_id + "', whose images were asked for");
}

std::vector<rendering::RenderedView> SceneCameras::render(std::size_t decision,
                                                          const traffic::Vehicle& vehicle,
                                                          rendering::Labels labels) {
  return opened().renderer.render(decisionOf(decision), vehicle, labels);
}

}  // namespace cdiff::learning
