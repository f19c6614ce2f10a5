// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <libsumo/TraCIDefs.h>

#include <string>
#include <vector>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::simulation {

/// Place that a vehicle is moved to whether a lane is there or not, in SUMO's conventions.
struct FreePlace {
  std::string edge;  ///< that of the lane it is on; empty: SUMO takes the nearest
  int lane = 0;      ///< index on this edge
  Eigen::Vector2d front = Eigen::Vector2d::Zero();  ///< front bumper [m]
  double angle = 0.0;                               ///< clockwise from north [deg]
  int keep_route = 0;                               ///< as in SUMO's moveToXY
  double match_threshold = 0.0;                     ///< largest distance to a lane [m]
};

/// What SUMO says of a person, in its conventions.
struct PersonState {
  std::string type;
  std::string vehicle;  ///< that the person is in; empty: none
  libsumo::TraCIPosition position;
  double angle = 0.0;  ///< clockwise from north [deg]
  double speed = 0.0;  ///< [m/s]
};

/// How a vehicle departs: words or numbers as in SUMO's route files.
struct Departure {
  std::string lane = "first";
  std::string position = "0";  ///< of its front bumper on the lane [m]
  std::string speed = "0";     ///< [m/s]
};

/// The calls to SUMO that a session makes. SUMO's libraries libtraci (to a process) and libsumo (in
/// this process) have the same functions, and library_calls.cpp is compiled with each. Conventions
/// are SUMO's; a call that SUMO refuses throws libsumo::TraCIException, one that finds SUMO gone
/// another std::exception.
class SumoCalls {
 public:
  virtual ~SumoCalls() = default;

  /// Starts SUMO with these arguments, and closes the session before.
  virtual void load(const std::vector<std::string>& arguments) const = 0;
  virtual void step() const = 0;
  virtual void close() const = 0;
  /// "SUMO 1.15.0".
  virtual std::string version() const = 0;

  virtual void addRoute(const std::string& id, const std::vector<std::string>& edges) const = 0;
  /// Adds a type like SUMO's passenger car, of this size and without dawdling.
  virtual void addType(const std::string& id,
                       const traffic::VehicleDimensions& dimensions) const = 0;
  virtual traffic::VehicleDimensions typeDimensions(const std::string& type) const = 0;
  virtual double laneLength(const std::string& lane) const = 0;

  /// Adds a vehicle that departs in the next step.
  virtual void addVehicle(const std::string& id, const std::string& route, const std::string& type,
                          const Departure& departure) const = 0;
  virtual void removeVehicle(const std::string& id) const = 0;
  virtual std::string typeOf(const std::string& id) const = 0;
  virtual std::vector<std::string> routeOf(const std::string& id) const = 0;
  virtual void setRoute(const std::string& id, const std::vector<std::string>& edges) const = 0;
  virtual void setSpeed(const std::string& id, double speed) const = 0;
  virtual void setPreviousSpeed(const std::string& id, double speed) const = 0;
  virtual void setSpeedMode(const std::string& id, int mode) const = 0;
  virtual void setLaneChangeMode(const std::string& id, int mode) const = 0;
  virtual void moveTo(const std::string& id, const std::string& lane, double position) const = 0;
  virtual void moveFreely(const std::string& id, const FreePlace& place) const = 0;

  virtual void subscribe(const std::string& vehicle, const std::vector<int>& variables) const = 0;
  virtual void unsubscribe(const std::string& vehicle) const = 0;
  virtual libsumo::SubscriptionResults vehicleResults() const = 0;

  virtual std::vector<std::string> persons() const = 0;
  virtual PersonState person(const std::string& id) const = 0;
  virtual void removePerson(const std::string& id) const = 0;

  virtual std::vector<std::string> lights() const = 0;
  virtual std::string lightState(const std::string& light) const = 0;
  virtual void setLightState(const std::string& light, const std::string& state) const = 0;
  virtual void subscribeToLight(const std::string& light,
                                const std::vector<int>& variables) const = 0;
  virtual libsumo::SubscriptionResults lightResults() const = 0;

  virtual void subscribeToSimulation(const std::vector<int>& variables) const = 0;
  virtual libsumo::TraCIResults simulationResults() const = 0;
};

/// The calls of the library that the caller's was compiled with; they live as long as the program.
extern "C" const SumoCalls* cdiffSumoCalls();

}  // namespace cdiff::simulation
