// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::storyboard {

// An OpenSCENARIO file as data: what is there, and what happens when. Lengths in meters, times in
// seconds, angles in radians counter-clockwise, world positions as in the OpenDRIVE file.

/// Where an element stands.
struct Source {
  std::string file;
  int line = 0;

  std::string text() const { return file + ":" + std::to_string(line); }
};

/// A position, in the terms in which the file gives it.
struct Position {
  enum class Kind {
    kWorld,
    kLane,
    kRoad,
    kRoute,
    kObject,
    kRelativeWorld,
    kRelativeLane,
    kRelativeRoad
  };

  Kind kind = Kind::kWorld;
  Source source;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world, or the differences dx, dy, dz
  bool level = false;                               ///< whether a world position gives z
  std::string entity;                               ///< that a relative position refers to
  std::string road;                                 ///< id of the road
  int lane = 0;                                     ///< id of the lane, or number of lanes beside
  std::vector<Position> route;                      ///< that s counts along
  double s = 0.0;                                   ///< or ds
  double t = 0.0;                                   ///< t, dt, or offset in the lane
  double heading = 0.0;                             ///< absolute, or relative to the reference
  bool absolute_heading = false;
  bool oriented = false;  ///< whether the file gives a heading
};

/// How a value gets from where it is to its target.
struct Dynamics {
  enum class Shape { kStep, kLinear, kCubic, kSinusoidal };
  enum class Dimension { kTime, kDistance, kRate, kAcceleration };

  Shape shape = Shape::kStep;
  Dimension dimension = Dimension::kTime;
  double value = 0.0;  ///< [s], [m], or at most the target's unit per second or second squared
};

/// Places an entity.
struct TeleportAction {
  Position to;
};

/// Changes the speed to `value` [m/s], or to that of `entity` plus or times it.
struct SpeedAction {
  Dynamics dynamics;
  double value = 0.0;
  std::string entity;  ///< empty: `value` is absolute
  bool factor = false;
  bool continuous = false;
};

/// Changes to a lane: `lane` is its id, or where `entity` is given, lanes to the left of that
/// entity's lane.
struct LaneChangeAction {
  Dynamics dynamics;
  int lane = 0;
  std::string entity;
  double offset = 0.0;  ///< from the middle of the lane, to the left of the road [m]
};

/// Moves beside the middle of the present lane [m, to the left].
struct LaneOffsetAction {
  Dynamics dynamics;
  double value = 0.0;
  bool continuous = false;  ///< never ends by itself
};

/// Drives along lanes through these positions.
struct RouteAction {
  std::vector<Position> waypoints;
};

/// One point of a trajectory.
struct TrajectoryVertex {
  double time = 0.0;  ///< [s], where the trajectory has times
  Position position;
};

/// A curve whose curvature changes evenly.
struct Clothoid {
  double curvature = 0.0;  ///< at its start, positive left [1/m]
  double change = 0.0;     ///< of the curvature along the curve [1/m^2]
  double length = 0.0;     ///< [m]
};

/// A rational B-spline (NURBS).
struct Spline {
  std::size_t order = 4;        ///< degree plus 1
  std::vector<double> weights;  ///< of its control points
  std::vector<double> knots;    ///< never falling, one for each control point and `order` more
};

/// Follows a line: at its times, or without them at the present speed.
struct FollowTrajectoryAction {
  std::vector<TrajectoryVertex> vertices;  ///< of a polyline, start and end of a clothoid (both at
                                           ///< its start), or control points of a spline
  std::optional<Clothoid> clothoid;
  std::optional<Spline> spline;
  bool timed = false;
  bool absolute = true;  ///< times count from the simulation's start, else from the action's
  double scale = 1.0;
  double offset = 0.0;  ///< [s]
};

/// How fast a speed changes at most, and how high it gets.
struct SpeedLimits {
  double acceleration = 3.0;                               ///< [m/s^2]
  double deceleration = 3.0;                               ///< [m/s^2]
  double speed = std::numeric_limits<double>::infinity();  ///< [m/s]
};

/// On which side of another entity one keeps its distance: that of the start, ahead or to the left
/// of it, behind or to the right of it.
enum class Side { kPresent, kAheadOrLeft, kBehindOrRight };

/// Keeps a distance [m] or a time gap [s] behind or ahead of an entity.
struct DistanceAction {
  std::string entity;
  double value = 0.0;
  bool time_gap = false;
  bool freespace = false;
  bool along_lanes = false;  ///< else along the own heading
  bool continuous = false;
  Side side = Side::kPresent;
  std::optional<SpeedLimits> limits;  ///< nullopt: at once, wherever that is
};

/// Keeps a distance [m] beside an entity, across the lanes.
struct LateralDistanceAction {
  std::string entity;
  std::optional<double> value;  ///< nullopt: the distance of the start
  bool freespace = false;
  bool continuous = false;
  Side side = Side::kPresent;
  double speed = std::numeric_limits<double>::infinity();  ///< across the lanes, at most [m/s]
};

/// Arrives at a place when another entity, the master, arrives at its own. The speed changes at an
/// even rate, so that the last part of the way is driven with the final speed.
struct SynchronizeAction {
  std::string master;
  Position master_target;
  Position target;
  double master_tolerance = 1.0;  ///< [m]
  double tolerance = 1.0;         ///< [m]
  std::optional<SpeedAction> final_speed;
  double steady_distance = 0.0;  ///< length of the last part [m]
  double steady_time = 0.0;      ///< or how long it takes [s]
};

/// Changes the speed several times, one after the other.
struct SpeedProfileAction {
  std::vector<SpeedAction> parts;
};

/// Adds an entity at a position, or takes it away.
struct EntityAction {
  std::string entity;
  std::optional<Position> place;  ///< nullopt: deleted
};

/// Sets, adds to or multiplies a parameter or a variable.
struct ParameterAction {
  enum class Change { kSet, kAdd, kMultiply };
  std::string name;
  Change change = Change::kSet;
  std::string value;
};

/// Gives an entity a controller of this name; in the storyboard's beginning alone.
struct ControllerAction {
  std::string controller;
};

/// Changes nothing that a session shows: weather, visibility, controllers of entities that the
/// storyboard moves.
struct NoAction {};

/// An action with its name.
struct Action {
  std::string name;
  Source source;
  std::variant<NoAction, TeleportAction, SpeedAction, LaneChangeAction, LaneOffsetAction,
               RouteAction, FollowTrajectoryAction, DistanceAction, LateralDistanceAction,
               SynchronizeAction, SpeedProfileAction, EntityAction, ParameterAction,
               ControllerAction>
      what;
};

/// How a measured value is compared with a given one.
enum class Rule { kGreater, kGreaterOrEqual, kLess, kLessOrEqual, kEqual, kNotEqual };

/// Simulated time [s].
struct TimeCondition {
  Rule rule = Rule::kGreater;
  double value = 0.0;
};

/// A parameter or a variable, compared as a number where both are numbers.
struct ParameterCondition {
  std::string name;
  Rule rule = Rule::kEqual;
  std::string value;
};

/// State or transition of an element of the storyboard.
struct ElementStateCondition {
  std::string type;     ///< story, act, maneuverGroup, maneuver, event or action
  std::string element;  ///< name; "A::B" names B in A
  std::string state;    ///< runningState, endTransition ...
};

/// Stands for a condition that is not supported: it never holds.
struct NoCondition {};

/// A vehicle, pedestrian or object. Its reference point is the rear axle of a vehicle.
struct Entity {
  enum class Kind { kVehicle, kBicycle, kPedestrian, kObject };

  std::string name;
  Source source;
  Kind kind = Kind::kVehicle;
  traffic::VehicleDimensions dimensions;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< of the box, from the reference point [m]
  std::string controller;  ///< name of its controller; empty where it has none
};

/// Something that is measured of entities.
struct EntityCondition {
  enum class Measure {
    kSpeed,
    kRelativeSpeed,
    kAcceleration,
    kStandStill,
    kTraveledDistance,
    kReachPosition,
    kDistance,
    kHeadway,
    kTimeToCollision,
    kEndOfRoad,
    kOffroad,
    kCollision
  };
  enum class Along { kStraight, kLongitudinal, kLateral };

  std::vector<std::string> entities;
  bool all = false;  ///< of them, else any
  Measure measure = Measure::kSpeed;
  Rule rule = Rule::kGreater;
  double value = 0.0;                     ///< [m/s], [m/s^2], [s] or [m]
  std::string other;                      ///< entity; empty: a position, or for collisions anybody
  std::vector<Entity::Kind> other_kinds;  ///< collisions with any of these; empty: of any kind
  std::optional<Position> place;
  bool freespace = false;   ///< between boxes, else between reference points
  bool lane_frame = false;  ///< along the lanes, else in the entity's own frame
  Along along = Along::kStraight;
};

/// A condition of a trigger.
struct Condition {
  enum class Edge { kNone, kRising, kFalling, kRisingOrFalling };

  std::string name;
  Source source;
  Edge edge = Edge::kNone;
  double delay = 0.0;  ///< [s]
  std::variant<NoCondition, TimeCondition, ParameterCondition, ElementStateCondition,
               EntityCondition>
      what;
};

/// Fires when all conditions of one of its groups hold; never without a group.
struct Trigger {
  std::vector<std::vector<Condition>> groups;
};

/// Actions that start together.
struct Event {
  enum class Priority { kOverride, kSkip, kParallel };

  std::string name;
  Priority priority = Priority::kOverride;
  int executions = 1;  ///< at most
  std::vector<Action> actions;
  std::optional<Trigger> start;  ///< nullopt: at once
};

/// Events of one maneuver.
struct Maneuver {
  std::string name;
  std::vector<Event> events;
};

/// Maneuvers and who performs them.
struct ManeuverGroup {
  std::string name;
  int executions = 1;
  std::vector<std::string> actors;
  std::vector<Maneuver> maneuvers;
};

/// Maneuver groups that start with the act.
struct Act {
  std::string name;
  std::vector<ManeuverGroup> groups;
  std::optional<Trigger> start;
  std::optional<Trigger> stop;
};

/// Acts that may run beside each other.
struct Story {
  std::string name;
  std::vector<Act> acts;
};

/// An action of the storyboard's beginning.
struct InitAction {
  std::string entity;  ///< empty for a global action
  Action action;
};

/// A whole file with its catalogs.
struct Scenario {
  std::vector<std::string> files;  ///< its own and those of its catalogs
  std::string name;
  std::string network;  ///< path of the OpenDRIVE or SUMO file, or a name where no file is there
  Source network_source;
  std::map<std::string, std::string> parameters;
  std::vector<Entity> entities;
  std::vector<InitAction> init;
  std::vector<Story> stories;
  std::optional<Trigger> stop;
  bool ends_with_stories = false;    ///< it is over when they are complete, too
  std::vector<std::string> ignored;  ///< what is not supported, with file and line

  /// The entity with this name, or nullptr.
  const Entity* find(const std::string& entity) const {
    for (const Entity& known : entities)
      if (known.name == entity) return &known;
    return nullptr;
  }
};

}  // namespace cdiff::storyboard
