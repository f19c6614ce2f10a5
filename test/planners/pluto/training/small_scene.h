// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Scenes as collection would store them: three vehicles are driven behind each other along a road
/// of 400 m, each at its speed; a fourth, which SUMO drives, follows.
#pragma once

#include "learning/samples/scene.h"
#include "planners/course.h"
#include "planners/pluto/pluto_weights.h"

namespace cdiff::planners::testing {

inline std::string smallNetworkText() {
  return "<net><edge id=\"road\"><lane id=\"road_0\" index=\"0\" speed=\"13.89\" shape=\"" +
         pointText(straight(0.0, 0.0, 400.0, 0.0)) + "\"/></edge></net>";
}

/// `seconds` of it; vehicle i drives at 5 + i m/s.
inline learning::Scene smallScene(const std::string& name, double seconds) {
  learning::Scene scene;
  scene.name = name;
  scene.scenario_yaml = "name: " + name + "\n";
  scene.network_source = "small";
  scene.network_source_sha256 = "of " + name;  // networks are held out, so each scene has its own
  scene.network_text = smallNetworkText();
  const std::vector<std::string> ids = {"ego", "a", "b", "tail"};
  for (std::size_t i = 0; i < 3; ++i) {
    learning::SceneDrive& drive = scene.drives.emplace_back();
    drive.vehicle_id = ids[i];
    drive.driver.target_speed = 5.0 + static_cast<double>(i);
    for (int x = 0; x <= 400; ++x) {
      drive.route_points.emplace_back(x, 0.0, 0.0);
      drive.route_lanes.emplace_back("road_0");
    }
  }
  for (int n = 0; n <= std::lround(seconds / 0.1); ++n) {
    traffic::TrafficSnapshot& snapshot = scene.decisions.emplace_back();
    snapshot.tick = static_cast<std::uint64_t>(2 * n);
    snapshot.time = 0.1 * n;
    snapshot.decision_tick = true;
    scene.driven.emplace_back();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const double speed = i < 3 ? 5.0 + static_cast<double>(i) : 5.0;
      const double begin = i < 3 ? 30.0 + 25.0 * static_cast<double>(i) : 10.0;
      traffic::Vehicle vehicle = vehicleAt(ids[i], begin + speed * snapshot.time, 0.0, 0.0, speed);
      vehicle.lane_id = "road_0";
      if (i < 3) {
        vehicle.role = i == 0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
        vehicle.cbv_slot = static_cast<int>(i) - 1;
        vehicle.applied_action = {0.4, 0.0, 0.0};
        scene.driven.back()[static_cast<int>(i) - 1] = i;
      }
      snapshot.vehicles.push_back(vehicle);
    }
  }
  scene.seconds = seconds;
  return scene;
}

/// A network that is trained in no time.
inline PlutoArchitecture smallPluto() {
  PlutoArchitecture architecture;
  architecture.width = 16;
  architecture.heads = 1;
  architecture.hidden = 32;
  architecture.encoder_layers = 1;
  architecture.decoder_layers = 1;
  architecture.polygons = 8;
  return architecture;
}

}  // namespace cdiff::planners::testing
