// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::simulation {

/// Where a driven vehicle (ego or CBV, moved by our own dynamics) is to be after the coming step.
struct DrivenVehicle {
  std::string id;
  traffic::VehicleState state;  ///< at the end of the step
  /// Route that it follows; its SUMO route is kept reaching beyond the next junction on it.
  const map::Route* route = nullptr;
};

/// A vehicle as the simulator reports it after a step (map frame, SI units, position = center of
/// the box).
struct SimulatedVehicle {
  std::string id;
  traffic::VehicleState state;  ///< of a driven vehicle: what was given to step()
  traffic::VehicleDimensions dimensions;
  double acceleration = 0.0;  ///< [m/s^2]
  std::string lane_id;        ///< empty off the road
};

/// The vehicle with this id among vehicles in order of their ids, or nullptr.
const SimulatedVehicle* findVehicle(const std::vector<SimulatedVehicle>& vehicles,
                                    const std::string& id);
/// The same vehicle as a snapshot holds it, in the role of a background vehicle; its yaw rate is 0,
/// for the simulator reports none.
traffic::Vehicle asBackground(const SimulatedVehicle& simulated);

/// Interface of the background traffic, implemented by SumoSimulator and called by the world of a
/// session (session/world.h): map frame, SI units, positions of box centers, headings
/// counter-clockwise. SUMO's own conventions stay inside simulation/. Owned by one thread; not
/// copyable. Every method throws core::SimulatorError when the simulator has died, is frozen or
/// refuses the call.
class TrafficSimulator {
 public:
  virtual ~TrafficSimulator() = default;

  /// Adds a vehicle that we drive from the start (the ego). It exists after the next step.
  virtual void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                         const DrivenVehicle& start) = 0;
  /// Takes a background vehicle over: from the next step on it must be in `driven`.
  virtual void takeOver(const std::string& id) = 0;
  /// Gives a vehicle back to the simulator, which drives it on from where it is along its route.
  /// Returns false, and removes the vehicle, when it is on no lane of its direction.
  virtual bool release(const DrivenVehicle& vehicle) = 0;
  /// Adds a background vehicle that the simulator drives along `edges`, departing now with its
  /// front bumper at `depart_position` [m] of the first edge and `depart_speed` [m/s]. Returns
  /// false when it is refused; one that finds no room in the next step is dropped.
  virtual bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                             double depart_position, int depart_lane, double depart_speed,
                             const traffic::VehicleDimensions& dimensions) = 0;
  /// Takes a vehicle out of the simulation (after a contact). No error when it is gone already:
  /// vehicles() still has one that a release of this step removed.
  virtual void remove(const std::string& id) = 0;

  /// Moves the driven vehicles and advances by one simulation step.
  virtual void step(const std::vector<DrivenVehicle>& driven) = 0;

  /// All vehicles after the last step, in order of their ids.
  virtual const std::vector<SimulatedVehicle>& vehicles() const = 0;
  /// Traffic lights after the last step, in order of their ids.
  virtual const std::vector<traffic::SignalState>& signals() const = 0;
  /// Whether the story that the traffic plays has come to its end; traffic without a story has
  /// none.
  virtual bool over() const { return false; }
  /// Version text of the simulator ("SUMO 1.15.0").
  virtual std::string version() const = 0;
};

}  // namespace cdiff::simulation
