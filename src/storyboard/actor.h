// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "storyboard/places.h"
#include "storyboard/storyboard.h"

namespace cdiff::storyboard {

/// A value on its way to a target, over time [s] or distance driven [m].
class Transition {
 public:
  /// `extent`: how long it takes in its dimension; 0 is at once.
  Transition(double from, double to, Dynamics::Shape shape, double extent, bool by_distance)
      : from_(from), to_(to), shape_(shape), extent_(extent), by_distance_(by_distance) {}

  void advance(double seconds, double meters) { progress_ += by_distance_ ? meters : seconds; }
  double value() const;
  bool over() const { return progress_ >= extent_ - 1e-9; }
  /// Whether the value jumps.
  bool isAtOnce() const { return shape_ == Dynamics::Shape::kStep || extent_ <= 0.0; }

 private:
  double from_;
  double to_;
  Dynamics::Shape shape_;
  double extent_;
  bool by_distance_;
  double progress_ = 0.0;
};

/// The motion of another entity that an actor adapts to: its speed [m/s], and the gap to it [m]
/// where it is one.
struct Followed {
  double speed = 0.0;
  double gap = 0.0;  ///< ahead of the actor
};

/// An entity that the storyboard moves (map frame, SI units): its reference point drives along the
/// lanes at its speed and beside their middle, or along a trajectory. It obeys no dynamics of
/// vehicles. Off every lane it goes straight on.
class Actor {
 public:
  using Performing = std::shared_ptr<Performance>;
  using FollowedNow = std::function<Followed()>;

  /// References must outlive the object.
  Actor(const Entity& entity, const Places& places) : entity_(entity), places_(places) {}

  /// Puts its reference point somewhere; it goes on along the lane there.
  void place(const MapPose& place);
  /// Ends all that it performs, because somebody else drives it.
  void leave();
  /// Takes it from where somebody else drove it.
  void resume(const traffic::VehicleState& state);
  /// Each of these replaces the action before it in the same domain.
  void setSpeed(const Dynamics& dynamics, double speed, const Performing& performing) {
    setSpeeds({{dynamics, speed}}, performing);
  }
  /// Several speeds [m/s], one after the other.
  void setSpeeds(std::deque<std::pair<Dynamics, double>> targets, const Performing& performing);
  /// Keeps the speed that `wanted` says, within the limits, until `reached` says so; always where
  /// it is nullptr.
  void adaptSpeed(std::function<double()> wanted, const SpeedLimits& limits,
                  std::function<bool()> reached, const Performing& performing);
  /// Moves along its lane at once, back for a negative distance.
  void shift(double meters);
  /// `target`: where it ends abreast, in or beside the middle of that lane.
  void changeLane(const Dynamics& dynamics, const Eigen::Vector2d& lane_middle,
                  const Eigen::Vector2d& target, const Performing& performing);
  /// `always`: it does not end when it is reached.
  void setOffset(const Dynamics& dynamics, double offset, bool always,
                 const Performing& performing);
  /// Keeps the offset that `wanted` says [m, to the left of the lane], changed by at most `speed`
  /// [m/s], until it is reached, or always.
  void adaptOffset(std::function<double()> wanted, double speed, bool always,
                   const Performing& performing);
  void setRoute(map::Route route);
  /// `times` [s] of simulated time, one for each place, or none.
  void follow(std::vector<MapPose> places, std::vector<double> times, const Performing& performing);

  /// Moves on to `time`, `step` seconds later.
  void advance(double time, double step);

  const Entity& entity() const { return entity_; }
  const MapPose& reference() const { return reference_; }
  /// Of the box's center.
  traffic::VehicleState state() const;
  double speed() const { return speed_; }
  double acceleration() const { return acceleration_; }
  /// nullptr off every lane.
  const map::Route* route() const { return route_.get(); }
  /// The line that it follows: a trajectory without times, or its lanes; nullptr where there is
  /// none.
  const geometry::Polyline* path() const;

 private:
  struct Trajectory {
    std::vector<MapPose> places;
    std::vector<double> times;
    geometry::Polyline line;
    double driven = 0.0;
    Performing performing;
    bool begun = false;
  };
  void takeRoute(std::shared_ptr<const map::Route> route);
  void startOffset(const Dynamics& dynamics, double offset, const Performing& performing);
  void startSpeed(const Performing& performing);
  void nextSpeed();
  void stopOffset();
  void changeOffset(double step, double meters);
  void prolongRoute();
  void changeSpeed(double step);
  void advanceOnLanes(double meters, double step);
  void advanceStraight(double meters);
  static double speedBefore(std::size_t place, const Trajectory& course, double otherwise);
  void advanceOnLine(double meters);
  void advanceOnTrajectory(double time, double step, double meters);
  void endTrajectory();

  const Entity& entity_;
  const Places& places_;
  MapPose reference_;
  double speed_ = 0.0;
  double acceleration_ = 0.0;
  std::shared_ptr<const map::Route> route_;
  bool route_ends_ = false;  ///< with the network
  double arc_length_ = 0.0;
  double offset_ = 0.0;  ///< to the left of the route [m]
  std::optional<Transition> speed_change_;
  std::function<double()> wanted_speed_;
  std::deque<std::pair<Dynamics, double>> next_speeds_;
  SpeedLimits speed_limits_;
  std::function<bool()> speed_reached_;
  std::optional<Transition> offset_change_;
  std::function<double()> wanted_offset_;
  double offset_speed_ = 0.0;
  bool offset_kept_ = false;  ///< when it is reached
  std::optional<Trajectory> trajectory_;
  Performing longitudinal_;
  Performing lateral_;
};

}  // namespace cdiff::storyboard
