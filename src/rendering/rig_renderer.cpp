// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/rig_renderer.h"

#include <algorithm>
#include <cmath>

#include "rendering/network_scene.h"
#include "rendering/road_scene.h"
#include "rendering/vehicle_body.h"

namespace cdiff::rendering {
namespace {

/// The ball around a vehicle.
Bound boundOf(const traffic::Vehicle& vehicle) {
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  const Eigen::Vector2d& at = vehicle.state.position;
  return {{at.x(), at.y(), vehicle.state.elevation + 0.5 * size.height},
          0.5 * std::sqrt(size.length * size.length + size.width * size.width +
                          size.height * size.height)};
}

traffic::CameraImage midGray(const RigCamera& camera) {
  constexpr std::uint8_t kMidGray = 128;
  traffic::CameraImage image;
  image.width = static_cast<int>(camera.width);
  image.height = static_cast<int>(camera.height);
  image.rgb.assign(static_cast<std::size_t>(3 * camera.width * camera.height), kMidGray);
  return image;
}

}  // namespace

struct RigRenderer::Parts {
  Parts(const CameraRig& of_rig, std::shared_ptr<NetworkScene> of_scene)
      : rig(of_rig), scene(std::move(of_scene)) {
    for (const RigCamera& camera : rig.cameras)
      canvases.emplace_back(camera, rig.supersampling, samples);
  }

  void look(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle);
  void draw(std::size_t camera, Labels labels);
  RenderedView show(std::size_t camera, Labels labels) const;

  CameraRig rig;
  std::shared_ptr<NetworkScene> scene;
  Samples samples;
  std::vector<Canvas> canvases;
  std::vector<View> views;
  std::vector<VisibleVehicle> vehicles;
  BodyColors colors = BodyColors::kById;
};

void RigRenderer::Parts::look(const traffic::TrafficSnapshot& snapshot,
                              const traffic::Vehicle& vehicle) {
  views.clear();
  for (const RigCamera& camera : rig.cameras) views.emplace_back(camera, rig.far_distance, vehicle);
  scene->road.look(views);
  scene->signals.look(views, snapshot.signals);
  vehicles.clear();
  for (std::size_t i = 0; i < snapshot.vehicles.size(); ++i) {
    const traffic::Vehicle& other = snapshot.vehicles[i];
    if (other.id == vehicle.id) continue;
    const Bound bound = boundOf(other);
    const auto sees = [&](const View& view) { return view.maySee(bound.center, bound.radius); };
    if (std::any_of(views.begin(), views.end(), sees))
      vehicles.push_back({bound, bodyOf(other, static_cast<std::uint16_t>(i + 1), colors)});
  }
}

void RigRenderer::Parts::draw(std::size_t camera, Labels labels) {
  const View& view = views[camera];
  Canvas& canvas = canvases[camera];
  canvas.clear(labels == Labels::kClassesAndInstances);
  scene->road.draw(camera, view, canvas);
  scene->signals.drawStopLines(camera, view, canvas);
  for (const VisibleVehicle& seen : vehicles) {
    if (view.maySee(seen.bound.center, seen.bound.radius)) drawBody(seen.body, view, canvas);
  }
  scene->signals.drawLamps(camera, view, canvas);
}

RenderedView RigRenderer::Parts::show(std::size_t camera, Labels labels) const {
  RenderedView view;
  view.image = rig.blind ? midGray(rig.cameras[camera]) : canvases[camera].image();
  if (labels == Labels::kClassesAndInstances) canvases[camera].readLabels(view);
  return view;
}

namespace {

const CameraRig& validated(const CameraRig& rig) {
  rig.validate();
  return rig;
}

}  // namespace

RigRenderer::RigRenderer(const CameraRig& rig, const map::RoadNetwork& network)
    : parts_(std::make_unique<Parts>(validated(rig), std::make_shared<NetworkScene>(network))) {}
RigRenderer::RigRenderer(const CameraRig& rig, const RigRenderer& other)
    : parts_(std::make_unique<Parts>(validated(rig), other.parts_->scene)) {}
RigRenderer::RigRenderer(RigRenderer&&) noexcept = default;
RigRenderer& RigRenderer::operator=(RigRenderer&&) noexcept = default;
RigRenderer::~RigRenderer() = default;

std::vector<RenderedView> RigRenderer::render(const traffic::TrafficSnapshot& snapshot,
                                              const traffic::Vehicle& vehicle, Labels labels) {
  const bool drawn = !parts_->rig.blind || labels != Labels::kNone;
  if (drawn) parts_->look(snapshot, vehicle);
  std::vector<RenderedView> views;
  for (std::size_t i = 0; i < parts_->rig.cameras.size(); ++i) {
    if (drawn) parts_->draw(i, labels);
    views.push_back(parts_->show(i, labels));
    views.back().image.tick = snapshot.tick;
  }
  return views;
}

void RigRenderer::setBodyColors(BodyColors colors) { parts_->colors = colors; }

const CameraRig& RigRenderer::rig() const { return parts_->rig; }

std::vector<int> mostPixels(const std::vector<RenderedView>& views, std::size_t vehicles) {
  std::vector<int> most(vehicles, 0);
  for (const RenderedView& view : views) {
    std::vector<int> here(vehicles + 1, 0);
    for (const std::uint16_t instance : view.instances) ++here.at(instance);
    for (std::size_t i = 0; i < vehicles; ++i) most[i] = std::max(most[i], here[i + 1]);
  }
  return most;
}

}  // namespace cdiff::rendering
