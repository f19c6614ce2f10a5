// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::rendering {

/// The front view of a vehicle, rendered from the road network and a snapshot: road surface, lane
/// markings, junctions, stop lines with the color of their light, other vehicles as shaded boxes
/// with brake lights, sky and horizon. Deterministic: same input, same bytes.
/// Keeps what it needs of the network. One per thread: rendering reuses its buffers.
class FrontCamera {
 public:
  FrontCamera(const CameraOptions& options, const map::RoadNetwork& network);
  FrontCamera(FrontCamera&&) noexcept;
  FrontCamera& operator=(FrontCamera&&) noexcept;
  ~FrontCamera();

  /// What `vehicle`, one of the snapshot's or a copy of one, sees. It does not see itself; others
  /// are distinguished from it by id.
  traffic::CameraImage render(const traffic::TrafficSnapshot& snapshot,
                              const traffic::Vehicle& vehicle);

  /// Pixel (sub-pixel coordinates) of a point of the map frame seen from `vehicle`; nullopt when it
  /// lies behind the near plane. The road below the vehicle has the vehicle's elevation.
  std::optional<Eigen::Vector2d> project(const traffic::Vehicle& vehicle,
                                         const Eigen::Vector3d& point) const;
  const CameraOptions& options() const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace cdiff::rendering
