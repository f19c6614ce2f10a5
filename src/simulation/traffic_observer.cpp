// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/traffic_observer.h"

#include <libsumo/TraCIConstants.h>

#include <algorithm>

#include "simulation/sumo_conventions.h"

namespace cdiff::simulation {
namespace {

using libsumo::TraCIResults;

/// The value of a variable, which has this type in TraCI.
template <class Value>
const Value& valueOf(const TraCIResults& results, int variable) {
  return static_cast<const Value&>(*results.at(variable));
}

double numberOf(const TraCIResults& results, int variable) {
  return valueOf<libsumo::TraCIDouble>(results, variable).value;
}

const std::string& textOf(const TraCIResults& results, int variable) {
  return valueOf<libsumo::TraCIString>(results, variable).value;
}

/// A vehicle that is not in the network yet reports this sentinel as its position.
bool placed(const libsumo::TraCIPosition& front) {
  return front.x != libsumo::INVALID_DOUBLE_VALUE && front.y != libsumo::INVALID_DOUBLE_VALUE;
}

double knownOrZero(double value) { return value == libsumo::INVALID_DOUBLE_VALUE ? 0.0 : value; }

SimulatedVehicle vehicleFrom(const std::string& id, const TraCIResults& results,
                             const libsumo::TraCIPosition& front,
                             const traffic::VehicleDimensions& dimensions) {
  const auto finite = [&id](double value, const char* quantity) {
    return finiteAnswer(value, quantity, id);
  };
  SimulatedVehicle vehicle;
  vehicle.id = id;
  vehicle.dimensions = dimensions;
  vehicle.state.heading = headingFromAngle(finite(numberOf(results, libsumo::VAR_ANGLE), "angle"));
  vehicle.state.position = centerBehind({finite(front.x, "position"), finite(front.y, "position")},
                                        vehicle.state.heading, dimensions.length);
  vehicle.state.elevation = finite(knownOrZero(front.z), "elevation");
  const double speed = finite(numberOf(results, libsumo::VAR_SPEED), "speed");
  vehicle.state.speed = std::max(0.0, knownOrZero(speed));
  vehicle.acceleration =
      finite(knownOrZero(numberOf(results, libsumo::VAR_ACCELERATION)), "acceleration");
  vehicle.lane_id = textOf(results, libsumo::VAR_LANE_ID);
  return vehicle;
}

constexpr double kStandingQueue = 0.1;  ///< [m/s]
constexpr double kMoving = 0.5;         ///< [m/s]
constexpr double kStopLine =
    8.0;  ///< a front bumper nearer to the lane's end waits at the stop line [m]
constexpr double kApproaching = 20.0;      ///< a vehicle nearer than this to the stop line ... [m]
constexpr double kApproachSpeed = 4.0;     ///< ... and faster than this is let through [m/s]
constexpr double kOursApproaching = 50.0;  ///< the same for a vehicle that we drive [m]
constexpr double kOursNear = 20.0;         ///< front bumper of ours to the stop line [m]
constexpr double kPatience = 1.0;          ///< wait before a vehicle is sent first [s]
constexpr double kLongestGrant = 5.0;      ///< [s]
constexpr double kLongestStandingGrant = 1.5;  ///< of a vehicle that still stands: it cannot go [s]
constexpr double kInsideFirst = 1e6;           ///< rank added inside a junction
constexpr double kAheadOfOursFirst = 1e3;      ///< rank added ahead of a vehicle of ours

double toLaneEnd(const SimulatedVehicle& vehicle, const map::Lane& lane) {
  const Eigen::Vector2d end = lane.centerline.points().back().head<2>();
  return (end - vehicle.state.position).norm() - 0.5 * vehicle.dimensions.length;
}

bool endsAtJunction(const map::RoadNetwork& network, const map::Lane& lane) {
  for (const map::LaneLink& link : lane.next) {
    if (network.lane(link.to).internal) return true;
  }
  return false;
}

}  // namespace

void TrafficObserver::start(bool lights_green) {
  lights_green_ = lights_green;
  for (const std::string& id : calls_.lights()) {
    std::string state = calls_.lightState(id);
    if (lights_green) {
      state.assign(state.size(), 'g');
      calls_.setLightState(id, state);
    } else {
      calls_.subscribeToLight(id, {libsumo::TL_RED_YELLOW_GREEN_STATE});
    }
    signals_.push_back({id, state});
  }
  std::sort(signals_.begin(), signals_.end(),
            [](const auto& first, const auto& second) { return first.id < second.id; });
  calls_.subscribeToSimulation({libsumo::VAR_DEPARTED_VEHICLES_IDS});
}

void TrafficObserver::subscribe(const std::string& id) {
  const std::string type = calls_.typeOf(id);
  auto known = dimensions_of_type_.find(type);
  if (known == dimensions_of_type_.end()) {
    known = dimensions_of_type_.emplace(type, calls_.typeDimensions(type)).first;
  }
  dimensions_[id] = known->second;
  calls_.subscribe(id, {libsumo::VAR_POSITION3D, libsumo::VAR_ANGLE, libsumo::VAR_SPEED,
                        libsumo::VAR_ACCELERATION, libsumo::VAR_LANE_ID});
}

void TrafficObserver::read() {
  const TraCIResults simulation = calls_.simulationResults();
  const auto departed = simulation.find(libsumo::VAR_DEPARTED_VEHICLES_IDS);
  if (departed != simulation.end()) {
    const auto ids = std::static_pointer_cast<libsumo::TraCIStringList>(departed->second);
    for (const std::string& id : ids->value) subscribe(id);
  }
  for (const std::string& id : waiting_) {
    if (dimensions_.count(id) == 0) subscribe(id);
  }
  waiting_.clear();
  readVehicles();
  readSignals();
}

/// Goes through what SUMO reports and what is known, both by id; forgets what SUMO does not report.
void TrafficObserver::readVehicles() {
  vehicles_.clear();
  auto known = dimensions_.begin();
  for (const auto& [id, results] : calls_.vehicleResults()) {
    while (known != dimensions_.end() && known->first < id) known = dimensions_.erase(known);
    if (known == dimensions_.end()) break;
    if (known->first != id) continue;
    const traffic::VehicleDimensions& dimensions = (known++)->second;
    if (results.count(libsumo::VAR_POSITION3D) == 0) continue;
    const auto& front = valueOf<libsumo::TraCIPosition>(results, libsumo::VAR_POSITION3D);
    if (placed(front)) vehicles_.push_back(vehicleFrom(id, results, front, dimensions));
  }
  dimensions_.erase(known, dimensions_.end());
}

void TrafficObserver::show(const traffic::SignalState& changed) {
  for (traffic::SignalState& signal : signals_) {
    if (signal.id == changed.id) signal.state = changed.state;
  }
}

void TrafficObserver::readSignals() {
  if (lights_green_) return;
  const libsumo::SubscriptionResults all = calls_.lightResults();
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

RightOfWay::RightOfWay(const map::RoadNetwork& network,
                       const std::vector<traffic::SignalState>& signals)
    : network_(network) {
  for (const traffic::SignalState& signal : signals) all_yield_.emplace(signal.id, signal.state);
  std::map<std::string, int> known;
  for (const map::Lane& lane : network.lanes()) {
    const bool counts =
        !lane.junction_id.empty() && (lane.internal || endsAtJunction(network, lane));
    if (!counts) {
      junction_of_lane_.push_back(-1);
      continue;
    }
    junction_of_lane_.push_back(
        known.emplace(lane.junction_id, static_cast<int>(known.size())).first->second);
  }
  junctions_.resize(known.size());
  for (std::size_t index = 0; index < junction_of_lane_.size(); ++index) {
    if (junction_of_lane_[index] < 0) continue;
    const map::Lane& lane = network.lanes()[index];
    JunctionState& junction = junctions_[static_cast<std::size_t>(junction_of_lane_[index])];
    for (const map::LaneLink& link : lane.next) {
      if (lane.internal || all_yield_.count(link.signal_id) == 0) continue;
      junction.signal_id = link.signal_id;
      junction.links[lane.edge_id].push_back(link.signal_link);
    }
  }
}

RightOfWayChanges RightOfWay::update(const std::vector<SimulatedVehicle>& vehicles,
                                     const IsDriven& is_driven, double step) {
  for (JunctionState& junction : junctions_) {
    junction.moving = junction.ours_coming = junction.ours_near = junction.ours_on_several = false;
    junction.queue_ahead_of_ours = false;
    junction.ours_edge.clear();
    junction.granted_gone = true;
    junction.first = nullptr;
    junction.first_rank = 0.0;
  }
  // Ours first: what they do decides who of the others may go.
  for (const bool ours : {true, false}) {
    for (const SimulatedVehicle& vehicle : vehicles) {
      if (is_driven(vehicle.id) == ours) look(vehicle, ours, step);
    }
  }
  RightOfWayChanges changes;
  for (JunctionState& junction : junctions_) {
    decide(junction, step, changes.vehicles);
    light(junction, changes.signals);
  }
  return changes;
}

void RightOfWay::look(const SimulatedVehicle& vehicle, bool ours, double step) {
  const map::LaneIndex index = network_.findLane(vehicle.lane_id);
  const int known = index == map::kNoLane ? -1 : junction_of_lane_[static_cast<std::size_t>(index)];
  if (known < 0 || vehicle.state.speed > kStandingQueue || ours) waiting_.erase(vehicle.id);
  if (known < 0) return;
  const map::Lane& lane = network_.lane(index);
  const Place place{junctions_[static_cast<std::size_t>(known)], lane,
                    lane.internal ? 0.0 : toLaneEnd(vehicle, lane)};
  if (ours) return lookAtOurs(vehicle, place);
  noteQueue(place);
  if (vehicle.id == place.junction.granted) {
    place.junction.granted_gone = false;
    place.junction.granted_stands = vehicle.state.speed <= kStandingQueue;
  }
  const double moving = place.lane.internal ? kMoving : kApproachSpeed;
  if (vehicle.state.speed > moving && place.to_end < kApproaching) place.junction.moving = true;
  if (vehicle.state.speed <= kStandingQueue && place.to_end <= kStopLine) {
    consider(vehicle, place, waiting_[vehicle.id] += step);
  }
}

void RightOfWay::lookAtOurs(const SimulatedVehicle& vehicle, const Place& place) {
  if (place.to_end > kOursApproaching) return;
  JunctionState& junction = place.junction;
  if (vehicle.state.speed > kMoving) junction.ours_coming = true;
  if (vehicle.state.speed > kMoving && place.to_end < kOursNear) junction.ours_near = true;
  if (!junction.ours_edge.empty() && junction.ours_edge != place.lane.edge_id)
    junction.ours_on_several = true;
  junction.ours_edge = place.lane.edge_id;
  junction.ours_to_end = place.to_end;
}

void RightOfWay::noteQueue(const Place& place) {
  JunctionState& junction = place.junction;
  const bool ahead =
      place.lane.edge_id == junction.ours_edge && place.to_end < junction.ours_to_end;
  if (ahead && !place.lane.internal) junction.queue_ahead_of_ours = true;
}

void RightOfWay::light(JunctionState& junction, std::vector<traffic::SignalState>& changes) const {
  if (junction.signal_id.empty()) return;
  const bool priority = junction.queue_ahead_of_ours && !junction.ours_on_several;
  const std::string wanted = priority ? junction.ours_edge : "";
  if (wanted == junction.priority_edge) return;
  junction.priority_edge = wanted;
  traffic::SignalState signal{junction.signal_id, all_yield_.at(junction.signal_id)};
  if (priority) {
    for (const int link : junction.links[wanted]) {
      const auto place = static_cast<std::size_t>(link);
      if (place < signal.state.size()) signal.state[place] = 'G';
    }
  }
  changes.push_back(signal);
}

void RightOfWay::consider(const SimulatedVehicle& vehicle, const Place& place, double wait) {
  JunctionState& junction = place.junction;
  const bool ahead_of_ours = place.lane.edge_id == junction.ours_edge && !junction.ours_on_several;
  const bool ours_first = place.lane.internal ? junction.ours_near : junction.ours_coming;
  if (ours_first && !ahead_of_ours) return;
  double rank = wait;
  if (place.lane.internal) rank += kInsideFirst;
  if (ahead_of_ours) rank += kAheadOfOursFirst;
  if (wait < kPatience || rank <= junction.first_rank) return;
  junction.first = &vehicle;
  junction.first_rank = rank;
  junction.first_edge = place.lane.edge_id;
}

void RightOfWay::decide(JunctionState& junction, double step,
                        std::vector<RightOfWayChange>& changes) {
  if (!junction.granted.empty()) {
    junction.granted_time += step;
    const bool blocks_ours = junction.ours_near && junction.granted_edge != junction.ours_edge;
    const double longest = junction.granted_stands ? kLongestStandingGrant : kLongestGrant;
    if (!junction.granted_gone && !blocks_ours && junction.granted_time <= longest) return;
    changes.push_back({junction.granted, false});
    waiting_.erase(junction.granted);
    junction.granted.clear();
    return;
  }
  if (junction.moving || junction.first == nullptr) return;
  junction.granted = junction.first->id;
  junction.granted_edge = junction.first_edge;
  junction.granted_time = 0.0;
  changes.push_back({junction.granted, true});
}

}  // namespace cdiff::simulation
