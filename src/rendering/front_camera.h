// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "rendering/rig_renderer.h"

namespace cdiff::rendering {

/// The front view of a vehicle: a rig of one camera (RigRenderer). Deterministic: same input, same
/// bytes. One per thread: rendering reuses its buffers.
class FrontCamera {
 public:
  /// Throws InputError as CameraOptions::validate does.
  FrontCamera(const CameraOptions& options, const map::RoadNetwork& network);
  /// Of the same network, whose shapes both share: one thread may use both.
  FrontCamera(const CameraOptions& options, const FrontCamera& other);

  /// What `vehicle`, one of the snapshot's or a copy of one, sees. It does not see itself; others
  /// are distinguished from it by id.
  traffic::CameraImage render(const traffic::TrafficSnapshot& snapshot,
                              const traffic::Vehicle& vehicle);
  /// As RigRenderer::setBodyColors.
  void setBodyColors(BodyColors colors) { renderer_.setBodyColors(colors); }
  const CameraOptions& options() const { return options_; }

 private:
  CameraOptions options_;
  RigRenderer renderer_;
};

}  // namespace cdiff::rendering
