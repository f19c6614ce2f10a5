// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <optional>

#include "benchmark.h"
#include "e2e_cdiff/core/random.h"
#include "map/import/network_import.h"
#include "rendering/front_camera.h"

namespace cdiff::benchmark {
namespace {

constexpr std::size_t kVehicles = 30;    // around the camera
constexpr double kReach = 80.0;          // [m] they are at most this far away
constexpr std::uint32_t kViews = 20;     // places of the camera
constexpr int kRounds = 20;              // images per place
constexpr std::uint32_t kTries = 50000;  // places tried for vehicles

traffic::Vehicle vehicleOn(const map::Lane& lane, double arc_length, const std::string& id) {
  traffic::Vehicle vehicle;
  const Eigen::Vector3d point = lane.centerline.pointAt(arc_length);
  vehicle.id = id;
  vehicle.state.position = point.head<2>();
  vehicle.state.elevation = point.z();
  vehicle.state.heading = lane.centerline.headingAt(arc_length);
  vehicle.state.speed = 8.0;
  return vehicle;
}

/// The camera's vehicle on a lane of the network, and others around it.
traffic::TrafficSnapshot sceneOf(const map::RoadNetwork& network, std::uint32_t place) {
  const core::RandomStream random(1, "camera benchmark");
  traffic::TrafficSnapshot snapshot;
  for (std::uint32_t i = 0; i < kTries && snapshot.vehicles.size() <= kVehicles; ++i) {
    const map::Lane& lane = network.lanes()[random.index({place, i, 0}, 0, network.lanes().size())];
    if (!lane.routable) continue;
    const double arc_length = random.uniform({place, i, 0}, 1, 0.0, lane.centerline.length());
    traffic::Vehicle vehicle = vehicleOn(lane, arc_length, std::to_string(i));
    if (!snapshot.vehicles.empty()) {
      const double distance =
          (vehicle.state.position - snapshot.vehicles.front().state.position).norm();
      if (distance < 8.0 || distance > kReach) continue;
    }
    snapshot.vehicles.push_back(std::move(vehicle));
  }
  return snapshot;
}

}  // namespace

void benchmarkCamera(Figures& figures) {
  const std::string file = (dataFolder() / "carla_towns" / "Town05.net.xml").string();
  const map::RoadNetwork network =
      map::RoadNetwork::fromText(map::importNetwork(file).text, "Town05");
  std::optional<rendering::FrontCamera> camera;
  figures.push_back({"Town05_camera_set_up",
                     1e3 * secondsOf([&] { camera.emplace(rendering::CameraOptions(), network); }),
                     "ms", ""});
  const auto rigOf = [&](const char* preset) {
    rendering::RigOptions options;
    options.preset = preset;
    return rendering::RigRenderer(rendering::rigOf(options, {}), network);
  };
  rendering::RigRenderer three = rigOf(rendering::kFrontThreeRig);
  rendering::RigRenderer six = rigOf(rendering::kBench2driveRig);
  std::vector<double> one_ms, three_ms, six_ms, labeled_ms;
  for (std::uint32_t place = 0; place < kViews; ++place) {
    const traffic::TrafficSnapshot snapshot = sceneOf(network, place);
    const traffic::Vehicle& vehicle = snapshot.vehicles.front();
    for (int round = 0; round < kRounds; ++round) {
      one_ms.push_back(1e3 * secondsOf([&] { camera->render(snapshot, vehicle); }));
      three_ms.push_back(1e3 * secondsOf([&] { three.render(snapshot, vehicle); }));
      six_ms.push_back(1e3 * secondsOf([&] { six.render(snapshot, vehicle); }));
      labeled_ms.push_back(1e3 * secondsOf([&] {
                             six.render(snapshot, vehicle, rendering::Labels::kClassesAndInstances);
                           }));
    }
  }
  figures.push_back({"Town05_camera_160x96_p50", median(one_ms), "ms", "<=1"});
  figures.push_back({"Town05_front_three_160x96_p50", median(three_ms), "ms", ""});
  figures.push_back({"Town05_bench2drive_six_160x96_p50", median(six_ms), "ms", ""});
  figures.push_back({"Town05_bench2drive_six_labeled_160x96_p50", median(labeled_ms), "ms", ""});
  figures.push_back(
      {"Town05_bench2drive_six_over_camera", median(six_ms) / median(one_ms), "times", "<=4"});
}

}  // namespace cdiff::benchmark
