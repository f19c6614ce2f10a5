// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/traffic_observer.h"

#include <libsumo/libtraci.h>

#include <algorithm>

#include "simulation/sumo_conversion.h"

namespace cdiff::simulation {

namespace {

using libsumo::TraCIResults;

double numberOf(const TraCIResults& results, int variable) {
  return std::static_pointer_cast<libsumo::TraCIDouble>(results.at(variable))->value;
}

std::string textOf(const TraCIResults& results, int variable) {
  return std::static_pointer_cast<libsumo::TraCIString>(results.at(variable))->value;
}

/// A vehicle that is not in the network yet reports this sentinel as its position.
bool placed(const libsumo::TraCIPosition& front) {
  return front.x != libsumo::INVALID_DOUBLE_VALUE && front.y != libsumo::INVALID_DOUBLE_VALUE;
}

double finiteOrZero(double value) { return value == libsumo::INVALID_DOUBLE_VALUE ? 0.0 : value; }

SimulatedVehicle vehicleFrom(const std::string& id, const TraCIResults& results,
                             const libsumo::TraCIPosition& front,
                             const traffic::VehicleDimensions& dimensions) {
  SimulatedVehicle vehicle;
  vehicle.id = id;
  vehicle.dimensions = dimensions;
  vehicle.state.heading = headingFromAngle(numberOf(results, libsumo::VAR_ANGLE));
  vehicle.state.position =
      centerBehind({front.x, front.y}, vehicle.state.heading, dimensions.length);
  vehicle.state.elevation = finiteOrZero(front.z);
  vehicle.state.speed = std::max(0.0, finiteOrZero(numberOf(results, libsumo::VAR_SPEED)));
  vehicle.acceleration = finiteOrZero(numberOf(results, libsumo::VAR_ACCELERATION));
  vehicle.lane_id = textOf(results, libsumo::VAR_LANE_ID);
  return vehicle;
}

}  // namespace

void TrafficObserver::start(bool lights_green) {
  lights_green_ = lights_green;
  for (const std::string& id : libtraci::TrafficLight::getIDList()) {
    std::string state = libtraci::TrafficLight::getRedYellowGreenState(id);
    if (lights_green) {
      state.assign(state.size(), 'g');
      libtraci::TrafficLight::setRedYellowGreenState(id, state);
    } else {
      libtraci::TrafficLight::subscribe(id, {libsumo::TL_RED_YELLOW_GREEN_STATE});
    }
    signals_.push_back({id, state});
  }
  std::sort(signals_.begin(), signals_.end(),
            [](const auto& first, const auto& second) { return first.id < second.id; });
  libtraci::Simulation::subscribe(std::vector<int>{libsumo::VAR_DEPARTED_VEHICLES_IDS});
}

void TrafficObserver::subscribe(const std::string& id) {
  const std::string type = libtraci::Vehicle::getTypeID(id);
  auto known = dimensions_of_type_.find(type);
  if (known == dimensions_of_type_.end()) {
    const traffic::VehicleDimensions dimensions{libtraci::VehicleType::getLength(type),
                                                libtraci::VehicleType::getWidth(type),
                                                libtraci::VehicleType::getHeight(type)};
    known = dimensions_of_type_.emplace(type, dimensions).first;
  }
  dimensions_[id] = known->second;
  libtraci::Vehicle::subscribe(id, {libsumo::VAR_POSITION3D, libsumo::VAR_ANGLE, libsumo::VAR_SPEED,
                                    libsumo::VAR_ACCELERATION, libsumo::VAR_LANE_ID});
}

void TrafficObserver::read() {
  const TraCIResults simulation = libtraci::Simulation::getSubscriptionResults();
  const auto departed = simulation.find(libsumo::VAR_DEPARTED_VEHICLES_IDS);
  if (departed != simulation.end()) {
    const auto ids = std::static_pointer_cast<libsumo::TraCIStringList>(departed->second);
    for (const std::string& id : ids->value) subscribe(id);
  }
  for (const std::string& id : waiting_) {
    if (dimensions_.count(id) == 0) subscribe(id);
  }
  waiting_.clear();
  const libsumo::SubscriptionResults all = libtraci::Vehicle::getAllSubscriptionResults();
  vehicles_.clear();
  for (const auto& [id, results] : all) {
    const auto known = dimensions_.find(id);
    if (known == dimensions_.end() || results.count(libsumo::VAR_POSITION3D) == 0) continue;
    const auto front =
        std::static_pointer_cast<libsumo::TraCIPosition>(results.at(libsumo::VAR_POSITION3D));
    if (placed(*front)) vehicles_.push_back(vehicleFrom(id, results, *front, known->second));
  }
  for (auto known = dimensions_.begin(); known != dimensions_.end();) {
    known = all.count(known->first) == 0 ? dimensions_.erase(known) : std::next(known);
  }
  readSignals();
}

void TrafficObserver::show(const traffic::SignalState& changed) {
  for (traffic::SignalState& signal : signals_) {
    if (signal.id == changed.id) signal.state = changed.state;
  }
}

void TrafficObserver::readSignals() {
  if (lights_green_) return;
  const libsumo::SubscriptionResults all = libtraci::TrafficLight::getAllSubscriptionResults();
  for (traffic::SignalState& signal : signals_) {
    const auto found = all.find(signal.id);
    if (found == all.end()) continue;
    signal.state = textOf(found->second, libsumo::TL_RED_YELLOW_GREEN_STATE);
  }
}

const SimulatedVehicle* TrafficObserver::find(const std::string& id) const {
  const auto place =
      std::lower_bound(vehicles_.begin(), vehicles_.end(), id,
                       [](const SimulatedVehicle& vehicle, const std::string& wanted) {
                         return vehicle.id < wanted;
                       });
  return place != vehicles_.end() && place->id == id ? &*place : nullptr;
}

}  // namespace cdiff::simulation
