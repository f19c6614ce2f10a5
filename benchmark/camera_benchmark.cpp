// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <optional>

#include "benchmark.h"
#include "e2e_cdiff/core/random.h"
#include "map/import/network_import.h"
#include "rendering/front_camera.h"
#include "rendering/range_sensor.h"

namespace cdiff::benchmark {
namespace {

constexpr std::size_t kVehicles = 30;    // around the camera
constexpr double kReach = 80.0;          // [m] they are at most this far away
constexpr std::uint32_t kViews = 20;     // places of the camera
constexpr int kRounds = 40;              // sweeps over all places
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

/// Processor time of one image or rig, as the mean over all places; one value per sweep over them,
/// so that no two renderings in a row see the same place.
template <class Render>
std::vector<double> sweepsOf(const std::vector<traffic::TrafficSnapshot>& places, Render&& render) {
  std::vector<double> milliseconds;
  for (int round = 0; round < kRounds; ++round) {
    const double seconds = cpuSecondsOf([&] {
      for (const traffic::TrafficSnapshot& place : places) render(place, place.vehicles.front());
    });
    milliseconds.push_back(1e3 * seconds / static_cast<double>(places.size()));
  }
  return milliseconds;
}

rendering::RigRenderer rendererOf(const char* preset, const map::RoadNetwork& network) {
  rendering::RigOptions options;
  options.preset = preset;
  return {rendering::rigOf(options, {}), network};
}

/// Processor time of a scan of true sensors (goal: 2 ms).
void addScans(const map::RoadNetwork& network, const std::vector<traffic::TrafficSnapshot>& places,
              Figures& figures) {
  const auto add = [&](const std::string& name, const rendering::RangeSensorOptions& options) {
    rendering::RangeSensor sensor(options, network);
    const auto scan = [&](const traffic::TrafficSnapshot& place, const traffic::Vehicle& of) {
      sensor.scan(place, of.id);
    };
    figures.push_back({"Town05_" + name + "_p50", median(sweepsOf(places, scan)), "ms", "<=2"});
  };
  add("laser_720", rendering::RangeSensorOptions::laser());
  add("lidar_16x360", rendering::RangeSensorOptions::lidar());
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
  std::vector<traffic::TrafficSnapshot> places;
  for (std::uint32_t place = 0; place < kViews; ++place) places.push_back(sceneOf(network, place));
  rendering::RigRenderer three = rendererOf(rendering::kFrontThreeRig, network);
  rendering::RigRenderer six = rendererOf(rendering::kBench2driveRig, network);
  const auto add = [&](const std::string& name, const char* goal, auto&& render) {
    figures.push_back(
        {"Town05_" + name + "_160x96_p50", median(sweepsOf(places, render)), "ms", goal});
    return figures.back().value;
  };
  using traffic::TrafficSnapshot;
  using traffic::Vehicle;
  const double one_ms = add("camera", "<=1", [&](const TrafficSnapshot& place, const Vehicle& of) {
    camera->render(place, of);
  });
  add("front_three", "", [&](const auto& place, const auto& of) { three.render(place, of); });
  const double six_ms =
      add("bench2drive_six", "", [&](const auto& place, const auto& of) { six.render(place, of); });
  add("bench2drive_six_labeled", "", [&](const auto& place, const auto& of) {
    six.render(place, of, rendering::Labels::kClassesAndInstances);
  });
  figures.push_back({"Town05_bench2drive_six_over_camera", six_ms / one_ms, "times", "<=4"});
  addScans(network, places, figures);
}

}  // namespace cdiff::benchmark
