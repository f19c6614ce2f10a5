// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small scenes made by rule, for tests, on a straight road.
#pragma once

#include <cmath>
#include <string>

#include "learning/samples/scene.h"
#include "learning/samples/scene_file.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::test {

/// A scene without decisions and drives.
inline learning::Scene emptyScene(const std::string& name, const NetworkText& network) {
  learning::Scene scene;
  scene.name = name;
  scene.scenario_yaml = "name: " + name + "\n";
  scene.network_source = "small.net.xml";
  scene.network_source_sha256 = "of " + name;  // networks are held out, so each scene has its own
  scene.network_text = network.text();
  return scene;
}

inline learning::SceneDrive sceneDrive(const std::string& id, double begin, double end) {
  learning::SceneDrive drive;
  drive.vehicle_id = id;
  drive.driver = {8.0, 4.0, 0.5, 2.5, 3.0};
  for (double x = begin; x <= end; x += 1.0) {
    drive.route_points.emplace_back(x, 0.0, 0.0);
    drive.route_lanes.push_back("road_0");
  }
  return drive;
}

/// Decision `i` (0.1 s each): the ego at 10 + 0.8 i m, "a" at 40 + 0.8 i m, both at 8 m/s.
inline traffic::TrafficSnapshot sceneDecision(std::size_t i) {
  const double x = 0.8 * static_cast<double>(i);
  traffic::TrafficSnapshot snapshot = snapshotWithEgo(2 * i, {10.0 + x, 0.0, 0.0, 8.0});
  snapshot.vehicles.push_back(vehicle("a", {40.0 + x, 0.0, 0.0, 8.0}, traffic::VehicleRole::kCbv));
  snapshot.vehicles.back().cbv_slot = 0;
  for (traffic::Vehicle& driven : snapshot.vehicles) {
    driven.applied_action = traffic::ControlAction{0.45, 0.01 * static_cast<double>(i), 0.0};
    driven.acceleration = -1.0 / 3.0;
    driven.yaw_rate = 0.1;
    driven.lane_id = "road_0";
  }
  snapshot.vehicles.push_back(vehicle("b", {60.0, 3.5, 90.0, 0.0, 0.25}));
  snapshot.vehicles.back().dimensions = {7.0, 2.5, 3.0};
  snapshot.signals = {{"light", i % 2 == 0 ? "rG" : "Gr"}};
  return snapshot;
}

/// The ego and "a" drive along a road of 300 m, one behind the other; "b" stands beside them.
inline learning::Scene smallScene(std::size_t decisions = 60) {
  learning::Scene scene = emptyScene("small_seed1", NetworkText().edge("road", {"0,0 300,0"}));
  scene.drives = {sceneDrive("ego", 0.0, 300.0), sceneDrive("a", 30.0, 300.0)};
  scene.drives[1].selected_tick = 4;
  scene.drives[1].interaction_score = 0.75;
  scene.drives[1].conflict_point = {300.0, 0.0, 0.0};
  for (std::size_t i = 0; i < decisions; ++i) {
    scene.decisions.push_back(sceneDecision(i));
    scene.driven.push_back({{traffic::kEgoSlot, 0}});
    if (i >= 2) scene.driven.back()[0] = 1;
  }
  scene.seconds = 0.1 * static_cast<double>(decisions);
  return scene;
}

/// `seconds` of vehicles behind each other on a road of 400 m, 3.2 m wide: "ego", "a" and "b" are
/// driven at 5, 6 and 7 m/s; "tail", which SUMO drives at 5 m/s, follows.
inline learning::Scene platoonScene(const std::string& name, double seconds) {
  learning::Scene scene = emptyScene(
      name, NetworkText().edge("road", {"0,0 400,0"}, "a", "b", LaneText{3.2, 13.89, ""}));
  const std::string ids[] = {"ego", "a", "b", "tail"};
  for (int i = 0; i < 3; ++i) {
    scene.drives.push_back(sceneDrive(ids[i], 0.0, 400.0));
    scene.drives.back().driver.target_speed = 5.0 + i;
  }
  for (int n = 0; n <= std::lround(seconds / 0.1); ++n) {
    traffic::TrafficSnapshot& snapshot = scene.decisions.emplace_back();
    snapshot.tick = static_cast<std::uint64_t>(2 * n);
    snapshot.time = 0.1 * n;
    snapshot.decision_tick = true;
    scene.driven.push_back({{-1, 0}, {0, 1}, {1, 2}});
    for (int i = 0; i < 4; ++i) {
      const double speed = i < 3 ? 5.0 + i : 5.0;
      const double begin = i < 3 ? 30.0 + 25.0 * i : 10.0;
      traffic::Vehicle& added = snapshot.vehicles.emplace_back(
          vehicle(ids[i], {begin + speed * snapshot.time, 0.0, 0.0, speed}));
      added.lane_id = "road_0";
      if (i == 3) continue;
      added.role = i == 0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
      added.cbv_slot = i - 1;
      added.applied_action = {0.4, 0.0, 0.0};
    }
  }
  scene.seconds = seconds;
  return scene;
}

inline void writePlatoonScene(const std::filesystem::path& folder, const std::string& name,
                              double seconds) {
  learning::writeScene(folder / (name + learning::kSceneExtension), platoonScene(name, seconds));
}

}  // namespace cdiff::test
