// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>

#include "storyboard/reading.h"

namespace cdiff::storyboard {
namespace {

using ActionWhat = decltype(Action::what);

Dynamics readDynamics(const XoscElement& element) {
  using Shape = Dynamics::Shape;
  using Dimension = Dynamics::Dimension;
  constexpr Shape kShapes[] = {Shape::kStep, Shape::kLinear, Shape::kCubic, Shape::kSinusoidal};
  constexpr Dimension kDimensions[] = {Dimension::kTime, Dimension::kDistance, Dimension::kRate};
  Dynamics dynamics;
  dynamics.shape =
      kShapes[element.choice("dynamicsShape", {"step", "linear", "cubic", "sinusoidal"})];
  if (dynamics.shape == Shape::kStep) return dynamics;
  dynamics.dimension =
      kDimensions[element.choice("dynamicsDimension", {"time", "distance", "rate"})];
  dynamics.value = std::abs(element.number("value"));
  return dynamics;
}

ActionWhat readTeleport(const XoscElement& element, Reading& reading) {
  return TeleportAction{readPosition(element, reading)};
}

ActionWhat readSpeed(const XoscElement& element, Reading&) {
  SpeedAction action;
  action.dynamics = readDynamics(element.child("SpeedActionDynamics"));
  const XoscElement target = element.child("SpeedActionTarget").only();
  action.value = target.number("value");
  if (target.name() == "RelativeTargetSpeed") {
    action.entity = target.text("entityRef");
    action.factor = target.choice("speedTargetValueType", {"delta", "factor"}) == 1;
    action.continuous = target.flag("continuous", false);
  } else if (action.value < 0.0) {
    Reading::refuse(target, "driving backward");
  }
  return action;
}

ActionWhat readLaneChange(const XoscElement& element, Reading&) {
  LaneChangeAction action;
  action.dynamics = readDynamics(element.child("LaneChangeActionDynamics"));
  action.offset = element.number("targetLaneOffset", 0.0);
  const XoscElement target = element.child("LaneChangeTarget").only();
  action.lane = target.integer("value");
  if (target.name() == "RelativeTargetLane") action.entity = target.text("entityRef");
  return action;
}

ActionWhat readLaneOffset(const XoscElement& element, Reading&) {
  LaneOffsetAction action;
  const XoscElement dynamics = element.child("LaneOffsetActionDynamics");
  constexpr double kUsual = 1.0;  // [m/s] across the lane, where only an acceleration is given
  action.dynamics.shape = dynamics.text("dynamicsShape") == "step" ? Dynamics::Shape::kStep
                                                                   : Dynamics::Shape::kSinusoidal;
  action.dynamics.dimension = Dynamics::Dimension::kRate;
  action.dynamics.value = kUsual;
  const XoscElement target = element.child("LaneOffsetTarget").only();
  if (target.name() != "AbsoluteTargetLaneOffset")
    Reading::refuse(target, "an offset from another vehicle's");
  action.value = target.number("value");
  return action;
}

ActionWhat readAcquirePosition(const XoscElement& element, Reading& reading) {
  return RouteAction{{readPosition(element, reading)}};
}

ActionWhat readAssignRoute(const XoscElement& element, Reading& reading) {
  const XoscElement route = reading.catalogs.resolve(element.only());
  RouteAction action;
  if (route.flag("closed", false)) Reading::refuse(route, "a closed route");
  for (const XoscElement& waypoint : route.children("Waypoint"))
    action.waypoints.push_back(readPosition(waypoint, reading));
  if (action.waypoints.empty()) route.fail("expected at least one <Waypoint>");
  return action;
}

void readTiming(const XoscElement& element, FollowTrajectoryAction& action) {
  const auto reference = element.find("TimeReference");
  const auto timing = reference ? reference->find("Timing") : std::nullopt;
  if (!timing) return;
  action.timed = true;
  action.absolute = timing->choice("domainAbsoluteRelative", {"absolute", "relative"}) == 0;
  action.scale = timing->number("scale");
  action.offset = timing->number("offset");
  if (action.scale <= 0.0) timing->fail("'scale' is not above 0");
}

ActionWhat readTrajectory(const XoscElement& element, Reading& reading) {
  FollowTrajectoryAction action;
  auto holder = element.find("TrajectoryRef");
  const XoscElement& parent = holder ? *holder : element;
  const auto direct = parent.find("Trajectory");
  const XoscElement trajectory =
      direct ? *direct : reading.catalogs.entry(parent.child("CatalogReference"));
  Reading::refuseAttributes(element, {"initialDistanceOffset"});
  if (trajectory.flag("closed", false)) Reading::refuse(trajectory, "a closed trajectory");
  const XoscElement shape = trajectory.child("Shape").only();
  if (shape.name() != "Polyline") Reading::refuse(shape, "a trajectory of this shape");
  readTiming(element, action);
  for (const XoscElement& vertex : shape.children("Vertex"))
    action.vertices.push_back({vertex.number("time", 0.0), readPosition(vertex, reading)});
  if (action.vertices.size() < 2) shape.fail("expected at least two vertices");
  for (std::size_t i = 1; action.timed && i < action.vertices.size(); ++i)
    if (action.vertices[i].time <= action.vertices[i - 1].time)
      shape.fail("the time of vertex " + std::to_string(i + 1) + " is not after the one before");
  return action;
}

ActionWhat readDistance(const XoscElement& element, Reading&) {
  DistanceAction action;
  action.entity = element.text("entityRef");
  action.time_gap = element.has("timeGap");
  action.value = element.number(action.time_gap ? "timeGap" : "distance");
  action.freespace = element.flag("freespace", false);
  action.continuous = element.flag("continuous", false);
  if (element.text("displacement", "any") != "any")
    Reading::refuse(element, "a 'displacement' other than 'any'");
  if (const auto limits = element.find("DynamicConstraints")) {
    Reading::refuseAttributes(*limits, {"maxDeceleration", "maxSpeed"});
    action.acceleration = limits->number("maxAcceleration", action.acceleration);
  }
  return action;
}

ActionWhat readEntityAction(const XoscElement& element, Reading& reading) {
  EntityAction action;
  action.entity = element.text("entityRef");
  const XoscElement inside = element.only();
  if (inside.name() == "AddEntityAction") action.place = readPosition(inside, reading);
  return action;
}

ActionWhat readParameter(const XoscElement& element, Reading&) {
  ParameterAction action;
  action.name =
      element.has("parameterRef") ? element.text("parameterRef") : element.text("variableRef");
  const XoscElement inside = element.only();
  const bool modified = inside.name().find("Modify") == 0;
  const XoscElement change = modified ? inside.child("Rule").only() : inside;
  const bool adds = change.name().find("Add") == 0;
  if (modified)
    action.change = adds ? ParameterAction::Change::kAdd : ParameterAction::Change::kMultiply;
  action.value = change.text("value");
  return action;
}

ActionWhat readController(const XoscElement& element, Reading& reading) {
  return ControllerAction{reading.catalogs.resolve(element.only()).text("name")};
}

ActionWhat readNothing(const XoscElement&, Reading&) { return NoAction{}; }

struct ActionRow {
  const char* element;
  ActionWhat (*read)(const XoscElement&, Reading&);  ///< nullptr: refused
};

constexpr ActionRow kActions[] = {{"TeleportAction", readTeleport},
                                  {"SpeedAction", readSpeed},
                                  {"LaneChangeAction", readLaneChange},
                                  {"LaneOffsetAction", readLaneOffset},
                                  {"AcquirePositionAction", readAcquirePosition},
                                  {"AssignRouteAction", readAssignRoute},
                                  {"FollowTrajectoryAction", readTrajectory},
                                  {"LongitudinalDistanceAction", readDistance},
                                  {"EntityAction", readEntityAction},
                                  {"ParameterAction", readParameter},
                                  {"VariableAction", readParameter},
                                  {"AssignControllerAction", readController},
                                  {"ActivateControllerAction", readNothing},
                                  {"OverrideControllerValueAction", readNothing},
                                  {"EnvironmentAction", readNothing},
                                  {"VisibilityAction", readNothing},
                                  {"AppearanceAction", readNothing},
                                  {"LateralDistanceAction", nullptr},
                                  {"SpeedProfileAction", nullptr},
                                  {"SynchronizeAction", nullptr},
                                  {"RandomRouteAction", nullptr},
                                  {"InfrastructureAction", nullptr},
                                  {"TrafficAction", nullptr},
                                  {"TrailerAction", nullptr},
                                  {"SetMonitorAction", nullptr},
                                  {"UserDefinedAction", nullptr}};

/// Elements around an action that say nothing themselves.
bool isWrapper(const std::string& name) {
  constexpr const char* kWrappers[] = {"Action",          "PrivateAction",      "GlobalAction",
                                       "LateralAction",   "LongitudinalAction", "RoutingAction",
                                       "ControllerAction"};
  return std::find(std::begin(kWrappers), std::end(kWrappers), name) != std::end(kWrappers);
}

/// What stands inside a wrapper. Version 1.0 puts an assignment and an override into one element.
XoscElement unwrapped(const XoscElement& wrapper) {
  const auto assigned = wrapper.find("AssignControllerAction");
  return wrapper.name() == "ControllerAction" && assigned ? *assigned : wrapper.only();
}

ActionWhat readWhat(XoscElement element, Reading& reading) {
  constexpr int kDeepest = 8;
  for (int depth = 0; isWrapper(element.name()); ++depth) {
    if (depth == kDeepest) element.fail("elements are nested too deeply; expected an action");
    element = unwrapped(element);
  }
  const auto& row = rowOf(kActions, element, "this action");
  return row.read(element, reading);
}

}  // namespace

Action readAction(const XoscElement& element, Reading& reading) {
  Action action{element.text("name", ""), element.source(), NoAction{}};
  try {
    action.what = readWhat(element, reading);
  } catch (const Unsupported& error) {
    reading.ignore(error);
  }
  return action;
}

std::vector<ElementSupport> actionSupport() {
  std::vector<ElementSupport> rows;
  for (const ActionRow& row : kActions) {
    const Support support = row.read == nullptr       ? Support::kRefused
                            : row.read == readNothing ? Support::kWithoutEffect
                                                      : Support::kSupported;
    rows.push_back({row.element, support});
  }
  return rows;
}

}  // namespace cdiff::storyboard
