// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/actor.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::storyboard {
namespace {

/// Ends what was performed before.
void replace(std::shared_ptr<Performance>& present, const std::shared_ptr<Performance>& next) {
  if (present) present->over = true;
  present = next;
}

void finish(std::shared_ptr<Performance>& performing) {
  if (performing) performing->over = true;
  performing.reset();
}

/// The largest slope and curvature of a change by 1 within 1.
struct Steepness {
  double slope = 1.0;
  double curvature = 0.0;
};

Steepness steepnessOf(Dynamics::Shape shape) {
  if (shape == Dynamics::Shape::kCubic) return {1.5, 6.0};  // of 3 x^2 - 2 x^3
  if (shape == Dynamics::Shape::kSinusoidal)                // of (1 - cos(pi x)) / 2
    return {0.5 * core::kPi, 0.5 * core::kPi * core::kPi};
  return {};
}

/// How long a change of `difference` takes, in the dimension of the dynamics.
double extentOf(const Dynamics& dynamics, double difference) {
  using Dimension = Dynamics::Dimension;
  const bool direct =
      dynamics.dimension == Dimension::kTime || dynamics.dimension == Dimension::kDistance;
  if (direct) return dynamics.value;
  if (dynamics.shape == Dynamics::Shape::kStep || dynamics.value <= 0.0) return 0.0;
  const Steepness most = steepnessOf(dynamics.shape);
  const double change = std::abs(difference) / dynamics.value;
  return dynamics.dimension == Dimension::kRate ? most.slope * change
                                                : std::sqrt(most.curvature * change);
}

}  // namespace

double Transition::value() const {
  if (over() || shape_ == Dynamics::Shape::kStep) return to_;
  double share = std::clamp(progress_ / extent_, 0.0, 1.0);
  if (shape_ == Dynamics::Shape::kCubic) share = share * share * (3.0 - 2.0 * share);
  if (shape_ == Dynamics::Shape::kSinusoidal) share = 0.5 * (1.0 - std::cos(core::kPi * share));
  return from_ + share * (to_ - from_);
}

void Actor::takeRoute(std::shared_ptr<const map::Route> route) {
  route_ = std::move(route);
  route_ends_ = false;
  if (!route_) return;
  const geometry::Projection here = route_->path().project(reference_.pose.position);
  arc_length_ = here.arc_length;
  offset_ = route_->path().extendedPoseAt(arc_length_).toBody(reference_.pose.position).y();
}

void Actor::leave() {
  trajectory_.reset();
  stopOffset();
  speed_change_.reset();
  next_speeds_.clear();
  wanted_speed_ = nullptr;
  finish(lateral_);
  finish(longitudinal_);
}

void Actor::place(const MapPose& place) {
  trajectory_.reset();
  stopOffset();
  finish(lateral_);
  reference_ = place;
  const auto route = places_.routeFrom(place);
  takeRoute(route ? std::make_shared<const map::Route>(*route) : nullptr);
}

void Actor::resume(const traffic::VehicleState& state) {
  const geometry::Pose2d pose = state.pose();
  speed_ = state.speed;
  place({{pose.toMap(-entity_.center), pose.heading}, state.elevation});
}

/// A new action on the speed ends the one before, and a trajectory with times.
void Actor::startSpeed(const Performing& performing) {
  if (trajectory_ && !trajectory_->times.empty()) endTrajectory();
  replace(longitudinal_, performing);
  speed_change_.reset();
  next_speeds_.clear();
  wanted_speed_ = nullptr;
}

void Actor::setSpeeds(std::deque<std::pair<Dynamics, double>> targets,
                      const Performing& performing) {
  startSpeed(performing);
  next_speeds_ = std::move(targets);
  nextSpeed();
}

/// Begins with the next change of the speed. One that takes no time is done at once.
void Actor::nextSpeed() {
  while (!next_speeds_.empty()) {
    const auto [dynamics, speed] = next_speeds_.front();
    next_speeds_.pop_front();
    double extent = extentOf(dynamics, speed - speed_);
    if (dynamics.shape == Dynamics::Shape::kStep) speed_ = speed;
    if (dynamics.dimension == Dynamics::Dimension::kDistance)
      extent = 2.0 * extent / std::max(0.1, speed + speed_);
    speed_change_ = Transition(speed_, speed, dynamics.shape, extent, false);
    if (!speed_change_->over()) return;
    speed_ = speed;
    speed_change_.reset();
  }
  finish(longitudinal_);
}

void Actor::adaptSpeed(std::function<double()> wanted, const SpeedLimits& limits,
                       std::function<bool()> reached, const Performing& performing) {
  startSpeed(performing);
  wanted_speed_ = std::move(wanted);
  speed_limits_ = limits;
  speed_reached_ = std::move(reached);
}

void Actor::shift(double meters) {
  if (!route_) return advanceStraight(meters);
  const double most = route_->path().length();
  arc_length_ = std::clamp(arc_length_ + meters, 0.0, most);
  const geometry::Pose2d on_path = route_->path().extendedPoseAt(arc_length_);
  reference_ = {{on_path.toMap({0.0, offset_}), on_path.heading},
                route_->path().pointAt(arc_length_).z()};
}

const geometry::Polyline* Actor::path() const {
  if (trajectory_ && trajectory_->times.empty()) return &trajectory_->line;
  return route_ ? &route_->path() : nullptr;
}

void Actor::stopOffset() {
  offset_change_.reset();
  wanted_offset_ = nullptr;
}

void Actor::startOffset(const Dynamics& dynamics, double offset, const Performing& performing) {
  replace(lateral_, performing);
  wanted_offset_ = nullptr;
  offset_kept_ = false;
  if (!route_) return finish(lateral_);  // there is nothing to be beside
  const bool by_distance = dynamics.dimension == Dynamics::Dimension::kDistance;
  offset_change_ = Transition(offset_, offset, dynamics.shape, extentOf(dynamics, offset - offset_),
                              by_distance);
}

void Actor::changeLane(const Dynamics& dynamics, const Eigen::Vector2d& lane_middle,
                       const Eigen::Vector2d& target, const Performing& performing) {
  if (trajectory_) endTrajectory();
  // A lane of the same direction becomes the route; beside others one drives off the route.
  const MapPose middle{{lane_middle, reference_.pose.heading}, reference_.elevation};
  const auto route = places_.routeFrom(middle);
  if (route) takeRoute(std::make_shared<const map::Route>(*route));
  startOffset(dynamics, route_ ? route_->path().project(target).lateral_offset : 0.0, performing);
}

void Actor::setOffset(const Dynamics& dynamics, double offset, bool always,
                      const Performing& performing) {
  if (trajectory_) endTrajectory();
  startOffset(dynamics, offset, performing);
  offset_kept_ = always;
}

void Actor::adaptOffset(std::function<double()> wanted, double speed, bool always,
                        const Performing& performing) {
  if (trajectory_) endTrajectory();
  replace(lateral_, performing);
  offset_change_.reset();
  if (!route_) return finish(lateral_);
  wanted_offset_ = std::move(wanted);
  offset_speed_ = speed;
  offset_kept_ = always;
}

void Actor::setRoute(map::Route route) {
  if (trajectory_) endTrajectory();
  takeRoute(std::make_shared<const map::Route>(std::move(route)));
}

void Actor::follow(std::vector<MapPose> places, std::vector<double> times,
                   const Performing& performing) {
  replace(lateral_, performing);
  stopOffset();
  trajectory_.reset();
  const bool timed = !times.empty();
  if (timed) startSpeed(nullptr);
  std::vector<Eigen::Vector3d> points;
  for (const MapPose& place : places)
    points.emplace_back(place.pose.position.x(), place.pose.position.y(), place.elevation);
  trajectory_ = Trajectory{std::move(places), std::move(times), {}, 0.0, performing};
  if (!timed) trajectory_->line = geometry::Polyline(points);
}

void Actor::changeSpeed(double step) {
  if (longitudinal_ && longitudinal_->stopped) {
    speed_change_.reset();
    next_speeds_.clear();
    wanted_speed_ = nullptr;
    finish(longitudinal_);
  }
  if (speed_change_) {
    speed_change_->advance(step, 0.0);
    speed_ = std::max(0.0, speed_change_->value());
    if (!speed_change_->over()) return;
    speed_change_.reset();
    nextSpeed();
  } else if (wanted_speed_) {
    const double wanted = std::clamp(wanted_speed_(), 0.0, speed_limits_.speed);
    speed_ += std::clamp(wanted - speed_, -speed_limits_.deceleration * step,
                         speed_limits_.acceleration * step);
    if (!speed_reached_ || !speed_reached_()) return;
    wanted_speed_ = nullptr;
    finish(longitudinal_);
  }
}

void Actor::advanceStraight(double meters) {
  reference_.pose.position += meters * geometry::direction(reference_.pose.heading);
}

/// Routes have a largest length; where less than this is left, they go on.
void Actor::prolongRoute() {
  constexpr double kLeast = 100.0;  // [m]
  const double length = route_->path().length();
  if (route_ends_ || length - arc_length_ >= kLeast) return;
  const auto longer = std::make_shared<const map::Route>(places_.prolonged(*route_));
  route_ends_ = longer->path().length() < length + kLeast;
  if (!route_ends_) route_ = longer;
}

void Actor::changeOffset(double step, double meters) {
  if (lateral_ && lateral_->stopped) {
    stopOffset();
    finish(lateral_);
  }
  bool reached = false;
  if (offset_change_) {
    offset_change_->advance(step, meters);
    offset_ = offset_change_->value();
    reached = offset_change_->over();
  } else if (wanted_offset_) {
    const double wanted = wanted_offset_();
    offset_ += std::clamp(wanted - offset_, -offset_speed_ * step, offset_speed_ * step);
    reached = !offset_kept_ && offset_ == wanted;
  }
  if (!reached) return;
  stopOffset();
  if (!offset_kept_) finish(lateral_);
}

void Actor::advanceOnLanes(double meters, double step) {
  prolongRoute();
  const geometry::Polyline& path = route_->path();
  const double before = offset_;
  if (arc_length_ + meters >= path.length()) {  // where the network ends one stops
    meters = path.length() - arc_length_;
    speed_ = 0.0;
  }
  arc_length_ += meters;
  const bool jumps = offset_change_ && offset_change_->isAtOnce();
  changeOffset(step, meters);
  if (meters <= 0.0 && offset_ == before) return;
  const geometry::Pose2d on_path = path.extendedPoseAt(arc_length_);
  const double turned = meters > 0.0 && !jumps ? std::atan2(offset_ - before, meters) : 0.0;
  reference_.pose = {on_path.toMap({0.0, offset_}), core::wrapAngle(on_path.heading + turned)};
  reference_.elevation = path.pointAt(arc_length_).z();
}

void Actor::endTrajectory() {
  trajectory_.reset();
  finish(lateral_);
  const auto route = places_.routeFrom(reference_);
  takeRoute(route ? std::make_shared<const map::Route>(*route) : nullptr);
}

/// Speed of a timed course before one of its places [m/s]; `otherwise` where there is no way.
double Actor::speedBefore(std::size_t place, const Trajectory& course, double otherwise) {
  if (place == 0 || course.times[place] <= course.times[place - 1]) return otherwise;
  const Eigen::Vector2d way =
      course.places[place].pose.position - course.places[place - 1].pose.position;
  return way.norm() / (course.times[place] - course.times[place - 1]);
}

/// On a trajectory without times.
void Actor::advanceOnLine(double meters) {
  Trajectory& course = *trajectory_;
  course.driven += meters;
  const geometry::Pose2d pose = course.line.extendedPoseAt(course.driven);
  reference_ = {pose, course.line.pointAt(course.driven).z()};
  if (course.driven >= course.line.length()) endTrajectory();
}

void Actor::advanceOnTrajectory(double time, double step, double meters) {
  Trajectory& course = *trajectory_;
  if (lateral_ && lateral_->stopped) return endTrajectory();
  if (course.times.empty()) return advanceOnLine(meters);
  constexpr double kTolerance = 1e-9;  // [s]
  const auto after = std::upper_bound(course.times.begin(), course.times.end(), time + kTolerance);
  const auto next = static_cast<std::size_t>(after - course.times.begin());
  const Eigen::Vector2d before = reference_.pose.position;
  if (next == 0 || next == course.times.size()) {
    reference_ = next == 0 ? course.places.front() : course.places.back();
  } else {
    const MapPose& from = course.places[next - 1];
    const MapPose& to = course.places[next];
    const double share = std::clamp(
        (time - course.times[next - 1]) / (course.times[next] - course.times[next - 1]), 0.0, 1.0);
    const double turned = core::angleDifference(to.pose.heading, from.pose.heading);
    reference_.pose = {from.pose.position + share * (to.pose.position - from.pose.position),
                       core::wrapAngle(from.pose.heading + share * turned)};
    reference_.elevation = from.elevation + share * (to.elevation - from.elevation);
  }
  const std::size_t last = course.times.size() - 1;
  // Not that of the way to the course's beginning, or of a step in whose midst the course ends.
  if (course.begun) speed_ = (reference_.pose.position - before).norm() / step;
  if (!course.begun || next > last)
    speed_ = next == 0 ? 0.0 : speedBefore(std::min(next, last), course, speed_);
  course.begun = true;
  if (next > last) endTrajectory();
}

void Actor::advance(double time, double step) {
  const double before = speed_;
  changeSpeed(step);
  const double meters = 0.5 * (before + speed_) * step;
  if (trajectory_) {
    advanceOnTrajectory(time, step, meters);
  } else if (route_) {
    advanceOnLanes(meters, step);
  } else {
    advanceStraight(meters);
  }
  acceleration_ = (speed_ - before) / step;
}

traffic::VehicleState Actor::state() const {
  traffic::VehicleState state;
  state.position = reference_.pose.toMap(entity_.center);
  state.elevation = reference_.elevation;
  state.heading = reference_.pose.heading;
  state.speed = speed_;
  return state;
}

}  // namespace cdiff::storyboard
