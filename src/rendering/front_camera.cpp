// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/front_camera.h"

#include <cmath>

#include "rendering/road_scene.h"
#include "rendering/signal_heads.h"
#include "rendering/vehicle_body.h"

namespace cdiff::rendering {
namespace {

const CameraOptions& validated(const CameraOptions& options) {
  options.validate();
  return options;
}

/// The ball around a vehicle.
Bound boundOf(const traffic::Vehicle& vehicle) {
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  const Eigen::Vector2d& at = vehicle.state.position;
  return {{at.x(), at.y(), vehicle.state.elevation + 0.5 * size.height},
          0.5 * std::sqrt(size.length * size.length + size.width * size.width +
                          size.height * size.height)};
}

traffic::CameraImage midGrey(const CameraOptions& options, std::uint64_t tick) {
  constexpr std::uint8_t kMidGrey = 128;
  traffic::CameraImage image;
  image.width = static_cast<int>(options.width);
  image.height = static_cast<int>(options.height);
  image.tick = tick;
  image.rgb.assign(static_cast<std::size_t>(3 * options.width * options.height), kMidGrey);
  return image;
}

}  // namespace

struct FrontCamera::Scene {
  Scene(const CameraOptions& camera, const map::RoadNetwork& network)
      : options(validated(camera)), road(network), signals(network), canvas(options) {}

  CameraOptions options;
  RoadScene road;
  SignalHeads signals;
  Canvas canvas;
};

FrontCamera::FrontCamera(const CameraOptions& options, const map::RoadNetwork& network)
    : scene_(std::make_unique<Scene>(options, network)) {}
FrontCamera::FrontCamera(FrontCamera&&) noexcept = default;
FrontCamera& FrontCamera::operator=(FrontCamera&&) noexcept = default;
FrontCamera::~FrontCamera() = default;

traffic::CameraImage FrontCamera::render(const traffic::TrafficSnapshot& snapshot,
                                         const traffic::Vehicle& vehicle) {
  Scene& scene = *scene_;
  if (scene.options.blind) return midGrey(scene.options, snapshot.tick);
  const View view(scene.options, vehicle);
  scene.canvas.clear();
  scene.road.draw(view, scene.canvas);
  scene.signals.look(view, snapshot.signals);
  scene.signals.drawStopLines(view, scene.canvas);
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == vehicle.id) continue;
    const Bound bound = boundOf(other);
    if (view.maySee(bound.center, bound.radius)) drawVehicle(other, view, scene.canvas);
  }
  scene.signals.drawLamps(view, scene.canvas);
  traffic::CameraImage image = scene.canvas.image();
  image.tick = snapshot.tick;
  return image;
}

std::optional<Eigen::Vector2d> FrontCamera::project(const traffic::Vehicle& vehicle,
                                                    const Eigen::Vector3d& point) const {
  const Eigen::Vector3d at = View(scene_->options, vehicle).toCamera(point);
  if (at.z() < kNearPlane) return std::nullopt;
  const Intrinsics intrinsics = intrinsicsOf(scene_->options);
  return Eigen::Vector2d(intrinsics.focal_length * at.x() / at.z() + intrinsics.center_x,
                         intrinsics.focal_length * at.y() / at.z() + intrinsics.center_y);
}

const CameraOptions& FrontCamera::options() const { return scene_->options; }

}  // namespace cdiff::rendering
