// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::simulation {

/// A vehicle that we move ourselves: where it is after the coming step.
struct DrivenVehicle {
  std::string id;
  traffic::VehicleState state;  ///< at the end of the step
  /// Route it follows, so that its SUMO route reaches beyond the next junction.
  const map::Route* route = nullptr;
};

/// A vehicle as the simulator reports it.
struct SimulatedVehicle {
  std::string id;
  traffic::VehicleState state;  ///< for a vehicle that we drive only SUMO's echo
  traffic::VehicleDimensions dimensions;
  double acceleration = 0.0;  ///< [m/s^2]
  std::string lane_id;        ///< empty off the road
};

/// The vehicle with this id among vehicles in order of their ids, or nullptr.
const SimulatedVehicle* findVehicle(const std::vector<SimulatedVehicle>& vehicles,
                                    const std::string& id);
/// A background vehicle of a snapshot; the simulator knows no yaw rate.
traffic::Vehicle asBackground(const SimulatedVehicle& simulated);

/// Background traffic as the rest of the system sees it: SI units, map frame, box centers, headings
/// counter-clockwise. SUMO's own conventions stay inside simulation/.
/// One owner thread; not copyable. Every method throws core::SimulatorError when the simulator
/// died, froze or refused.
class TrafficSimulator {
 public:
  virtual ~TrafficSimulator() = default;

  /// Adds a vehicle that we drive from the beginning (the ego). It exists after the next step.
  virtual void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                         const DrivenVehicle& start) = 0;
  /// Takes a background vehicle over: from the next step on it must be in `driven`.
  virtual void takeOver(const std::string& id) = 0;
  /// Gives a vehicle back to the simulator, to drive on from where it is along its route. Removed
  /// where it is on no lane of its direction (returns false).
  virtual bool release(const DrivenVehicle& vehicle) = 0;
  /// Adds a background vehicle that the simulator drives along `edges`, departing now with its
  /// front bumper at `depart_position` [m] of the first edge and `depart_speed` [m/s]. Answers
  /// false when it is refused; one that finds no room in the next step is dropped.
  virtual bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                             double depart_position, int depart_lane, double depart_speed,
                             const traffic::VehicleDimensions& dimensions) = 0;
  /// Takes a vehicle out of the simulation (contact).
  virtual void remove(const std::string& id) = 0;

  /// Moves the driven vehicles and advances by one simulation step.
  virtual void step(const std::vector<DrivenVehicle>& driven) = 0;

  /// All vehicles after the last step, by id.
  virtual const std::vector<SimulatedVehicle>& vehicles() const = 0;
  /// Traffic lights after the last step, by id.
  virtual const std::vector<traffic::SignalState>& signals() const = 0;
  /// Version text of the simulator ("SUMO 1.15.0").
  virtual std::string version() const = 0;
};

}  // namespace cdiff::simulation
