// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/session_services.h"

#include <cmath>
#include <functional>
#include <optional>
#include <regex>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"
#include "watch/page_command.h"

namespace cdiff::node_graph {
namespace {

using State = session::SessionControl::State;

constexpr std::uint32_t kThreads = 4;  // calls at a time
constexpr const char* kPace = "pace";
constexpr const char* kSpawnedName = "spawned";

msgs::Result resultOf(std::uint8_t code, const std::string& text = {}) {
  msgs::Result result;
  result.result = code;
  result.error_message = text;
  return result;
}

msgs::Result ok() { return resultOf(msgs::Result::RESULT_OK); }

/// What `change` refuses is the result's text, with this code.
msgs::Result resultFrom(const std::function<void()>& change, std::uint8_t refused) {
  try {
    change();
    return ok();
  } catch (const core::InputError& error) {
    return resultOf(refused, error.what());
  }
}

const msgs::Vehicle* findVehicle(const msgs::TrafficSnapshot& snapshot, const std::string& id) {
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.id == id) return &vehicle;
  }
  return nullptr;
}

msgs::EntityState stateOf(const msgs::Vehicle& vehicle, const msgs::TrafficSnapshot& snapshot) {
  msgs::EntityState state;
  const double heading = vehicle.state.heading;
  state.header.stamp = snapshot.header.stamp;
  state.header.frame_id = frameId(kMapFrame);
  state.pose.position.x = vehicle.state.x;
  state.pose.position.y = vehicle.state.y;
  state.pose.position.z = vehicle.state.z;
  state.pose.orientation.z = std::sin(0.5 * heading);
  state.pose.orientation.w = std::cos(0.5 * heading);
  state.twist.linear.x = vehicle.state.speed * std::cos(heading);
  state.twist.linear.y = vehicle.state.speed * std::sin(heading);
  state.twist.angular.z = vehicle.yaw_rate;
  state.acceleration.linear.x = vehicle.acceleration * std::cos(heading);
  state.acceleration.linear.y = vehicle.acceleration * std::sin(heading);
  return state;
}

/// Vehicles whose whole id matches. Throws std::regex_error.
std::vector<const msgs::Vehicle*> matching(const msgs::TrafficSnapshot& snapshot,
                                           const std::string& filter) {
  const std::regex expression(filter.empty() ? ".*" : filter, std::regex::extended);
  std::vector<const msgs::Vehicle*> vehicles;
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    if (std::regex_match(vehicle.id, expression)) vehicles.push_back(&vehicle);
  }
  return vehicles;
}

/// The vehicle standing at a pose, on the nearest lane outside junctions that leads its way;
/// nullopt where there is none.
std::optional<session::PlacedVehicle> placedAt(const map::RoadNetwork& network,
                                               const geometry_msgs::Pose& pose) {
  constexpr double kReach = 3.0;        // [m] from a centerline
  constexpr double kLargestTurn = 0.8;  // [rad] from its direction
  const auto& turn = pose.orientation;
  const double heading = std::atan2(2.0 * (turn.w * turn.z + turn.x * turn.y),
                                    1.0 - 2.0 * (turn.y * turn.y + turn.z * turn.z));
  const bool finite = std::isfinite(pose.position.x) && std::isfinite(pose.position.y) &&
                      std::isfinite(pose.position.z) && std::isfinite(heading);
  if (!finite) return std::nullopt;
  const double half = 0.5 * traffic::VehicleDimensions().length;
  for (const map::LaneMatch& match :
       network.lanesNear({pose.position.x, pose.position.y}, pose.position.z, kReach, heading)) {
    const map::Lane& lane = network.lane(match.lane);
    const double length = lane.centerline.length();
    const bool fits = !lane.internal && lane.routable && length >= 2.0 * half &&
                      std::abs(match.heading_difference) <= kLargestTurn;
    if (!fits) continue;
    const double center = std::min(std::max(match.projection.arc_length, half), length - half);
    return session::PlacedVehicle{"", lane.id, center, 0.0};
  }
  return std::nullopt;
}

/// Who calls, for the record: the metrics node asks for what the pages that it shows ask for.
std::string callerText(const std::string& caller) {
  return caller == siblingNode(kMetricsNode) ? watch::kLivePage : "node " + caller;
}

}  // namespace

SessionServices::SessionServices(session::SessionControl& control,
                                 const session::SessionSetup& setup)
    : control_(control), setup_(setup), reconfigure_(control, setup, queue_) {
  node_.setCallbackQueue(&queue_);
  offer<msgs::GetSimulationState>("get_simulation_state", &SessionServices::getState);
  offer<msgs::SetSimulationState>("set_simulation_state", &SessionServices::setState);
  offer<msgs::StepSimulation>("step_simulation", &SessionServices::step);
  offer<msgs::ResetSimulation>("reset_simulation", &SessionServices::reset);
  offer<msgs::SpawnEntity>("spawn_entity", &SessionServices::spawn);
  offer<msgs::DeleteEntity>("delete_entity", &SessionServices::remove);
  offer<msgs::GetEntities>("get_entities", &SessionServices::getEntities);
  offer<msgs::GetEntityState>("get_entity_state", &SessionServices::getEntity);
  offer<msgs::GetEntitiesStates>("get_entities_states", &SessionServices::getStates);
  offer<msgs::SetEntityState>("set_entity_state", &SessionServices::setEntity);
  offer<msgs::GetSimulatorFeatures>("get_simulator_features", &SessionServices::getFeatures);
  offer<msgs::SteerSession>("steer", &SessionServices::steer);
  threads_ = std::make_unique<ros::AsyncSpinner>(kThreads, &queue_);
  threads_->start();
}

/// A call that waits for steps is answered first.
SessionServices::~SessionServices() {
  control_.end();
  servers_.clear();
  threads_->stop();
}

template <class Service>
void SessionServices::offer(const std::string& name, Answer<Service> answer) {
  using Event = ros::ServiceEvent<typename Service::Request, typename Service::Response>;
  const boost::function<bool(Event&)> call = [this, answer](Event& event) {
    (this->*answer)(event.getRequest(), event.getResponse(), callerText(event.getCallerName()));
    return true;
  };
  servers_.push_back(node_.advertiseService<Event>(name, call));
}

void SessionServices::show(const Snapshot& snapshot) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_ = snapshot;
  }
  if (!snapshot->steering.empty()) reconfigure_.update();
}

SessionServices::Snapshot SessionServices::newest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_ ? newest_ : boost::make_shared<const msgs::TrafficSnapshot>();
}

void SessionServices::getState(const msgs::GetSimulationState::Request&,
                               msgs::GetSimulationState::Response& response, const std::string&) {
  using Code = msgs::SimulationState;
  const State state = control_.state();
  const bool ends = state == State::kOver || control_.quitting();
  response.state.state = ends                      ? Code::STATE_QUITTING
                         : state == State::kPaused ? Code::STATE_PAUSED
                                                   : Code::STATE_PLAYING;
  response.result = ok();
}

void SessionServices::setState(const msgs::SetSimulationState::Request& request,
                               msgs::SetSimulationState::Response& response, const std::string&) {
  using Code = msgs::SimulationState;
  using Response = msgs::SetSimulationState::Response;
  const std::uint8_t target = request.state.state;
  const auto refused = static_cast<std::uint8_t>(Response::STATE_TRANSITION_ERROR);
  if (target == Code::STATE_PAUSED) {
    response.result = resultFrom([this] { control_.pause(); }, refused);
  } else if (target == Code::STATE_PLAYING) {
    response.result = resultFrom([this] { control_.resume(); }, refused);
  } else if (target == Code::STATE_QUITTING) {
    control_.quit();
    response.result = ok();
  } else if (target == Code::STATE_STOPPED) {
    response.result = resultOf(msgs::Result::RESULT_FEATURE_UNSUPPORTED,
                               "a session runs once; start another one");
  } else {
    response.result = resultOf(Response::INCORRECT_TRANSITION,
                               "state " + std::to_string(target) + " cannot be set");
  }
  const State state = control_.state();  // another client may have set it meanwhile
  const bool there = (target == Code::STATE_PAUSED && state == State::kPaused) ||
                     (target == Code::STATE_PLAYING && state == State::kPlaying);
  if (response.result.result == refused && there)
    response.result.result = Response::ALREADY_IN_TARGET_STATE;
}

void SessionServices::step(const msgs::StepSimulation::Request& request,
                           msgs::StepSimulation::Response& response, const std::string&) {
  constexpr double kLook = 0.2;  // [s]
  response.result =
      resultFrom([&] { control_.step(request.steps); }, msgs::Result::RESULT_INCORRECT_STATE);
  if (response.result.result != msgs::Result::RESULT_OK) return;
  while (ros::ok() && !control_.awaitSteps(kLook)) {
  }
  if (control_.state() == State::kOver)
    response.result = resultOf(msgs::Result::RESULT_OPERATION_FAILED,
                               "the session ended before the last of the steps");
}

void SessionServices::reset(const msgs::ResetSimulation::Request&,
                            msgs::ResetSimulation::Response& response, const std::string&) {
  response.result =
      resultOf(msgs::Result::RESULT_FEATURE_UNSUPPORTED, "a session runs once; start another one");
}

/// `wanted`, or where it is taken the first of NAME_1, NAME_2 ... that is not.
std::string SessionServices::freeName(const std::string& wanted) const {
  const Snapshot snapshot = newest();
  std::string name = wanted;
  for (int i = 1; findVehicle(*snapshot, name) != nullptr; ++i)
    name = wanted + "_" + std::to_string(i);
  return name;
}

void SessionServices::spawn(const msgs::SpawnEntity::Request& request,
                            msgs::SpawnEntity::Response& response, const std::string& by) {
  using Response = msgs::SpawnEntity::Response;
  const auto refuse = [&](std::uint8_t code, const std::string& text) {
    response.result = resultOf(code, text);
  };
  const std::string& frame = request.initial_pose.header.frame_id;
  if (!request.entity_resource.empty())
    return refuse(Response::NO_RESOURCE, "there is one kind of vehicle; expected no resource");
  if (!request.entity_namespace.empty())
    return refuse(Response::NAMESPACE_INVALID, "a vehicle has no topics; expected no namespace");
  if (!frame.empty() && frame != frameId(kMapFrame) && frame != kMapFrame && frame != "world")
    return refuse(Response::INVALID_POSE, "frame '" + core::shortened(frame) + "'; expected map");
  std::string name = request.name.empty() ? std::string(kSpawnedName) + "_0" : request.name;
  if (request.allow_renaming || request.name.empty()) name = freeName(name);
  if (findVehicle(*newest(), name) != nullptr)
    return refuse(Response::NAME_NOT_UNIQUE, "vehicle '" + name + "' is there already");
  auto vehicle = placedAt(setup_.network(), request.initial_pose.pose);
  if (!vehicle)
    return refuse(Response::INVALID_POSE, "no lane outside junctions lies there in that direction");
  vehicle->id = name;
  response.result = resultFrom(
      [&] {
        control_.ask({by, session::steered::kPlace, session::toText(*vehicle)});
      },
      Response::NAME_INVALID);
  response.entity_name = name;
}

void SessionServices::remove(const msgs::DeleteEntity::Request& request,
                             msgs::DeleteEntity::Response& response, const std::string& by) {
  const bool there = findVehicle(*newest(), request.entity) != nullptr;
  response.result = resultFrom(
      [&] {
        control_.ask({by, session::steered::kRemove, request.entity});
      },
      there ? msgs::Result::RESULT_OPERATION_FAILED : msgs::Result::RESULT_NOT_FOUND);
}

void SessionServices::getEntities(const msgs::GetEntities::Request& request,
                                  msgs::GetEntities::Response& response, const std::string&) {
  const Snapshot snapshot = newest();
  try {
    for (const msgs::Vehicle* vehicle : matching(*snapshot, request.filters.filter))
      response.entities.push_back(vehicle->id);
    response.result = ok();
  } catch (const std::regex_error& error) {
    response.result = resultOf(msgs::Result::RESULT_OPERATION_FAILED,
                               "the filter is no regular expression: " + std::string(error.what()));
  }
}

void SessionServices::getEntity(const msgs::GetEntityState::Request& request,
                                msgs::GetEntityState::Response& response, const std::string&) {
  const Snapshot snapshot = newest();
  const msgs::Vehicle* vehicle = findVehicle(*snapshot, request.entity);
  response.result = ok();
  if (vehicle != nullptr) {
    response.state = stateOf(*vehicle, *snapshot);
  } else {
    response.result = resultOf(msgs::Result::RESULT_NOT_FOUND,
                               "vehicle '" + core::shortened(request.entity) + "' is not there");
  }
}

void SessionServices::getStates(const msgs::GetEntitiesStates::Request& request,
                                msgs::GetEntitiesStates::Response& response, const std::string&) {
  const Snapshot snapshot = newest();
  try {
    for (const msgs::Vehicle* vehicle : matching(*snapshot, request.filters.filter)) {
      response.entities.push_back(vehicle->id);
      response.states.push_back(stateOf(*vehicle, *snapshot));
    }
    response.result = ok();
  } catch (const std::regex_error& error) {
    response.result = resultOf(msgs::Result::RESULT_OPERATION_FAILED,
                               "the filter is no regular expression: " + std::string(error.what()));
  }
}

void SessionServices::setEntity(const msgs::SetEntityState::Request&,
                                msgs::SetEntityState::Response& response, const std::string&) {
  response.result = resultOf(msgs::Result::RESULT_FEATURE_UNSUPPORTED,
                             "vehicles do not jump; delete it and spawn another one");
}

void SessionServices::getFeatures(const msgs::GetSimulatorFeatures::Request&,
                                  msgs::GetSimulatorFeatures::Response& response,
                                  const std::string&) {
  using Feature = msgs::SimulatorFeatures;
  response.features.features = {Feature::SPAWNING,
                                Feature::DELETING,
                                Feature::ENTITY_STATE_GETTING,
                                Feature::SIMULATION_STATE_GETTING,
                                Feature::SIMULATION_STATE_SETTING,
                                Feature::SIMULATION_STATE_PAUSE,
                                Feature::STEP_SIMULATION_SINGLE,
                                Feature::STEP_SIMULATION_MULTIPLE};
  response.features.custom_info =
      "e2e_cdiff: the service steer (e2e_cdiff/SteerSession) changes guidance, target speed, pace "
      "and CBVs";
  response.result = ok();
}

void SessionServices::steer(const msgs::SteerSession::Request& request,
                            msgs::SteerSession::Response& response, const std::string& by) {
  const auto change = [&] {
    if (request.what != kPace) return control_.ask({by, request.what, request.value});
    const auto pace = core::parseNumber(request.value);
    if (!pace)
      throw core::InputError("pace '" + core::shortened(request.value) + "'; expected a number");
    control_.setPace(*pace);
  };
  response.result = resultFrom(change, msgs::Result::RESULT_OPERATION_FAILED);
}

}  // namespace cdiff::node_graph
