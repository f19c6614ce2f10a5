// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "decision_scene.h"

#include <cmath>

#include "e2e_cdiff/core/random.h"
#include "session/session_request.h"

namespace cdiff::benchmark {
namespace {

constexpr double kSpeed = 5.0;     // of all vehicles [m/s]
constexpr double kStart = 5.0;     // of the ego on its route [m]
constexpr double kSpacing = 8.0;   // [m]
constexpr int kRow = 16;           // CBVs one behind the other
constexpr double kAside = 3.5;     // of a row from the one before, to the left [m]
constexpr double kRadius = 150.0;  // of traffic around the middle of the row [m]

session::ScenarioOptions scenarioWith(const std::string& cbv_planner,
                                      const std::string& ego_planner) {
  session::SessionRequest request;
  request.scenario = "crossing_straight";
  request.cbv_planner = cbv_planner;
  request.ego_planner = ego_planner;
  return session::resolveRequest(request);
}

std::vector<map::LaneIndex> lanesAround(const map::RoadNetwork& network,
                                        const Eigen::Vector2d& middle) {
  std::vector<map::LaneIndex> lanes;
  for (std::size_t i = 0; i < network.lanes().size(); ++i) {
    const map::Lane& lane = network.lanes()[i];
    const geometry::Polyline& line = lane.centerline;
    const bool usable = lane.routable && !lane.internal && line.length() > 10.0;
    const bool near = (line.positionAt(0.5 * line.length()) - middle).norm() < kRadius;
    if (usable && near) lanes.push_back(static_cast<map::LaneIndex>(i));
  }
  return lanes;
}

traffic::Vehicle vehicleOn(const geometry::Polyline& line, double arc_length) {
  traffic::Vehicle vehicle;
  vehicle.state.position = line.positionAt(arc_length);
  vehicle.state.elevation = line.pointAt(arc_length).z();
  vehicle.state.heading = line.headingAt(arc_length);
  vehicle.state.speed = kSpeed;
  return vehicle;
}

void fillWithNoise(const core::RandomStream& random, std::vector<traffic::CameraImage>& images) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].width = 160;
    images[i].height = 96;
    images[i].rgb.resize(160 * 96 * 3);
    for (std::size_t j = 0; j < images[i].rgb.size(); ++j) {
      images[i].rgb[j] =
          static_cast<std::uint8_t>(random.index({i, 0, 0}, static_cast<std::uint32_t>(j), 256));
    }
  }
}

}  // namespace

DecisionScene::DecisionScene(const std::string& cbv_planner, std::size_t traffic,
                             const std::string& ego_planner, int cbvs)
    : setup_(scenarioWith(cbv_planner, ego_planner)),
      images_(static_cast<std::size_t>(cbvs)),
      ego_images_(setup_.rigs().of(traffic::kEgoSlot).cameras.size()) {
  addRows(cbvs);
  addTraffic(traffic);
  renewImages();
}

void DecisionScene::advance(bool new_images) {
  snapshot_.tick += setup_.ticksPerDecision();
  snapshot_.time += setup_.options().decision_period;
  if (new_images) renewImages();
  for (traffic::CameraImage& image : images_) image.tick = snapshot_.tick;
  for (traffic::CameraImage& image : ego_images_) image.tick = snapshot_.tick;
}

std::vector<planning::PlanningTask> DecisionScene::tasks(int first, int count) const {
  std::vector<planning::PlanningTask> tasks;
  for (int i = first; i < first + count; ++i) {
    const auto index = static_cast<std::size_t>(i);
    tasks.push_back({i,
                     &snapshot_.vehicles[index + 1],
                     &setup_.egoRoute(),
                     8.0,
                     {&setup_.rigs().of(i), {&images_[index]}}});
  }
  return tasks;
}

std::vector<planning::PlanningTask> DecisionScene::egoTask() const {
  planning::PlanningTask task{traffic::kEgoSlot, &snapshot_.vehicles.front(), &setup_.egoRoute(),
                              8.0};
  task.views.rig = &setup_.rigs().of(traffic::kEgoSlot);
  for (const traffic::CameraImage& image : ego_images_) task.views.images.push_back(&image);
  return {task};
}

void DecisionScene::addRows(int cbvs) {
  const geometry::Polyline& path = setup_.egoRoute().path();
  snapshot_.vehicles.push_back(vehicleOn(path, kStart));
  snapshot_.vehicles.back().id = traffic::kEgoId;
  snapshot_.vehicles.back().role = traffic::VehicleRole::kEgo;
  for (int slot = 0; slot < cbvs; ++slot) {
    traffic::Vehicle vehicle = vehicleOn(path, kStart + kSpacing * (slot % kRow + 1));
    const double aside = kAside * (slot / kRow);
    const double heading = vehicle.state.heading;
    vehicle.state.position += aside * Eigen::Vector2d(-std::sin(heading), std::cos(heading));
    vehicle.id = "cbv" + std::to_string(slot + 1);
    vehicle.role = traffic::VehicleRole::kCbv;
    vehicle.cbv_slot = slot;
    snapshot_.vehicles.push_back(vehicle);
  }
}

void DecisionScene::addTraffic(std::size_t count) {
  const Eigen::Vector2d middle =
      setup_.egoRoute().path().positionAt(kStart + 0.5 * kSpacing * kCbvs);
  const std::vector<map::LaneIndex> lanes = lanesAround(setup_.network(), middle);
  const core::RandomStream random(3, "traffic");
  for (std::size_t i = 0; i < count; ++i) {
    const core::RandomKey key{i, 0, 0};
    const map::Lane& lane = setup_.network().lane(lanes[random.index(key, 0, lanes.size())]);
    traffic::Vehicle vehicle =
        vehicleOn(lane.centerline, random.uniform(key, 1, 0.0, lane.centerline.length()));
    vehicle.id = "car" + std::to_string(i);
    vehicle.lane_id = lane.id;
    snapshot_.vehicles.push_back(vehicle);
  }
}

void DecisionScene::renewImages() {
  fillWithNoise(core::RandomStream(snapshot_.tick + 1, "benchmark"), images_);
  fillWithNoise(core::RandomStream(snapshot_.tick + 1, "benchmark of the ego"), ego_images_);
}

}  // namespace cdiff::benchmark
