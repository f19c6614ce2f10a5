// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/storyboard_traffic.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::storyboard {

using simulation::DrivenVehicle;
using simulation::SimulatedVehicle;

StoryboardTraffic::StoryboardTraffic(std::unique_ptr<simulation::TrafficSimulator> traffic,
                                     const Play& play, double step)
    : traffic_(std::move(traffic)),
      play_(play),
      stage_(play.scenario, play.places, {play.ego}),
      storyboard_(play.scenario, stage_),
      step_(step) {}

bool StoryboardTraffic::isOurs(const std::string& id) const {
  return id != traffic::kEgoId && play_.scenario.find(id) != nullptr;
}

void StoryboardTraffic::addDriven(const std::string& id,
                                  const traffic::VehicleDimensions& dimensions,
                                  const DrivenVehicle& start) {
  if (id == traffic::kEgoId) stage_.setDimensions(play_.ego, dimensions);
  traffic_->addDriven(id, dimensions, start);
}

void StoryboardTraffic::takeOver(const std::string& id) {
  if (!isOurs(id)) return traffic_->takeOver(id);
  taken_.insert(id);
  stage_.setPlanned(id, true);
}

bool StoryboardTraffic::release(const DrivenVehicle& vehicle) {
  if (!isOurs(vehicle.id)) return traffic_->release(vehicle);
  taken_.erase(vehicle.id);
  stage_.setPlanned(vehicle.id, false);
  return true;
}

void StoryboardTraffic::remove(const std::string& id) {
  if (isOurs(id)) {
    stage_.remove(id);
    taken_.erase(id);
    if (added_.erase(id) == 0) return;
  }
  traffic_->remove(id);
}

/// Where planners have their entities.
void StoryboardTraffic::observe(const std::vector<DrivenVehicle>& driven) {
  for (const DrivenVehicle& vehicle : driven) {
    if (vehicle.id == traffic::kEgoId) {
      stage_.observe(play_.ego, vehicle.state, vehicle.route, step_);
    } else if (taken_.count(vehicle.id) != 0) {
      stage_.observe(vehicle.id, vehicle.state, vehicle.route, step_);
    }
  }
}

void StoryboardTraffic::advance(const std::vector<DrivenVehicle>& driven) {
  if (!begun_) {
    observe(driven);
    stage_.begin();
    begun_ = true;
    return;
  }
  storyboard_.update(static_cast<double>(steps_) * step_);
  ++steps_;
  stage_.advance(static_cast<double>(steps_) * step_, step_);
  observe(driven);
}

std::vector<DrivenVehicle> StoryboardTraffic::moves() {
  std::vector<DrivenVehicle> moves;
  for (const std::string& id : stage_.moved()) {
    const Actor& actor = stage_.actor(id);
    moves.push_back({id, actor.state(), actor.route()});
    if (added_.insert(id).second) traffic_->addDriven(id, actor.entity().dimensions, moves.back());
  }
  for (auto id = added_.begin(); id != added_.end();) {
    const bool there = stage_.present(*id);
    if (!there) traffic_->remove(*id);
    id = there ? std::next(id) : added_.erase(id);
  }
  return moves;
}

void StoryboardTraffic::step(const std::vector<DrivenVehicle>& driven) {
  const bool ego = std::any_of(driven.begin(), driven.end(), [](const DrivenVehicle& vehicle) {
    return vehicle.id == traffic::kEgoId;
  });
  std::vector<DrivenVehicle> all = driven;
  if (ego) {
    advance(driven);
    const std::vector<DrivenVehicle> ours = moves();
    all.insert(all.end(), ours.begin(), ours.end());
  }
  traffic_->step(all);
  collectVehicles(begun_ ? stage_.moved() : std::vector<std::string>());
}

/// Ours are where the storyboard has them, whatever the other simulator makes of them.
void StoryboardTraffic::collectVehicles(const std::vector<std::string>& moved) {
  vehicles_.clear();
  for (const SimulatedVehicle& vehicle : traffic_->vehicles())
    if (!isOurs(vehicle.id) || taken_.count(vehicle.id) != 0) vehicles_.push_back(vehicle);
  for (const std::string& id : moved) {
    const Actor& actor = stage_.actor(id);
    const SimulatedVehicle* const echo = simulation::findVehicle(traffic_->vehicles(), id);
    vehicles_.push_back({id, actor.state(), actor.entity().dimensions, actor.acceleration(),
                         echo != nullptr ? echo->lane_id : ""});
  }
  std::sort(vehicles_.begin(), vehicles_.end(),
            [](const SimulatedVehicle& left, const SimulatedVehicle& right) {
              return left.id < right.id;
            });
}

}  // namespace cdiff::storyboard
