// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/front_camera.h"

#include <cmath>

#include "core/option_fields.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "rendering/road_scene.h"
#include "rendering/scene_objects.h"

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

traffic::CameraImage midGray(const CameraOptions& options, std::uint64_t tick) {
  constexpr std::uint8_t kMidGray = 128;
  traffic::CameraImage image;
  image.width = static_cast<int>(options.width);
  image.height = static_cast<int>(options.height);
  image.tick = tick;
  image.rgb.assign(static_cast<std::size_t>(3 * options.width * options.height), kMidGray);
  return image;
}

}  // namespace

void CameraOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "px", "Width of the image."}, width, 1, 4096);
  visitor.integer({"height", "px", "Height of the image."}, height, 1, 4096);
  visitor.number({"field_of_view", "deg", "Horizontal field of view."}, field_of_view, 10.0, 170.0);
  visitor.number({"mount_forward", "m", "Mounting point ahead of the box's center."}, mount_forward,
                 -20.0, 20.0);
  visitor.number({"mount_height", "m", "Mounting point above the road."}, mount_height, 0.2, 10.0);
  visitor.number({"pitch", "deg", "Downward tilt."}, pitch, -45.0, 45.0);
  visitor.number({"far_distance", "m", "Farthest ground and vehicles that are drawn."},
                 far_distance, 5.0, 1000.0);
  visitor.integer({"supersampling", "", "Samples per pixel and axis."}, supersampling, 1, 8);
  visitor.flag({"blind", "", "Whether every pixel is mid-gray, to see what an image is worth."},
               blind);
}

void CameraOptions::validate() const { core::requireRanges(*this, "camera"); }

Intrinsics intrinsicsOf(const CameraOptions& options) {
  Intrinsics intrinsics;
  const double width = static_cast<double>(options.width);
  intrinsics.focal_length = 0.5 * width / std::tan(options.field_of_view * core::kPi / 360.0);
  intrinsics.center_x = 0.5 * (width - 1.0);
  intrinsics.center_y = 0.5 * (static_cast<double>(options.height) - 1.0);
  return intrinsics;
}

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
  if (scene.options.blind) return midGray(scene.options, snapshot.tick);
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
