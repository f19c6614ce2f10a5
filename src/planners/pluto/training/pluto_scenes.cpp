// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_scenes.h"

#include <algorithm>

#include "core/file.h"
#include "planning/route_follower.h"

namespace cdiff::planners {
namespace {

bool sameSignals(const std::vector<traffic::SignalState>& left,
                 const std::vector<traffic::SignalState>& right) {
  return std::equal(
      left.begin(), left.end(), right.begin(), right.end(),
      [](const auto& a, const auto& b) { return a.id == b.id && a.state == b.state; });
}

}  // namespace

PlutoScene::PlutoScene(const learning::Scene& scene, std::shared_ptr<const PlutoWorld> world)
    : name_(scene.name), world_(std::move(world)) {
  learning::requireScenePeriod(scene, "Pluto and RIFT learn");
  for (const traffic::TrafficSnapshot& snapshot : scene.decisions) {
    frames_.push_back(frameOf(snapshot, vehicles_));
    if (signals_.empty() || !sameSignals(signals_.back(), snapshot.signals))
      signals_.push_back(snapshot.signals);
    signals_at_.push_back(signals_.size() - 1);
  }
  addDrives(scene);
  follow(scene);
  for (const auto& [tick, contact] : scene.contacts) {
    const auto after = std::lower_bound(scene.decisions.begin(), scene.decisions.end(), tick,
                                        [](const traffic::TrafficSnapshot& one,
                                           std::uint64_t wanted) { return one.tick < wanted; });
    const auto decision = static_cast<std::size_t>(after - scene.decisions.begin());
    for (const std::string& id : {contact.first, contact.second}) {
      traffic::Vehicle named;
      named.id = id;
      contacts_.insert({vehicles_.numberOf(named), decision});
    }
  }
}

void PlutoScene::addDrives(const learning::Scene& scene) {
  for (const learning::SceneDrive& drive : scene.drives) {
    traffic::Vehicle named;
    named.id = drive.vehicle_id;
    PlutoDrive& added = drives_.emplace_back();
    added.vehicle = vehicles_.numberOf(named);
    added.route = learning::routeOf(scene, drive, world_->network);
    added.target_speed = drive.driver.target_speed;
  }
}

/// Along each route, decision by decision, as a planner follows it. Where a vehicle is taken over
/// collection puts it elsewhere: its places begin at the decision after.
void PlutoScene::follow(const learning::Scene& scene) {
  std::vector<planning::RouteFollower> followers(drives_.size());
  for (std::size_t i = 0; i < scene.decisions.size(); ++i) {
    for (const auto& [slot, number] : scene.driven[i]) {
      PlutoDrive& drive = drives_[number];
      const traffic::Vehicle* vehicle = scene.decisions[i].find(scene.drives[number].vehicle_id);
      if (vehicle == nullptr) continue;
      followers[number].update(drive.route, vehicle->state.position);
      if (!vehicle->applied_action) continue;
      drive.places[i] = followers[number].arcLength();
      const auto key = std::make_pair(scene.drives[number].vehicle_id, scene.decisions[i].tick);
      if (scene.disturbed.count(key) != 0) drive.disturbed.insert(i);
    }
  }
}

bool PlutoScene::touches(std::uint32_t vehicle, std::size_t begin, std::size_t end) const {
  const auto contact = contacts_.lower_bound({vehicle, begin});
  return contact != contacts_.end() && contact->first == vehicle && contact->second <= end;
}

PlutoMoment PlutoScene::moment(std::size_t decision, std::size_t drive) const {
  const PlutoDrive& driven = drives_[drive];
  PlutoMoment moment;
  const auto history = static_cast<std::size_t>(kPlutoHistory);
  for (std::size_t i = decision > history ? decision - history : 0; i <= decision; ++i)
    moment.frames.push_back(&frames_[i]);
  moment.vehicles = &vehicles_;
  moment.own = driven.vehicle;
  moment.route = &driven.route;
  moment.arc_length = driven.places.at(decision);
  moment.target_speed = driven.target_speed;
  moment.signals = &signals(decision);
  return moment;
}

std::shared_ptr<const PlutoWorld> PlutoWorlds::of(const learning::Scene& scene) {
  auto& world = worlds_[core::sha256(scene.network_text)];
  if (!world) {
    world = std::make_shared<const PlutoWorld>(
        architecture_, map::RoadNetwork::fromText(scene.network_text, scene.network_source));
  }
  return world;
}

}  // namespace cdiff::planners
