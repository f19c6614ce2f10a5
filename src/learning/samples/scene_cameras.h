// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "learning/samples/scene.h"
#include "rendering/rig_renderer.h"

namespace cdiff::learning {

/// Renders again what the cameras of a vehicle saw at the decisions of stored scenes: the bytes
/// that the session had, for any rig, with labels where asked. One per thread; the shapes of a
/// network are made once for all scenes on it.
class SceneCameras {
 public:
  /// Throws InputError for a rig that CameraRig::validate refuses.
  explicit SceneCameras(const rendering::CameraRig& rig);

  /// The scene whose decisions are rendered from now on; it must outlive that. Throws InputError
  /// for a network that cannot be read.
  void open(const Scene& scene);
  /// One view per camera of the rig, of what the vehicle saw. The labels' instances are numbered by
  /// the vehicles of the scene's decision. Throws InputError naming scene, decision and vehicle
  /// where there is none with this id.
  std::vector<rendering::RenderedView> render(std::size_t decision, const std::string& vehicle_id,
                                              rendering::Labels labels = rendering::Labels::kNone);
  /// The same from another place: `vehicle` is a copy of one of the decision's that was moved.
  std::vector<rendering::RenderedView> render(std::size_t decision, const traffic::Vehicle& vehicle,
                                              rendering::Labels labels = rendering::Labels::kNone);

  /// Of the scene that is open.
  const map::RoadNetwork& network() const { return opened().network; }
  const rendering::CameraRig& rig() const { return rig_; }

 private:
  /// A network and what its shapes look like.
  struct World {
    World(const Scene& scene, const rendering::CameraRig& rig);
    map::RoadNetwork network;
    rendering::RigRenderer renderer;
  };
  World& opened() const;
  const traffic::TrafficSnapshot& decisionOf(std::size_t index) const;

  rendering::CameraRig rig_;
  std::map<std::string, std::unique_ptr<World>> worlds_;  ///< by SHA-256 of the network's text
  const Scene* scene_ = nullptr;
  World* world_ = nullptr;  ///< of the scene
};

}  // namespace cdiff::learning
