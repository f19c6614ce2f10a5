// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/scene_recorder.h"

#include <algorithm>
#include <utility>

#include "e2e_cdiff/core/options.h"

namespace cdiff::collection {

DriverQueries driverQueries(const CollectionLoop& loop) {
  DriverQueries queries;
  queries.driver = [&](const std::string& id) -> learning::SceneDriver {
    const auto driver = loop.driverOf(id);
    return {driver.target_speed, driver.style.minimum_gap, driver.style.time_headway,
            driver.style.acceleration, driver.style.deceleration};
  };
  queries.noisy = [&](const std::string& id) { return loop.perturbed(id); };
  return queries;
}

SceneRecorder::SceneRecorder(const session::SessionSetup& setup, DriverQueries queries)
    : setup_(setup), queries_(std::move(queries)) {
  const session::ScenarioOptions& options = setup.options();
  scene_.name = options.name + "_seed" + std::to_string(options.seed);
  scene_.scenario_yaml = core::dumpOptions(options);
  scene_.network_source = setup.import().source.string();
  scene_.network_source_sha256 = setup.import().source_sha256;
  scene_.network_text = setup.import().text;
  addDrive(traffic::kEgoId, 0, setup.egoRoute());
}

void SceneRecorder::addDrive(const std::string& id, std::uint64_t tick, const map::Route& route) {
  drives_.emplace(DriveKey{id, tick}, scene_.drives.size());
  learning::SceneDrive& drive = scene_.drives.emplace_back();
  drive.vehicle_id = id;
  drive.selected_tick = tick;
  drive.driver = queries_.driver(id);
  drive.route_points = route.path().points();
  drive.conflict_point = drive.route_points.back();
  for (const map::LaneIndex lane : route.lanes())
    drive.route_lanes.push_back(setup_.network().lane(lane).id);
}

void SceneRecorder::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  for (const traffic::Contact& contact : snapshot.contacts)
    scene_.contacts.emplace_back(snapshot.tick, contact);
  scene_.seconds = std::max(scene_.seconds, snapshot.time);
  if (!snapshot.decision_tick) return;
  traffic::TrafficSnapshot& kept = scene_.decisions.emplace_back();
  kept.tick = snapshot.tick;
  kept.time = snapshot.time;
  kept.decision_tick = true;
  kept.vehicles = snapshot.vehicles;
  kept.signals = snapshot.signals;
  scene_.driven.push_back({{traffic::kEgoSlot, 0}});
  if (record.selection != nullptr) observeSelection(*record.selection);
  if (record.actions == nullptr) return;
  for (const planning::PlannedAction& action : *record.actions) {
    if (queries_.noisy(action.vehicle_id) || !action.fault.empty())
      scene_.disturbed.insert({action.vehicle_id, snapshot.tick});
  }
}

void SceneRecorder::observeSelection(const cbv::CbvSelection& selection) {
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const DriveKey key{assignment.vehicle_id, assignment.selected_tick};
    if (drives_.count(key) == 0) {
      addDrive(key.first, key.second, assignment.conflict_aware_route);
      scene_.drives.back().interaction_score = assignment.interaction_score;
      scene_.drives.back().conflict_point = assignment.conflict_point.position;
    }
    scene_.driven.back()[assignment.slot] = drives_.at(key);
  }
}

}  // namespace cdiff::collection
