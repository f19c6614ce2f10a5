// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "rendering/rendered_view.h"

namespace cdiff::rendering {

/// What the cameras of a vehicle see, rendered in one pass from the road network and a snapshot:
/// road surface, lane markings, junctions, stop lines and lamps with the color of their light,
/// other vehicles as shaded boxes with brake lights, sky and horizon. What does not depend on the
/// view is done once: which surfaces and signals are near, the bodies of vehicles and their colors.
/// Deterministic: same input, same bytes; the image of a camera does not depend on the rig's
/// others. Keeps what it needs of the network. One per thread: rendering reuses its buffers.
class RigRenderer {
 public:
  /// Throws InputError as CameraRig::validate does.
  RigRenderer(const CameraRig& rig, const map::RoadNetwork& network);
  /// Of the same network, whose shapes both share: one thread may use both.
  RigRenderer(const CameraRig& rig, const RigRenderer& other);
  RigRenderer(RigRenderer&&) noexcept;
  RigRenderer& operator=(RigRenderer&&) noexcept;
  ~RigRenderer();

  /// One view per camera in the rig's order, of what `vehicle` sees: one of the snapshot's or a
  /// copy of one, perhaps of another place. It does not see itself; others are distinguished from
  /// it by id. A blind rig's images are mid-gray, their labels as those of a seeing one.
  std::vector<RenderedView> render(const traffic::TrafficSnapshot& snapshot,
                                   const traffic::Vehicle& vehicle, Labels labels = Labels::kNone);

  /// kById until it is called.
  void setBodyColors(BodyColors colors);

  const CameraRig& rig() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cdiff::rendering
