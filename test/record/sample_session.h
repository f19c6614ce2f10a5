// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A hand-made session for tests: an ego that drives east over a crossing at 8 m/s, a vehicle from
/// the south that is selected as CBV at 2.6 s and brakes, and an oncoming background vehicle. Tick
/// 0.05 s, no simulator.
#pragma once

#include <string>
#include <vector>

#include "page/result_writer.h"
#include "support/network_text.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

/// West to east along y = -2, east to west along y = 2, south to north along x = 102; junction from
/// x = 90 to 110 m.
inline std::string crossingText() {
  return NetworkText()
      .edge("west_in", {"0,-2 90,-2"}, "w", "c")
      .edge("east_out", {"110,-2 200,-2"}, "c", "e")
      .edge("east_in", {"200,2 110,2"}, "e", "c")
      .edge("west_out", {"90,2 0,2"}, "c", "w")
      .edge("south_in", {"102,-70 102,-10"}, "s", "c")
      .edge("north_out", {"102,10 102,70"}, "c", "n")
      .edge(":c_0", {"90,-2 110,-2"})
      .edge(":c_1", {"110,2 90,2"})
      .edge(":c_2", {"102,-10 102,10"})
      .junction("c", "90,-10 110,-10 110,10 90,10")
      .connection("west_in_0", "east_out_0", ":c_0_0")
      .connection("east_in_0", "west_out_0", ":c_1_0")
      .connection("south_in_0", "north_out_0", ":c_2_0")
      .text();
}

inline std::vector<Eigen::Vector3d> lineOf(const Eigen::Vector3d& begin,
                                           const Eigen::Vector3d& end) {
  std::vector<Eigen::Vector3d> points;
  const int count = static_cast<int>((end - begin).norm());
  for (int i = 0; i <= count; ++i) points.push_back(begin + (end - begin) * i / count);
  return points;
}

inline map::ImportedNetwork crossingImport() {
  map::ImportedNetwork import;
  import.file = "crossing.net.xml";
  import.source = "crossing.net.xml";
  import.source_sha256 = std::string(64, 'a');
  import.text = crossingText();
  import.changes = {"vehicle class \"drone\" was dropped: SUMO 1.15 does not know it"};
  return import;
}

inline session::ScenarioOptions sampleOptions() {
  session::ScenarioOptions options;
  options.name = "crossing";
  options.network = "crossing.net.xml";
  options.seed = 7;
  return options;
}

/// Setup with the ego route from x = 5 to 195 m: 190 m, junction from 85 to 105 m of it.
struct SampleSetup {
  explicit SampleSetup(const session::ScenarioOptions& options = sampleOptions())
      : setup(options, crossingImport(), lineOf({5.0, -2.0, 0.0}, {195.0, -2.0, 0.0})) {}
  session::SessionSetup setup;
};

inline traffic::Vehicle sampleVehicle(const std::string& id, traffic::VehicleRole role,
                                      const Eigen::Vector2d& position, double heading,
                                      double speed) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.cbv_slot = role == traffic::VehicleRole::kCbv ? 0 : -1;
  vehicle.state.position = position;
  vehicle.state.heading = heading;
  vehicle.state.speed = speed;
  if (role != traffic::VehicleRole::kBackground) {
    vehicle.applied_action = traffic::ControlAction{0.25, 0.0, 0.0};
  }
  return vehicle;
}

/// Ego at x = 5 + 8 t; crossing vehicle at y = -60 + 6 t, a CBV after tick 52; oncoming vehicle at
/// x = 190 - 10 t.
inline traffic::TrafficSnapshot sampleSnapshot(std::uint64_t tick) {
  constexpr double kHalfPi = 1.5707963267948966;
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.decision_tick = tick % 2 == 0;
  const double t = snapshot.time;
  const auto role = tick > 52 ? traffic::VehicleRole::kCbv : traffic::VehicleRole::kBackground;
  snapshot.vehicles = {
      sampleVehicle("ego", traffic::VehicleRole::kEgo, {5.0 + 8.0 * t, -2.0}, 0.0, 8.0),
      sampleVehicle("bg_1", role, {102.0, -60.0 + 6.0 * t}, kHalfPi, 6.0),
      sampleVehicle("bg_2", traffic::VehicleRole::kBackground, {190.0 - 10.0 * t, 2.0},
                    2.0 * kHalfPi, 10.0)};
  return snapshot;
}

/// "bg_1" in slot 0 since tick 52; the routes cross at (102, -2), 97 m along the ego's.
inline cbv::CbvSelection sampleSelection(std::uint64_t tick, const map::RoadNetwork& network) {
  cbv::CbvSelection selection;
  selection.tick = tick;
  selection.rejected = {{"bg_2", "no_way", 0.0}};
  if (tick < 52) return selection;
  const std::vector<Eigen::Vector3d> points = lineOf({102.0, -44.0, 0.0}, {102.0, 60.0, 0.0});
  cbv::CbvAssignment assignment;
  assignment.vehicle_id = "bg_1";
  assignment.interaction_score = 0.75;
  assignment.selected_tick = 52;
  assignment.conflict_point.position = {102.0, -2.0, 0.0};
  assignment.conflict_point.ego_arc_length = 97.0;
  assignment.conflict_point.ego_distance = 97.0 - 0.4 * static_cast<double>(tick);
  assignment.conflict_point.cbv_distance = 58.0 - 0.3 * static_cast<double>(tick);
  assignment.conflict_point.ego_arrival = 9.0;
  assignment.conflict_point.cbv_arrival = 8.5;
  assignment.conflict_aware_route = map::matchRoute(network, points);
  selection.assignments = {assignment};
  return selection;
}

/// Shows ticks 0 to `last` to the observer; the last one has the final status.
inline void playSession(session::SessionObserver& observer, const session::SessionSetup& setup,
                        std::uint64_t last, traffic::SessionStatus status,
                        const std::vector<traffic::Fault>& faults = {}) {
  for (std::uint64_t tick = 0; tick <= last; ++tick) {
    traffic::TrafficSnapshot snapshot = sampleSnapshot(tick);
    if (tick == last) snapshot.status = status;
    if (tick == last) snapshot.faults = faults;
    const cbv::CbvSelection selection = sampleSelection(tick, setup.network());
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (snapshot.decision_tick) {
      record.selection = &selection;
      record.latencies = {{"ego:pdm_lite", 1.0 + 0.01 * static_cast<double>(tick)}};
    }
    observer.observe(record);
  }
}

inline record::RunFacts sampleFacts() { return {"cdiff run", "SUMO 1.15.0", true}; }

}  // namespace cdiff::test
