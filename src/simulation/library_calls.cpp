// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Compiled twice: with LIBTRACI for SUMO as a process, without it for SUMO in this process.
#include <libsumo/libsumo.h>

#include "simulation/sumo_calls.h"

namespace cdiff::simulation {
namespace {

namespace library = LIBSUMO_NAMESPACE;

/// The calls of one of SUMO's libraries (units and frames as in the base class).
class LibraryCalls : public SumoCalls {
 public:
  void load(const std::vector<std::string>& arguments) const override {
    library::Simulation::load(arguments);
  }
  void step() const override { library::Simulation::step(); }
  void close() const override { library::Simulation::close(); }
  std::string version() const override { return library::Simulation::getVersion().second; }

  void addRoute(const std::string& id, const std::vector<std::string>& edges) const override {
    library::Route::add(id, edges);
  }
  void addType(const std::string& id, const traffic::VehicleDimensions& dimensions) const override {
    using Type = library::VehicleType;
    Type::copy("DEFAULT_VEHTYPE", id);
    Type::setLength(id, dimensions.length);
    Type::setWidth(id, dimensions.width);
    Type::setHeight(id, dimensions.height);
    Type::setImperfection(id, 0.0);
  }
  traffic::VehicleDimensions typeDimensions(const std::string& type) const override {
    using Type = library::VehicleType;
    return {Type::getLength(type), Type::getWidth(type), Type::getHeight(type)};
  }
  double laneLength(const std::string& lane) const override {
    return library::Lane::getLength(lane);
  }

  void addVehicle(const std::string& id, const std::string& route, const std::string& type,
                  const Departure& departure) const override {
    Vehicle::add(id, route, type, "now", departure.lane, departure.position, departure.speed);
  }
  void removeVehicle(const std::string& id) const override {
    Vehicle::remove(id, libsumo::REMOVE_VAPORIZED);
  }
  std::string typeOf(const std::string& id) const override { return Vehicle::getTypeID(id); }
  std::vector<std::string> routeOf(const std::string& id) const override {
    return Vehicle::getRoute(id);
  }
  void setRoute(const std::string& id, const std::vector<std::string>& edges) const override {
    Vehicle::setRoute(id, edges);
  }
  void setSpeed(const std::string& id, double speed) const override {
    Vehicle::setSpeed(id, speed);
  }
  void setPreviousSpeed(const std::string& id, double speed) const override {
    Vehicle::setPreviousSpeed(id, speed, 0.0);
  }
  void setSpeedMode(const std::string& id, int mode) const override {
    Vehicle::setSpeedMode(id, mode);
  }
  void setLaneChangeMode(const std::string& id, int mode) const override {
    Vehicle::setLaneChangeMode(id, mode);
  }
  void moveTo(const std::string& id, const std::string& lane, double position) const override {
    Vehicle::moveTo(id, lane, position);
  }
  void moveFreely(const std::string& id, const FreePlace& place) const override {
    Vehicle::moveToXY(id, place.edge, place.lane, place.front.x(), place.front.y(), place.angle,
                      place.keep_route, place.match_threshold);
  }

  void subscribe(const std::string& vehicle, const std::vector<int>& variables) const override {
    Vehicle::subscribe(vehicle, variables);
  }
  void unsubscribe(const std::string& vehicle) const override { Vehicle::unsubscribe(vehicle); }
  libsumo::SubscriptionResults vehicleResults() const override {
    return Vehicle::getAllSubscriptionResults();
  }

  std::vector<std::string> persons() const override { return library::Person::getIDList(); }
  PersonState person(const std::string& id) const override {
    using Person = library::Person;
    return {Person::getTypeID(id), Person::getVehicle(id), Person::getPosition3D(id),
            Person::getAngle(id), Person::getSpeed(id)};
  }
  void removePerson(const std::string& id) const override { library::Person::remove(id); }

  std::vector<std::string> lights() const override { return Light::getIDList(); }
  std::string lightState(const std::string& light) const override {
    return Light::getRedYellowGreenState(light);
  }
  void setLightState(const std::string& light, const std::string& state) const override {
    Light::setRedYellowGreenState(light, state);
  }
  void subscribeToLight(const std::string& light,
                        const std::vector<int>& variables) const override {
    Light::subscribe(light, variables);
  }
  libsumo::SubscriptionResults lightResults() const override {
    return Light::getAllSubscriptionResults();
  }

  void subscribeToSimulation(const std::vector<int>& variables) const override {
    library::Simulation::subscribe(variables);
  }
  libsumo::TraCIResults simulationResults() const override {
    return library::Simulation::getSubscriptionResults();
  }

 private:
  using Vehicle = library::Vehicle;
  using Light = library::TrafficLight;
};

}  // namespace

extern "C" const SumoCalls* cdiffSumoCalls() {
  static const LibraryCalls calls;
  return &calls;
}

}  // namespace cdiff::simulation
