// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/person_observer.h"

#include <libsumo/TraCIConstants.h>

#include <algorithm>

#include "core/file.h"
#include "simulation/sumo_conventions.h"

namespace cdiff::simulation {

bool hasPersons(const std::filesystem::path& demand_file) {
  return !demand_file.empty() &&
         core::readFile(demand_file, "demand").find("<person") != std::string::npos;
}

SimulatedVehicle PersonObserver::bodyOf(const std::string& id, const PersonState& person) {
  if (dimensions_of_type_.count(person.type) == 0)
    dimensions_of_type_[person.type] = calls_.typeDimensions(person.type);
  SimulatedVehicle body;
  body.id = id;
  body.dimensions = dimensions_of_type_.at(person.type);
  const libsumo::TraCIPosition& place = person.position;
  body.state.heading = headingFromAngle(finiteAnswer(person.angle, "angle", id));
  body.state.position = {finiteAnswer(place.x, "position", id),
                         finiteAnswer(place.y, "position", id)};
  const double elevation = finiteAnswer(place.z, "elevation", id);
  body.state.elevation = elevation == libsumo::INVALID_DOUBLE_VALUE ? 0.0 : elevation;
  body.state.speed = std::max(0.0, finiteAnswer(person.speed, "speed", id));
  return body;
}

void PersonObserver::addTo(std::vector<SimulatedVehicle>& vehicles) {
  std::map<std::string, PersonState> walking;
  for (const std::string& id : calls_.persons()) {
    if (findVehicle(vehicles, id) != nullptr) continue;
    const PersonState person = calls_.person(id);
    if (person.vehicle.empty()) walking[id] = person;
  }
  walking_.clear();
  for (const auto& [id, person] : walking) {
    walking_.insert(id);
    vehicles.push_back(bodyOf(id, person));
  }
  std::sort(vehicles.begin(), vehicles.end(),
            [](const SimulatedVehicle& left, const SimulatedVehicle& right) {
              return left.id < right.id;
            });
}

void PersonObserver::remove(const std::string& id) {
  walking_.erase(id);
  calls_.removePerson(id);
}

}  // namespace cdiff::simulation
