// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/scene_recorder.h"

#include <algorithm>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"
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

namespace {

std::unique_ptr<session::SessionSetup> setupOf(const learning::Scene& scene) {
  session::ScenarioOptions options;
  core::loadOptions({"scenario of scene '" + scene.name + "'", scene.scenario_yaml}, options);
  map::ImportedNetwork import;
  import.source = scene.network_source;
  import.source_sha256 = scene.network_source_sha256;
  import.text = scene.network_text;
  if (scene.drives.empty())
    throw core::InputError("scene '" + scene.name + "' holds no route of the ego");
  return std::make_unique<session::SessionSetup>(options, std::move(import),
                                                 scene.drives.front().route_points);
}

}  // namespace

DrivenSession drivenSession(const learning::Scene& scene) {
  DrivenSession session;
  session.name = scene.name;
  session.setup = setupOf(scene);
  session.decisions = scene.decisions;
  session.disturbed = scene.disturbed;
  session.seconds = scene.seconds;
  for (const learning::SceneDrive& drive : scene.drives) {
    const bool ego = &drive == &scene.drives.front();
    session.routes[{drive.vehicle_id, drive.selected_tick}] =
        ego ? session.setup->egoRoute() : learning::routeOf(scene, drive, session.setup->network());
  }
  for (std::size_t i = 0; i < scene.driven.size(); ++i) {
    for (const auto& [slot, number] : scene.driven[i]) {
      const learning::SceneDrive& drive = scene.drives.at(number);
      session.drives[scene.decisions.at(i).tick][slot] = {drive.vehicle_id, drive.selected_tick};
    }
  }
  for (const auto& [tick, contact] : scene.contacts) {
    session.contacts[contact.first].push_back(tick);
    session.contacts[contact.second].push_back(tick);
  }
  return session;
}

}  // namespace cdiff::collection
