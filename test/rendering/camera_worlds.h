// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small worlds in front of a camera, and pixels of what it sees.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "rendering/canvas.h"
#include "rendering/front_camera.h"

namespace cdiff::rendering {

using Pixel = std::array<int, 3>;

inline Pixel pixelAt(const traffic::CameraImage& image, int column, int row) {
  const std::uint8_t* at = image.rgb.data() + 3 * (row * image.width + column);
  return {at[0], at[1], at[2]};
}

/// Level camera: f = 80, center (79.5, 47.5), eye 0.5 m ahead of the center and 1.4 m up.
inline CameraOptions levelCamera() {
  CameraOptions options;
  options.pitch = 0.0;
  return options;
}

inline traffic::Vehicle vehicleAt(const std::string& id, double x, double y, double heading = 0.0) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.state.position = {x, y};
  vehicle.state.heading = heading;
  vehicle.state.speed = 8.0;
  return vehicle;
}

/// Where a camera of `vehicle` shows a point of the map frame; nullopt behind the near plane.
inline std::optional<Eigen::Vector2d> pixelOf(const RigCamera& camera,
                                              const traffic::Vehicle& vehicle,
                                              const Eigen::Vector3d& point) {
  const Eigen::Vector3d at = View(camera, 90.0, vehicle).toCamera(point);
  if (at.z() < kNearPlane) return std::nullopt;
  const Intrinsics intrinsics = intrinsicsOf(camera);
  return Eigen::Vector2d(intrinsics.focal_length * at.x() / at.z() + intrinsics.center_x,
                         intrinsics.focal_length * at.y() / at.z() + intrinsics.center_y);
}

inline traffic::TrafficSnapshot snapshotOf(std::vector<traffic::Vehicle> vehicles) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = std::move(vehicles);
  return snapshot;
}

/// One lane eastwards, y = 0, 4 m wide, from x = -50 to `end`, then a junction with a light.
inline map::RoadNetwork signaledLane(double end) {
  const std::string x = std::to_string(end);
  return map::RoadNetwork::fromText(
      R"(<net><edge id="in" from="a" to="j"><lane id="in_0" index="0" speed="14" width="4" shape="-50,0 )" +
          x +
          R"(,0"/></edge><edge id="out" from="j" to="b"><lane id="out_0" index="0" speed="14" )" +
          R"(width="4" shape=")" + x + R"(,0 200,0"/></edge><connection from="in" to="out" )" +
          R"(fromLane="0" toLane="0" tl="light" linkIndex="1" dir="s"/></net>)",
      "signaled lane");
}

/// A straight lane eastwards, y = 0, 4 m wide, at the given height.
inline std::string straightEdge(const std::string& id, double y, double z) {
  const std::string rest = "," + std::to_string(y) + "," + std::to_string(z);
  return "<edge id=\"" + id + "\" from=\"a\" to=\"b\"><lane id=\"" + id +
         "_0\" index=\"0\" speed=\"14\" width=\"4\" shape=\"-50" + rest + " 200" + rest +
         "\"/></edge>";
}

inline map::RoadNetwork straightRoad() {
  return map::RoadNetwork::fromText("<net>" + straightEdge("road", 0.0, 0.0) + "</net>",
                                    "straight road");
}

}  // namespace cdiff::rendering
