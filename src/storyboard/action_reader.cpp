// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "storyboard/reading.h"

namespace cdiff::storyboard {
namespace {

using ActionWhat = decltype(Action::what);

Dynamics::Shape readShape(const XoscElement& element) {
  using Shape = Dynamics::Shape;
  constexpr Shape kShapes[] = {Shape::kStep, Shape::kLinear, Shape::kCubic, Shape::kSinusoidal};
  return kShapes[element.choice("dynamicsShape", {"step", "linear", "cubic", "sinusoidal"})];
}

/// In scenario_runner a step lasts as long as its value says, and takes effect at once.
Dynamics readDynamics(const XoscElement& element, const Reading& reading) {
  using Dimension = Dynamics::Dimension;
  constexpr Dimension kDimensions[] = {Dimension::kTime, Dimension::kDistance, Dimension::kRate};
  Dynamics dynamics;
  dynamics.shape = readShape(element);
  if (dynamics.shape == Dynamics::Shape::kStep && (!reading.carla || !element.has("value")))
    return dynamics;
  dynamics.dimension =
      kDimensions[element.choice("dynamicsDimension", {"time", "distance", "rate"})];
  const double value = element.number("value");
  if (value < 0.0 && dynamics.dimension != Dimension::kRate)
    element.fail("'value' is below 0; expected seconds or meters");
  dynamics.value = std::abs(value);  // the target says which way a rate goes
  return dynamics;
}

ActionWhat readTeleport(const XoscElement& element, Reading& reading) {
  return TeleportAction{readPosition(element, reading)};
}

ActionWhat readSpeed(const XoscElement& element, Reading& reading) {
  SpeedAction action;
  action.dynamics = readDynamics(element.child("SpeedActionDynamics"), reading);
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

ActionWhat readLaneChange(const XoscElement& element, Reading& reading) {
  LaneChangeAction action;
  action.dynamics = readDynamics(element.child("LaneChangeActionDynamics"), reading);
  action.offset = element.number("targetLaneOffset", 0.0);
  const XoscElement target = element.child("LaneChangeTarget").only();
  action.lane = target.integer("value");
  if (target.name() == "RelativeTargetLane") action.entity = target.text("entityRef");
  return action;
}

/// Without a largest acceleration the offset changes at the usual speed.
Dynamics readOffsetDynamics(const XoscElement& element) {
  constexpr double kUsual = 1.0;  // [m/s] across the lane
  Dynamics dynamics;
  dynamics.shape = readShape(element);
  dynamics.dimension = Dynamics::Dimension::kRate;
  dynamics.value = kUsual;
  const double acceleration = element.limit("maxLateralAcc", 0.0);
  const bool curved =
      dynamics.shape == Dynamics::Shape::kCubic || dynamics.shape == Dynamics::Shape::kSinusoidal;
  if (!curved || acceleration <= 0.0) return dynamics;
  dynamics.dimension = Dynamics::Dimension::kAcceleration;
  dynamics.value = acceleration;
  return dynamics;
}

/// scenario_runner, for which files with CARLA's axes are made, counts the offset to the right.
ActionWhat readLaneOffset(const XoscElement& element, Reading& reading) {
  LaneOffsetAction action;
  action.continuous = element.flag("continuous", false);
  action.dynamics = readOffsetDynamics(element.child("LaneOffsetActionDynamics"));
  const XoscElement target = element.child("LaneOffsetTarget").only();
  if (target.name() != "AbsoluteTargetLaneOffset")
    Reading::refuse(target, "an offset from another vehicle's");
  action.value = (reading.carla ? -1.0 : 1.0) * target.number("value");
  return action;
}

ActionWhat readAcquirePosition(const XoscElement& element, Reading& reading) {
  return RouteAction{{readPosition(element, reading)}};
}

ActionWhat readAssignRoute(const XoscElement& element, Reading& reading) {
  return RouteAction{readWaypoints(element.only(), reading)};
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

void readVertices(const XoscElement& shape, const char* name, const Reading& reading,
                  FollowTrajectoryAction& action) {
  for (const XoscElement& vertex : shape.children(name))
    action.vertices.push_back({vertex.number("time", 0.0), readPosition(vertex, reading)});
  if (action.vertices.size() < 2) shape.fail("expected at least two vertices");
}

/// No more points than memory has, and none that is not finite.
void requireUsable(const Clothoid& curve, const XoscElement& shape) {
  constexpr double kMostLength = 5e4;      // [m]
  constexpr double kMostCurvature = 10.0;  // [1/m]
  if (curve.length <= 0.0 || curve.length > kMostLength)
    shape.fail("'length' is not above 0 and up to " + core::formatNumber(kMostLength) + " m");
  const double end = curve.curvature + curve.change * curve.length;
  if (std::max(std::abs(curve.curvature), std::abs(end)) > kMostCurvature) {
    shape.fail("the curvature at an end is above " + core::formatNumber(kMostCurvature) +
               " per meter");
  }
}

/// Its curvature is that of CARLA's coordinates where the file has them.
void readClothoid(const XoscElement& shape, const Reading& reading,
                  FollowTrajectoryAction& action) {
  const double side = reading.carla ? -1.0 : 1.0;
  const char* const change = shape.has("curvaturePrime") ? "curvaturePrime" : "curvatureDot";
  action.clothoid = {side * shape.number("curvature"), side * shape.number(change),
                     shape.number("length")};
  requireUsable(*action.clothoid, shape);
  const Position start = readPosition(shape, reading);
  action.timed = action.timed && shape.has("stopTime");
  action.vertices = {{shape.number("startTime", 0.0), start},
                     {shape.number("stopTime", 0.0), start}};
}

void readSpline(const XoscElement& shape, const Reading& reading, FollowTrajectoryAction& action) {
  readVertices(shape, "ControlPoint", reading, action);
  Spline spline;
  spline.order = static_cast<std::size_t>(std::clamp(shape.integer("order"), 0, 100));
  for (const XoscElement& point : shape.children("ControlPoint"))
    spline.weights.push_back(point.number("weight", 1.0));
  for (const XoscElement& knot : shape.children("Knot"))
    spline.knots.push_back(knot.number("value"));
  const std::size_t points = action.vertices.size();
  if (spline.order < 2 || spline.order > points)
    shape.fail("'order' is not between 2 and the number of control points");
  if (spline.knots.size() != points + spline.order ||
      !std::is_sorted(spline.knots.begin(), spline.knots.end()))
    shape.fail("expected " + std::to_string(points + spline.order) + " knots that never fall");
  if (spline.knots[spline.order - 1] >= spline.knots[points])
    shape.fail("the knots do not rise between the first " + std::to_string(spline.order) +
               " and the last; expected a curve with a length");
  if (*std::min_element(spline.weights.begin(), spline.weights.end()) <= 0.0)
    shape.fail("expected weights above 0");
  action.spline = std::move(spline);
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
  readTiming(element, action);
  if (shape.name() == "Clothoid") {
    readClothoid(shape, reading, action);
  } else if (shape.name() == "Nurbs") {
    readSpline(shape, reading, action);
  } else if (shape.name() == "Polyline") {
    readVertices(shape, "Vertex", reading, action);
  } else {
    Reading::refuse(shape, "a trajectory of this shape");
  }
  for (std::size_t i = 1; action.timed && i < action.vertices.size(); ++i)
    if (action.vertices[i].time <= action.vertices[i - 1].time)
      shape.fail("the time of vertex " + std::to_string(i + 1) + " is not after the one before");
  return action;
}

Side readSide(const XoscElement& element, const char* ahead, const char* behind) {
  if (!element.has("displacement")) return Side::kPresent;
  constexpr Side kSides[] = {Side::kPresent, Side::kAheadOrLeft, Side::kBehindOrRight};
  return kSides[element.choice("displacement", {"any", ahead, behind})];
}

SpeedLimits readLimits(const XoscElement& element) {
  SpeedLimits limits;
  limits.acceleration = element.limit("maxAcceleration", limits.acceleration);
  limits.deceleration = element.limit("maxDeceleration", limits.acceleration);
  limits.speed = element.limit("maxSpeed", limits.speed);
  if (std::min({limits.acceleration, limits.deceleration, limits.speed}) < 0.0)
    element.fail("expected limits of at least 0");
  return limits;
}

ActionWhat readDistance(const XoscElement& element, Reading&) {
  DistanceAction action;
  action.entity = element.text("entityRef");
  action.time_gap = element.has("timeGap");
  action.value = element.number(action.time_gap ? "timeGap" : "distance");
  action.freespace = element.flag("freespace", false);
  action.along_lanes = Reading::isAlongLanes(element);
  action.continuous = element.flag("continuous", false);
  action.side = readSide(element, "leadingReferencedEntity", "trailingReferencedEntity");
  if (const auto limits = element.find("DynamicConstraints")) action.limits = readLimits(*limits);
  return action;
}

/// Its largest acceleration has no effect. Distances count across the lanes, whatever the frame.
ActionWhat readLateralDistance(const XoscElement& element, Reading&) {
  constexpr double kUsual = 1.0;  // [m/s] across the lanes, where only an acceleration is given
  LateralDistanceAction action;
  action.entity = element.text("entityRef");
  Reading::isAlongLanes(element);
  if (element.has("distance")) action.value = element.number("distance");
  action.freespace = element.flag("freespace", false);
  action.continuous = element.flag("continuous", false);
  action.side = readSide(element, "leftToReferencedEntity", "rightToReferencedEntity");
  if (const auto limits = element.find("DynamicConstraints"))
    action.speed = limits->limit("maxSpeed", kUsual);
  return action;
}

SpeedAction readFinalSpeed(const XoscElement& element) {
  SpeedAction speed;
  speed.value = element.number("value");
  if (element.name() == "RelativeSpeedToMaster") {
    speed.factor = element.choice("speedTargetValueType", {"delta", "factor"}) == 1;
    speed.continuous = true;  // with the master's speed
  }
  return speed;
}

ActionWhat readSynchronize(const XoscElement& element, Reading& reading) {
  SynchronizeAction action;
  action.master = element.text("masterEntityRef");
  action.master_target = readOnlyPosition(element.child("TargetPositionMaster"), reading);
  action.target = readOnlyPosition(element.child("TargetPosition"), reading);
  action.master_tolerance = element.number("targetToleranceMaster", action.master_tolerance);
  action.tolerance = element.number("targetTolerance", action.tolerance);
  const auto last = element.find("FinalSpeed");
  if (!last) return action;
  const XoscElement speed = last->only();
  action.final_speed = readFinalSpeed(speed);
  if (const auto steady = speed.find("TargetDistanceSteadyState"))
    action.steady_distance = steady->number("distance");
  if (const auto steady = speed.find("TargetTimeSteadyState"))
    action.steady_time = steady->number("time");
  return action;
}

/// A speed without a time is reached as fast as the limits allow.
ActionWhat readProfile(const XoscElement& element, Reading&) {
  if (element.has("entityRef")) Reading::refuse(element, "a profile of relative speeds");
  const auto constraints = element.find("DynamicConstraints");
  const SpeedLimits limits = constraints ? readLimits(*constraints) : SpeedLimits{};
  SpeedProfileAction action;
  for (const XoscElement& entry : element.children("SpeedProfileEntry")) {
    SpeedAction part;
    part.value = entry.number("speed");
    if (part.value < 0.0) Reading::refuse(entry, "driving backward");
    const bool timed = entry.has("time");
    part.dynamics = {Dynamics::Shape::kLinear,
                     timed ? Dynamics::Dimension::kTime : Dynamics::Dimension::kRate,
                     timed ? std::max(0.0, entry.number("time")) : limits.acceleration};
    action.parts.push_back(part);
  }
  if (action.parts.empty()) element.fail("expected at least one <SpeedProfileEntry>");
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
  if (modified) change.number("value");
  action.value = change.text("value");
  return action;
}

ActionWhat readController(const XoscElement& element, Reading& reading) {
  return ControllerAction{readControllerName(element.only(), reading)};
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
                                  {"LateralDistanceAction", readLateralDistance},
                                  {"SpeedProfileAction", readProfile},
                                  {"SynchronizeAction", readSynchronize},
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
  while (isWrapper(element.name())) element = unwrapped(element);
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
