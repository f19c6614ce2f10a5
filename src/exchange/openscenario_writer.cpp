// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/openscenario_writer.h"

#include "core/text.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "exchange/xml_tree.h"

namespace cdiff::exchange {
namespace {

using core::formatNumber;
using pugi::xml_node;

/// The result does not say when it was made; the files need a date.
constexpr const char* kNoDate = "1970-01-01T00:00:00";

void addHeader(xml_node root, const RecordedScene& scene) {
  const SceneFacts& facts = scene.facts;
  const xml_node header =
      append(root, "FileHeader",
             {{"author", "e2e_cdiff"},
              {"date", kNoDate},
              {"description", "Recorded session of " + facts.scenario + ", seed " +
                                  std::to_string(facts.seed) + ", mode " + facts.mode},
              {"revMajor", "1"},
              {"revMinor", "2"}});
  const xml_node properties = append(header, "Properties");
  const auto add = [&](const char* name, const std::string& value) {
    append(properties, "Property", {{"name", name}, {"value", value}});
  };
  add("scenario", facts.scenario);
  add("seed", std::to_string(facts.seed));
  add("mode", facts.mode);
  add("method", facts.method);
  add("ego_planner", facts.ego_planner);
  add("cbv_planner", facts.cbv_planner);
  add("verdict", facts.verdict);
  add("trace_sha256", facts.trace_sha256);
}

void addAxle(xml_node axles, const char* name, double x, double width) {
  constexpr double kWheel = 0.65;        // diameter [m]
  constexpr double kTrackShare = 0.85;   // of the width
  constexpr double kMostSteering = 0.6;  // [rad]
  append(axles, name,
         {{"maxSteering", formatNumber(x > 0.0 ? kMostSteering : 0.0)},
          {"positionX", formatNumber(x)},
          {"positionZ", formatNumber(0.5 * kWheel)},
          {"trackWidth", formatNumber(kTrackShare * width)},
          {"wheelDiameter", formatNumber(kWheel)}});
}

/// The vehicle's box and axles, from its rear axle.
void addBody(xml_node object, const SceneVehicle& vehicle) {
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  const xml_node body =
      append(object, "Vehicle",
             {{"name", vehicle.id}, {"vehicleCategory", vehicleWord(size)}, {"mass", "1500"}});
  const xml_node box = append(body, "BoundingBox");
  append(box, "Center",
         {{"x", formatNumber(rearAxleToCenter(size))},
          {"y", "0"},
          {"z", formatNumber(0.5 * size.height)}});
  append(box, "Dimensions",
         {{"height", formatNumber(size.height)},
          {"length", formatNumber(size.length)},
          {"width", formatNumber(size.width)}});
  append(body, "Performance",
         {{"maxAcceleration", "10"}, {"maxDeceleration", "10"}, {"maxSpeed", "70"}});
  const xml_node axles = append(body, "Axles");
  addAxle(axles, "FrontAxle", 2.0 * rearAxleToCenter(size), size.width);
  addAxle(axles, "RearAxle", 0.0, size.width);
  const xml_node properties = append(body, "Properties");
  append(properties, "Property", {{"name", "role"}, {"value", traffic::toText(vehicle.role)}});
}

bool isExternal(const SceneVehicle& vehicle, ExportedEgo ego) {
  return ego == ExportedEgo::kExternal && vehicle.role == traffic::VehicleRole::kEgo;
}

void addObject(xml_node entities, const SceneVehicle& vehicle, ExportedEgo ego) {
  const xml_node object = append(entities, "ScenarioObject", {{"name", vehicle.id}});
  addBody(object, vehicle);
  if (!isExternal(vehicle, ego)) return;
  const xml_node controller =
      append(append(object, "ObjectController"), "Controller", {{"name", "external_control"}});
  append(controller, "Properties");
}

/// The place of the rear axle.
void addPosition(xml_node parent, const SceneVehicle& vehicle, const SceneState& state) {
  const Eigen::Vector2d axle = state.pose.position - rearAxleToCenter(vehicle.dimensions) *
                                                         geometry::direction(state.pose.heading);
  append(append(parent, "Position"), "WorldPosition",
         {{"x", formatNumber(axle.x())},
          {"y", formatNumber(axle.y())},
          {"z", formatNumber(state.pose.elevation)},
          {"h", formatNumber(state.pose.heading)}});
}

void addEnvironment(xml_node actions) {
  const xml_node environment = append(append(append(actions, "GlobalAction"), "EnvironmentAction"),
                                      "Environment", {{"name", "clear_noon"}});
  append(environment, "TimeOfDay", {{"animation", "false"}, {"dateTime", "2020-06-21T12:00:00"}});
  const xml_node weather = append(environment, "Weather", {{"fractionalCloudCover", "zeroOktas"}});
  append(weather, "Sun", {{"azimuth", "3.14"}, {"elevation", "1.05"}, {"intensity", "1"}});
  append(weather, "Fog", {{"visualRange", "100000"}});
  append(weather, "Precipitation", {{"precipitationType", "dry"}, {"precipitationIntensity", "0"}});
  append(environment, "RoadCondition", {{"frictionScaleFactor", "1"}});
}

/// Place and speed of a vehicle that is there when the scene begins.
void addStart(xml_node actions, const SceneVehicle& vehicle, ExportedEgo ego) {
  const SceneState& state = vehicle.states.front();
  if (state.step > 0) return;
  const xml_node start = append(actions, "Private", {{"entityRef", vehicle.id}});
  addPosition(append(append(start, "PrivateAction"), "TeleportAction"), vehicle, state);
  const xml_node speed =
      append(append(append(start, "PrivateAction"), "LongitudinalAction"), "SpeedAction");
  append(speed, "SpeedActionDynamics",
         {{"dynamicsDimension", "time"}, {"dynamicsShape", "step"}, {"value", "0"}});
  append(append(speed, "SpeedActionTarget"), "AbsoluteTargetSpeed",
         {{"value", formatNumber(state.pose.speed)}});
  if (!isExternal(vehicle, ego)) return;
  append(append(append(start, "PrivateAction"), "ControllerAction"), "ActivateControllerAction",
         {{"lateral", "true"}, {"longitudinal", "true"}});
}

/// A trigger that fires from a time of the scene on [s].
void addTrigger(xml_node parent, const char* name, const std::string& condition, double seconds) {
  const xml_node group = append(append(parent, name), "ConditionGroup");
  const xml_node node =
      append(group, "Condition", {{"conditionEdge", "none"}, {"delay", "0"}, {"name", condition}});
  append(append(node, "ByValueCondition"), "SimulationTimeCondition",
         {{"rule", "greaterOrEqual"}, {"value", formatNumber(seconds)}});
}

void addCourse(xml_node action, const RecordedScene& scene, const SceneVehicle& vehicle) {
  const xml_node follow =
      append(append(append(action, "PrivateAction"), "RoutingAction"), "FollowTrajectoryAction");
  const xml_node trajectory = append(append(follow, "TrajectoryRef"), "Trajectory",
                                     {{"closed", "false"}, {"name", "course_" + vehicle.id}});
  const xml_node line = append(append(trajectory, "Shape"), "Polyline");
  for (const SceneState& state : vehicle.states) {
    const xml_node vertex =
        append(line, "Vertex", {{"time", formatNumber(scene.seconds(state.step))}});
    addPosition(vertex, vehicle, state);
  }
  append(append(follow, "TimeReference"), "Timing",
         {{"domainAbsoluteRelative", "absolute"}, {"offset", "0"}, {"scale", "1"}});
  append(follow, "TrajectoryFollowingMode", {{"followingMode", "position"}});
}

xml_node addEvent(xml_node maneuver, const std::string& name) {
  return append(maneuver, "Event",
                {{"maximumExecutionCount", "1"}, {"name", name}, {"priority", "parallel"}});
}

/// An action that adds or deletes the vehicle.
xml_node addEntityAction(xml_node event, const SceneVehicle& vehicle, const std::string& name) {
  return append(append(append(event, "Action", {{"name", name}}), "GlobalAction"), "EntityAction",
                {{"entityRef", vehicle.id}});
}

/// The vehicle appears, follows its course and goes.
void addManeuver(xml_node group, const RecordedScene& scene, const SceneVehicle& vehicle) {
  const std::string& id = vehicle.id;
  const SceneState& first = vehicle.states.front();
  const SceneState& last = vehicle.states.back();
  const xml_node maneuver = append(group, "Maneuver", {{"name", "maneuver_" + id}});
  const xml_node drive = addEvent(maneuver, "drive_" + id);
  if (first.step > 0) {
    const xml_node added = addEntityAction(drive, vehicle, "add_" + id);
    addPosition(append(added, "AddEntityAction"), vehicle, first);
  }
  addCourse(append(drive, "Action", {{"name", "follow_" + id}}), scene, vehicle);
  addTrigger(drive, "StartTrigger", "begin_" + id, scene.seconds(first.step));
  if (last.step >= scene.steps) return;
  const xml_node leave = addEvent(maneuver, "leave_" + id);
  append(addEntityAction(leave, vehicle, "delete_" + id), "DeleteEntityAction");
  addTrigger(leave, "StartTrigger", "end_" + id, scene.seconds(last.step + 1));
}

void addAct(xml_node story, const RecordedScene& scene, const SceneVehicle& vehicle) {
  const xml_node act = append(story, "Act", {{"name", "act_" + vehicle.id}});
  const xml_node group = append(act, "ManeuverGroup",
                                {{"maximumExecutionCount", "1"}, {"name", "group_" + vehicle.id}});
  append(append(group, "Actors", {{"selectTriggeringEntities", "false"}}), "EntityRef",
         {{"entityRef", vehicle.id}});
  addManeuver(group, scene, vehicle);
  addTrigger(act, "StartTrigger", "act_begin_" + vehicle.id, 0.0);
}

}  // namespace

double rearAxleToCenter(const traffic::VehicleDimensions& dimensions) {
  return kAxleShare * dimensions.length;
}

std::string openScenarioText(const RecordedScene& scene, const std::string& network_file,
                             ExportedEgo ego) {
  std::vector<SceneVehicle> vehicles;  // a polyline needs two vertices
  for (const SceneVehicle& vehicle : scene.vehicles)
    if (vehicle.states.size() > 1) vehicles.push_back(vehicle);
  pugi::xml_document document;
  const xml_node root = append(document, "OpenSCENARIO");
  addHeader(root, scene);
  append(root, "CatalogLocations");
  append(append(root, "RoadNetwork"), "LogicFile", {{"filepath", network_file}});
  const xml_node entities = append(root, "Entities");
  for (const SceneVehicle& vehicle : vehicles) addObject(entities, vehicle, ego);
  const xml_node board = append(root, "Storyboard");
  const xml_node actions = append(append(board, "Init"), "Actions");
  addEnvironment(actions);
  for (const SceneVehicle& vehicle : vehicles) addStart(actions, vehicle, ego);
  const xml_node story = append(board, "Story", {{"name", "recorded"}});
  for (const SceneVehicle& vehicle : vehicles)
    if (!isExternal(vehicle, ego)) addAct(story, scene, vehicle);
  addTrigger(board, "StopTrigger", "scene_over", scene.duration());
  return documentText(document);
}

}  // namespace cdiff::exchange
