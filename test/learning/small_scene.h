// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A small scene made by rule, for tests: the ego and "a" drive along a road of 300 m, one behind
/// the other; "b" stands beside them.
#pragma once

#include <string>

#include "learning/samples/scene.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::test {

inline map::RoadNetwork sceneNetwork() {
  return NetworkText().edge("road", {"0,0 300,0"}).network();
}

inline learning::SceneDrive sceneDrive(const std::string& id, std::uint64_t tick, double begin) {
  learning::SceneDrive drive;
  drive.vehicle_id = id;
  drive.selected_tick = tick;
  drive.driver = {8.0, 4.0, 0.5, 2.5, 3.0};
  for (double x = begin; x <= 300.0; x += 1.0) {
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

inline learning::Scene smallScene(std::size_t decisions = 60) {
  learning::Scene scene;
  scene.name = "small_seed1";
  scene.scenario_yaml = "name: small\n";
  scene.network_source = "small.net.xml";
  scene.network_source_sha256 = "abc";
  scene.network_text = NetworkText().edge("road", {"0,0 300,0"}).text();
  scene.drives = {sceneDrive("ego", 0, 0.0), sceneDrive("a", 4, 30.0)};
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

}  // namespace cdiff::test
