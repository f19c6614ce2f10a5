// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/traffic_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "storyboard/curve.h"

namespace cdiff::storyboard {
namespace {

using Measure = EntityCondition::Measure;
using Along = EntityCondition::Along;

constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr SpeedLimits kUsualLimits{10.0, 10.0};

constexpr double kRounding = 0.1;  // [m] of a step's way

/// The speed [m/s] with which a change to the last one at an even rate covers a distance [m] in a
/// time [s]; without a last one the speed stays.
double speedToArrive(double meters, double seconds, std::optional<double> last) {
  if (meters <= 0.0 || seconds <= 0.0) return last.value_or(kUsualLimits.speed);
  const double mean = meters / seconds;
  return last ? std::max(0.0, 2.0 * mean - *last) : mean;
}

template <class Value>
bool compare(Rule rule, const Value& left, const Value& right) {
  switch (rule) {
    case Rule::kGreater:
      return left > right;
    case Rule::kGreaterOrEqual:
      return left >= right;
    case Rule::kLess:
      return left < right;
    case Rule::kLessOrEqual:
      return left <= right;
    case Rule::kEqual:
      return left == right;
    case Rule::kNotEqual:
      break;
  }
  return left != right;
}

/// With numbers that differ by less than a rounding counted as equal.
bool compareNumbers(Rule rule, double left, double right) {
  constexpr double kTolerance = 1e-6;
  return compare(rule, std::abs(left - right) < kTolerance ? right : left, right);
}

bool compareTexts(Rule rule, const std::string& left, const std::string& right) {
  const auto first = core::parseNumber(left);
  const auto second = core::parseNumber(right);
  return first && second ? compareNumbers(rule, *first, *second) : compare(rule, left, right);
}

/// Arc length on a line that goes straight on before its start and behind its end [m].
double extendedArcLength(const geometry::Polyline& line, const Eigen::Vector2d& place) {
  const double found = line.project(place).arc_length;
  const double end = found <= 0.0 ? 0.0 : line.length();
  if (found > 0.0 && found < end) return found;
  return end + geometry::direction(line.headingAt(end)).dot(place - line.positionAt(end));
}

/// Arc length, and distance to the left, of a place beside such a line [m].
Eigen::Vector2d besideLine(const geometry::Polyline& line, const Eigen::Vector2d& place) {
  const double s = extendedArcLength(line, place);
  return {s, line.extendedPoseAt(s).toBody(place).y()};
}

}  // namespace

TrafficStage::TrafficStage(const Scenario& scenario, const Places& places,
                           std::set<std::string> planned)
    : scenario_(scenario),
      places_(places),
      pose_of_([this](const std::string& entity) { return poseOf(entity); }),
      planned_(std::move(planned)),
      parameters_(scenario.parameters) {
  for (const Entity& entity : scenario.entities) {
    actors_[entity.name].actor = std::make_unique<Actor>(entity, places);
    actors_[entity.name].dimensions = entity.dimensions;
  }
}

void TrafficStage::begin() {
  for (const bool places : {true, false}) {  // entities are there before anything else happens
    for (const InitAction& init : scenario_.init) {
      if (std::holds_alternative<TeleportAction>(init.action.what) != places) continue;
      const std::vector<std::string> actors(init.entity.empty() ? 0 : 1, init.entity);
      begin(init.action, actors, 0.0);
    }
  }
}

// What is measured.

MapPose TrafficStage::poseOf(const std::string& entity) const {
  if (present(entity)) return member(entity).reference;
  throw core::InputError("the entity '" + entity + "' is not there at this time");
}

geometry::OrientedBox TrafficStage::boxOf(const std::string& entity) const {
  const Member& known = member(entity);
  const traffic::VehicleDimensions& size = known.dimensions;
  return {known.state.position, known.state.heading, size.length, size.width};
}

const map::Route* TrafficStage::routeOf(const std::string& entity) const {
  const Member& known = member(entity);
  return planned_.count(entity) != 0 ? known.planned_route : known.actor->route();
}

Eigen::Vector2d TrafficStage::velocityOf(const std::string& entity) const {
  return member(entity).state.velocity();
}

/// Distance along or across the lanes or the entity's own axes, never negative.
double TrafficStage::alongDistance(const EntityCondition& condition, const std::string& entity,
                                   const Eigen::Vector2d& target) const {
  const MapPose& own = member(entity).reference;
  const map::Route* const route = condition.lane_frame ? routeOf(entity) : nullptr;
  Eigen::Vector2d difference = own.pose.toBody(target);
  if (route != nullptr)
    difference = besideLine(route->path(), target) - besideLine(route->path(), own.pose.position);
  const bool lateral = condition.along == Along::kLateral;
  const double found = std::abs(lateral ? difference.y() : difference.x());
  if (!condition.freespace) return found;
  const double boxes = condition.other.empty() ? boxToPlace(entity, target, lateral)
                                               : boxesBetween(entity, condition.other, lateral);
  return std::max(0.0, found - boxes);
}

/// By how much the distance from the reference point to a place exceeds that from the box, along or
/// across the entity's heading [m].
double TrafficStage::boxToPlace(const std::string& entity, const Eigen::Vector2d& place,
                                bool lateral) const {
  const MapPose& own = member(entity).reference;
  const Eigen::Vector2d forward = geometry::direction(own.pose.heading);
  const Eigen::Vector2d axis = lateral ? geometry::leftNormal(forward) : forward;
  return std::abs(axis.dot(place - own.pose.position)) -
         std::abs(axis.dot(place - member(entity).state.position)) +
         geometry::halfExtent(boxOf(entity), axis);
}

/// By how much the distance between two reference points exceeds that between the boxes, along or
/// across the heading of the first [m].
double TrafficStage::boxesBetween(const std::string& entity, const std::string& other,
                                  bool lateral) const {
  const MapPose& own = member(entity).reference;
  const Eigen::Vector2d forward = geometry::direction(own.pose.heading);
  const Eigen::Vector2d axis = lateral ? geometry::leftNormal(forward) : forward;
  const double centers =
      std::abs(axis.dot(member(other).state.position - member(entity).state.position));
  const double references =
      std::abs(axis.dot(member(other).reference.pose.position - own.pose.position));
  return references - centers + geometry::halfExtent(boxOf(entity), axis) +
         geometry::halfExtent(boxOf(other), axis);
}

double TrafficStage::distance(const EntityCondition& condition, const std::string& entity) const {
  const bool to_entity = !condition.other.empty();
  const Eigen::Vector2d target = to_entity
                                     ? member(condition.other).reference.pose.position
                                     : places_.resolve(*condition.place, pose_of_).pose.position;
  if (condition.along != Along::kStraight) return alongDistance(condition, entity, target);
  if (condition.freespace) {
    const geometry::OrientedBox there =
        to_entity ? boxOf(condition.other) : geometry::OrientedBox{target, 0.0, 0.0, 0.0};
    return geometry::distance(boxOf(entity), there);
  }
  return (target - member(entity).reference.pose.position).norm();
}

/// Distance over the speed at which it shrinks [s]; infinite where it does not.
double TrafficStage::timeToCollision(const EntityCondition& condition,
                                     const std::string& entity) const {
  const bool to_entity = !condition.other.empty();
  const Eigen::Vector2d target = to_entity
                                     ? member(condition.other).state.position
                                     : places_.resolve(*condition.place, pose_of_).pose.position;
  const Eigen::Vector2d toward = (target - member(entity).state.position).normalized();
  Eigen::Vector2d relative = velocityOf(entity);
  if (to_entity) relative -= velocityOf(condition.other);
  const double closing = relative.dot(toward);
  return closing > 1e-3 ? distance(condition, entity) / closing : kNever;
}

bool TrafficStage::touch(const std::string& first, const std::string& second) const {
  return first != second &&
         !traffic::onDifferentLevels(member(first).state.elevation,
                                     member(second).state.elevation) &&
         geometry::overlap(boxOf(first), boxOf(second));
}

bool TrafficStage::collides(const EntityCondition& condition, const std::string& entity) const {
  const auto meant = [&](const std::string& other) {
    const auto& kinds = condition.other_kinds;
    const Entity::Kind kind = member(other).actor->entity().kind;
    return (condition.other.empty() || other == condition.other) &&
           (kinds.empty() || std::count(kinds.begin(), kinds.end(), kind) != 0);
  };
  const auto touched = touched_.find(entity);
  if (touched != touched_.end() &&
      std::any_of(touched->second.begin(), touched->second.end(), meant))
    return true;
  return present(entity) &&
         std::any_of(present_.begin(), present_.end(), [&](const std::string& other) {
           return meant(other) && touch(entity, other);
         });
}

/// What is measured of an entity alone; nullopt where there is nothing to compare.
std::optional<double> TrafficStage::ownValue(Measure measure, const Member& own) {
  const auto lasting = [](double seconds) {
    return seconds > 0.0 ? std::optional<double>(seconds) : std::nullopt;
  };
  switch (measure) {
    case Measure::kSpeed:
      return own.state.speed;
    case Measure::kAcceleration:
      return std::abs(own.acceleration);
    case Measure::kStandStill:
      return own.standing;
    case Measure::kTraveledDistance:
      return own.traveled;
    case Measure::kEndOfRoad:
      return lasting(own.at_the_end);
    case Measure::kOffroad:
      return lasting(own.off_road);
    default:
      return std::nullopt;
  }
}

/// What is measured of an entity, also against another one or a place.
std::optional<double> TrafficStage::valueOf(const EntityCondition& condition,
                                            const std::string& entity) const {
  const Member& own = member(entity);
  switch (condition.measure) {
    case Measure::kRelativeSpeed:
      return own.state.speed - member(condition.other).state.speed;
    case Measure::kReachPosition:
    case Measure::kDistance:
      return distance(condition, entity);
    case Measure::kHeadway:
      if (own.state.speed <= 1e-3) return kNever;
      return distance(condition, entity) / own.state.speed;
    case Measure::kTimeToCollision:
      return timeToCollision(condition, entity);
    default:
      return ownValue(condition.measure, own);
  }
}

/// The same; nullopt also where a place that is relative to an entity is nowhere now, as beside one
/// that has left its lanes.
std::optional<double> TrafficStage::valueIfPlaced(const EntityCondition& condition,
                                                  const std::string& entity) const {
  if (!condition.place || condition.place->entity.empty()) return valueOf(condition, entity);
  try {
    return valueOf(condition, entity);
  } catch (const core::InputError&) {
    return std::nullopt;
  }
}

bool TrafficStage::measured(const EntityCondition& condition, const std::string& entity) const {
  if (condition.measure == Measure::kCollision) return collides(condition, entity);
  if (!present(entity)) return false;
  for (const std::string& other : {condition.other, condition.place ? condition.place->entity : ""})
    if (!other.empty() && !present(other)) return false;
  const auto value = valueIfPlaced(condition, entity);
  return value && compareNumbers(condition.rule, *value, condition.value);
}

bool TrafficStage::holds(const Condition& condition, double time) {
  if (const auto* clock = std::get_if<TimeCondition>(&condition.what))
    return compareNumbers(clock->rule, time, clock->value);
  if (const auto* parameter = std::get_if<ParameterCondition>(&condition.what)) {
    const auto found = parameters_.find(parameter->name);
    return found != parameters_.end() &&
           compareTexts(parameter->rule, found->second, parameter->value);
  }
  const auto* const entities = std::get_if<EntityCondition>(&condition.what);
  if (entities == nullptr || entities->entities.empty()) return false;
  const auto holds_of = [&](const std::string& entity) { return measured(*entities, entity); };
  const auto& list = entities->entities;
  return entities->all ? std::all_of(list.begin(), list.end(), holds_of)
                       : std::any_of(list.begin(), list.end(), holds_of);
}

// What is performed.

void TrafficStage::place(const std::string& entity, const Position& position) {
  Member& own = actors_.at(entity);
  own.actor->place(places_.resolve(position, pose_of_));
  own.reference = own.actor->reference();
  own.state = own.actor->state();
  present_.insert(entity);
}

void TrafficStage::change(const ParameterAction& action) {
  std::string& value = parameters_[action.name];
  const auto old = core::parseNumber(value);
  const auto operand = core::parseNumber(action.value);
  if (action.change == ParameterAction::Change::kSet) {
    value = action.value;
  } else if (old && operand) {
    const bool add = action.change == ParameterAction::Change::kAdd;
    value = core::formatNumber(add ? *old + *operand : *old * *operand);
  }
}

void TrafficStage::performGlobal(const Action& action) {
  if (const auto* parameter = std::get_if<ParameterAction>(&action.what)) change(*parameter);
  const auto* const entity = std::get_if<EntityAction>(&action.what);
  if (entity == nullptr || planned_.count(entity->entity) != 0) return;
  if (entity->place) {
    place(entity->entity, *entity->place);
  } else {
    remove(entity->entity);
  }
}

/// The speed that the action wants where it relates to that of `entity` [m/s].
double TrafficStage::speedFrom(const SpeedAction& action, const std::string& entity) const {
  const double other = member(entity).state.speed;
  return std::max(0.0, action.factor ? other * action.value : other + action.value);
}

void TrafficStage::perform(const SpeedAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  if (action.entity.empty()) return actor.setSpeed(action.dynamics, action.value, performing);
  const auto wanted = [this, action] { return speedFrom(action, action.entity); };
  if (!action.continuous) return actor.setSpeed(action.dynamics, wanted(), performing);
  const bool rate = action.dynamics.dimension == Dynamics::Dimension::kRate;
  SpeedLimits limits = kUsualLimits;
  if (rate) limits.acceleration = limits.deceleration = action.dynamics.value;
  actor.adaptSpeed(wanted, limits, nullptr, performing);
}

void TrafficStage::perform(const SpeedProfileAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  std::deque<std::pair<Dynamics, double>> targets;
  for (const SpeedAction& part : action.parts) targets.emplace_back(part.dynamics, part.value);
  actor.setSpeeds(std::move(targets), performing);
}

/// How far the other's reference point is ahead of the entity's, along its heading or the lanes
/// that it follows [m].
double TrafficStage::aheadBy(const std::string& entity, const std::string& other,
                             bool along_lanes) const {
  const geometry::Pose2d& own = member(entity).reference.pose;
  const Eigen::Vector2d& place = member(other).reference.pose.position;
  const map::Route* const route = along_lanes ? routeOf(entity) : nullptr;
  if (route == nullptr) return own.toBody(place).x();
  return extendedArcLength(route->path(), place) - extendedArcLength(route->path(), own.position);
}

/// How far the entity is behind the place where its distance is the wanted one [m].
double TrafficStage::excess(const DistanceAction& action, const std::string& entity,
                            Side side) const {
  const double between = aheadBy(entity, action.entity, action.along_lanes);
  const double lengths = action.freespace ? boxesBetween(entity, action.entity, false) : 0.0;
  const bool to_be_ahead = side == Side::kPresent ? between <= 0.0 : side == Side::kAheadOrLeft;
  const double speed = to_be_ahead ? member(action.entity).state.speed : member(entity).state.speed;
  const double target = lengths + (action.time_gap ? action.value * speed : action.value);
  return between + (to_be_ahead ? target : -target);
}

void TrafficStage::perform(const DistanceAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  constexpr double kGain = 0.4;  // [1/s]
  const std::string self = actor.entity().name;
  if (!action.limits) actor.shift(excess(action, self, action.side));
  if (!action.limits && !action.continuous) {
    performing->over = true;
    return;
  }
  const auto wanted = [this, action, self] {
    return member(action.entity).state.speed + kGain * excess(action, self, action.side);
  };
  std::function<bool()> reached;
  if (!action.continuous) {
    reached = [this, action, self] {
      constexpr double kNear = 0.1;  // [m] and [m/s]
      const double closing = member(self).state.speed - member(action.entity).state.speed;
      return std::abs(excess(action, self, action.side)) < kNear && std::abs(closing) < kNear;
    };
  }
  actor.adaptSpeed(wanted, action.limits.value_or(kUsualLimits), reached, performing);
}

void TrafficStage::perform(const LateralDistanceAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  const std::string self = actor.entity().name;
  const auto offsetOf = [this, self](const std::string& entity) {  // from the own lane [m]
    const map::Route* const route = routeOf(self);
    if (route == nullptr) return 0.0;
    return besideLine(route->path(), member(entity).reference.pose.position).y();
  };
  const double between = offsetOf(self) - offsetOf(action.entity);
  const bool left =
      action.side == Side::kPresent ? between >= 0.0 : action.side == Side::kAheadOrLeft;
  const double widths =
      0.5 * (member(self).dimensions.width + member(action.entity).dimensions.width);
  const double target =
      action.value ? *action.value + (action.freespace ? widths : 0.0) : std::abs(between);
  const auto wanted = [offsetOf, action, target, left] {
    return offsetOf(action.entity) + (left ? target : -target);
  };
  actor.adaptOffset(wanted, action.speed, action.continuous, performing);
}

/// How far an entity has to go to a point [m]: along the line that it follows, where that leads
/// there, else straight on. Negative where it has passed the point.
double TrafficStage::distanceLeft(const std::string& entity, const Eigen::Vector2d& target) const {
  constexpr double kBeside = 5.0;  // [m]
  const Member& own = member(entity);
  const map::Route* const route = routeOf(entity);
  const geometry::Polyline* path = planned_.count(entity) == 0 ? own.actor->path() : nullptr;
  if (path == nullptr && route != nullptr) path = &route->path();
  if (path != nullptr) {
    const geometry::Projection there = path->project(target);
    if (std::abs(there.lateral_offset) < kBeside)
      return there.arc_length - path->project(own.reference.pose.position).arc_length;
  }
  const double straight = (target - own.reference.pose.position).norm();
  return std::copysign(straight, own.reference.pose.toBody(target).x());
}

void TrafficStage::perform(const SynchronizeAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  const std::string self = actor.entity().name;
  const Eigen::Vector2d target = places_.resolve(action.target, pose_of_).pose.position;
  const Eigen::Vector2d meeting = places_.resolve(action.master_target, pose_of_).pose.position;
  const auto wanted = [this, action, self, target, meeting] {
    const double master_speed = std::max(1e-3, member(action.master).state.speed);
    const double seconds = distanceLeft(action.master, meeting) / master_speed;
    const double meters = distanceLeft(self, target);
    if (!action.final_speed) return speedToArrive(meters, seconds, std::nullopt);
    const SpeedAction& last = *action.final_speed;
    const double speed = last.continuous ? speedFrom(last, action.master) : last.value;
    const double steady = std::max(action.steady_distance, action.steady_time * speed);
    return speedToArrive(meters - steady, seconds - steady / std::max(1e-3, speed), speed);
  };
  const auto reached = [this, action, self, target, meeting] {
    return distanceLeft(self, target) <= action.tolerance ||
           distanceLeft(action.master, meeting) <= action.master_tolerance;
  };
  actor.adaptSpeed(wanted, kUsualLimits, reached, performing);
}

void TrafficStage::perform(const LaneChangeAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  const MapPose reference = action.entity.empty() ? actor.reference() : poseOf(action.entity);
  const auto target = [&](double offset) {
    return places_.laneTarget(action, actor.reference(), reference, offset);
  };
  actor.changeLane(action.dynamics, target(0.0), target(action.offset), performing);
}

/// The places of a trajectory, each with its time in the file [s].
TrafficStage::Course TrafficStage::courseOf(const FollowTrajectoryAction& action) const {
  std::vector<MapPose> places;
  std::vector<TimedPoint> points;
  for (const TrajectoryVertex& vertex : action.vertices) {
    places.push_back(places_.resolve(vertex.position, pose_of_));
    const Eigen::Vector2d& at = places.back().pose.position;
    points.emplace_back(at.x(), at.y(), places.back().elevation, vertex.time);
  }
  Course course;
  if (action.spline) {
    for (const TimedPoint& point : pointsAlong(*action.spline, points))
      course.push_back({{{point.head<2>(), 0.0}, point.z()}, point.w(), false});
    return course;
  }
  if (action.clothoid) places = placesAlong(*action.clothoid, places.front());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(places.size() - 1);
    const double first = action.vertices.front().time;
    const double between = first + share * (action.vertices.back().time - first);
    const bool vertex = !action.clothoid;
    course.push_back({places[i], vertex ? action.vertices[i].time : between,
                      !vertex || action.vertices[i].position.oriented});
  }
  return course;
}

void TrafficStage::perform(const FollowTrajectoryAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  const Course course = courseOf(action);
  std::vector<MapPose> places;
  std::vector<double> times;
  for (std::size_t i = 0; i < course.size(); ++i) {
    places.push_back(course[i].place);
    const double from = action.absolute ? 0.0 : now_;
    if (action.timed) times.push_back(from + course[i].time * action.scale + action.offset);
    if (course[i].oriented) continue;
    const std::size_t first = i + 1 < course.size() ? i : i - 1;
    const Eigen::Vector2d ahead =
        course[first + 1].place.pose.position - course[first].place.pose.position;
    if (ahead.norm() > 1e-6) places[i].pose.heading = std::atan2(ahead.y(), ahead.x());
  }
  actor.follow(std::move(places), std::move(times), performing);
}

void TrafficStage::perform(const RouteAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  std::vector<Eigen::Vector3d> points;
  for (const Position& waypoint : action.waypoints) {
    const MapPose place = places_.resolve(waypoint, pose_of_);
    points.emplace_back(place.pose.position.x(), place.pose.position.y(), place.elevation);
  }
  actor.setRoute(places_.routeThrough(actor.reference(), std::move(points)));
  performing->over = true;
}

void TrafficStage::perform(const LaneOffsetAction& action, Actor& actor,
                           const Actor::Performing& performing) {
  actor.setOffset(action.dynamics, action.value, action.continuous, performing);
}

void TrafficStage::perform(const Action& action, const std::string& entity,
                           const Actor::Performing& performing) {
  if (const auto* teleport = std::get_if<TeleportAction>(&action.what)) place(entity, teleport->to);
  if (!present(entity)) {
    performing->over = true;
    return;
  }
  Actor& actor = *actors_.at(entity).actor;
  std::visit([&](const auto& what) { perform(what, actor, performing); }, action.what);
}

std::vector<std::shared_ptr<Performance>> TrafficStage::begin(
    const Action& action, const std::vector<std::string>& actors, double time) {
  now_ = time;
  try {
    return start(action, actors);
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    const bool placed = text.rfind(action.source.file + ":", 0) == 0;
    throw core::InputError((placed ? "" : action.source.text() + ": ") + text);
  }
}

std::vector<std::shared_ptr<Performance>> TrafficStage::start(
    const Action& action, const std::vector<std::string>& actors) {
  const bool global = std::holds_alternative<EntityAction>(action.what) ||
                      std::holds_alternative<ParameterAction>(action.what) ||
                      std::holds_alternative<NoAction>(action.what);
  if (global) performGlobal(action);
  if (global) return {};
  std::vector<std::shared_ptr<Performance>> performances;
  for (const std::string& entity : actors) {
    performances.push_back(std::make_shared<Performance>());
    if (planned_.count(entity) != 0) {
      performances.back()->over = true;
    } else {
      perform(action, entity, performances.back());
      Member& own = actors_.at(entity);
      own.reference = own.actor->reference();
      own.state = own.actor->state();
    }
  }
  return performances;
}

// What moves.

void TrafficStage::measure(Member& known, const traffic::VehicleState& before, double step) const {
  known.acceleration = (known.state.speed - before.speed) / step;
  const double farthest =
      std::max(std::abs(before.speed), std::abs(known.state.speed)) * step + kRounding;
  known.traveled +=
      std::min(farthest, (known.state.position - before.position).norm());  // not a jump
  const auto count = [step](double& seconds, bool more) { seconds = more ? seconds + step : 0.0; };
  count(known.standing, known.state.speed < 0.05);
  count(known.off_road, !places_.isOnLane(known.reference));
  count(known.at_the_end, places_.isEndOfRoad(known.reference));
}

void TrafficStage::observe(const std::string& entity, const traffic::VehicleState& state,
                           const map::Route* route, double step) {
  Member& known = actors_.at(entity);
  const geometry::Pose2d pose = state.pose();
  const traffic::VehicleState before = known.state;
  known.state = state;
  known.reference = {{pose.toMap(-known.actor->entity().center), pose.heading}, state.elevation};
  known.planned_route = route;
  if (!present_.insert(entity).second) measure(known, before, step);
}

void TrafficStage::setDimensions(const std::string& entity,
                                 const traffic::VehicleDimensions& dimensions) {
  actors_.at(entity).dimensions = dimensions;
}

void TrafficStage::remove(const std::string& entity) {
  if (!present(entity)) return;
  for (const std::string& other : present_) {
    if (!touch(entity, other)) continue;
    touched_[entity].insert(other);
    touched_[other].insert(entity);
  }
  present_.erase(entity);
  planned_.erase(entity);  // it may come again
}

void TrafficStage::setPlanned(const std::string& entity, bool planned) {
  if (planned) {
    planned_.insert(entity);
    actors_.at(entity).actor->leave();
  } else if (planned_.erase(entity) > 0) {
    actors_.at(entity).actor->resume(member(entity).state);
  }
}

void TrafficStage::advance(double time, double step) {
  touched_.clear();
  for (const std::string& entity : present_) {
    if (planned_.count(entity) != 0) continue;
    Member& known = actors_.at(entity);
    const traffic::VehicleState before = known.state;
    known.actor->advance(time, step);
    known.state = known.actor->state();
    known.reference = known.actor->reference();
    measure(known, before, step);
  }
}

std::vector<std::string> TrafficStage::moved() const {
  std::vector<std::string> names;
  for (const std::string& entity : present_)
    if (planned_.count(entity) == 0) names.push_back(entity);
  return names;
}

}  // namespace cdiff::storyboard
