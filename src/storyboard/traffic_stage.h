// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "storyboard/actor.h"
#include "storyboard/places.h"
#include "storyboard/storyboard.h"

namespace cdiff::storyboard {

/// The entities of a scenario in a session: those that the storyboard moves, and those that
/// planners drive, whose states `observe` takes. Answers the conditions of a storyboard and
/// performs its actions (map frame, SI units). Actions on entities that planners drive do nothing
/// and are over at once.
class TrafficStage : public Stage {
 public:
  /// References must outlive the object. `planned`: entities that planners drive from the start.
  TrafficStage(const Scenario& scenario, const Places& places, std::set<std::string> planned);

  /// The actions of the storyboard's beginning.
  void begin();
  bool holds(const Condition& condition, double time) override;
  std::vector<std::shared_ptr<Performance>> begin(const Action& action,
                                                  const std::vector<std::string>& actors,
                                                  double time) override;

  /// Says where a planner has its entity, given by the center of its box, and along which route it
  /// drives (nullptr: none; must live until the next call), `step` seconds after the call before.
  void observe(const std::string& entity, const traffic::VehicleState& state,
               const map::Route* route, double step);
  /// The size that an entity has in the session, where it is another one than in the file.
  void setDimensions(const std::string& entity, const traffic::VehicleDimensions& dimensions);
  /// A planner drives the entity from now on, or no more.
  void setPlanned(const std::string& entity, bool planned);
  /// Moves what the storyboard moves to `time`, and measures what conditions need.
  void advance(double time, double step);
  /// Takes the entity away. Conditions on collisions know until the next move whom it touched.
  void remove(const std::string& entity);

  /// Names of the entities that are there and that the storyboard moves.
  std::vector<std::string> moved() const;
  const Actor& actor(const std::string& entity) const { return *actors_.at(entity).actor; }
  /// Whether the entity is in the simulation.
  bool present(const std::string& entity) const { return present_.count(entity) != 0; }

 private:
  /// An entity, and what is measured of it.
  struct Member {
    std::unique_ptr<Actor> actor;
    traffic::VehicleDimensions dimensions;
    traffic::VehicleState state;
    MapPose reference;
    double acceleration = 0.0;
    double traveled = 0.0;    ///< [m]
    double standing = 0.0;    ///< [s]
    double off_road = 0.0;    ///< [s]
    double at_the_end = 0.0;  ///< of its road [s]
    const map::Route* planned_route = nullptr;
  };
  const Member& member(const std::string& entity) const { return actors_.at(entity); }
  /// Throws InputError for an entity that is not there.
  MapPose poseOf(const std::string& entity) const;
  geometry::OrientedBox boxOf(const std::string& entity) const;
  const map::Route* routeOf(const std::string& entity) const;
  static std::optional<double> ownValue(EntityCondition::Measure measure, const Member& own);
  std::optional<double> valueOf(const EntityCondition& condition, const std::string& entity) const;
  std::optional<double> valueIfPlaced(const EntityCondition& condition,
                                      const std::string& entity) const;
  bool measured(const EntityCondition& condition, const std::string& entity) const;
  double distance(const EntityCondition& condition, const std::string& entity) const;
  double boxToPlace(const std::string& entity, const Eigen::Vector2d& place, bool lateral) const;
  double boxesBetween(const std::string& entity, const std::string& other, bool lateral) const;
  double aheadBy(const std::string& entity, const std::string& other, bool along_lanes) const;
  double alongDistance(const EntityCondition& condition, const std::string& entity,
                       const Eigen::Vector2d& target) const;
  double timeToCollision(const EntityCondition& condition, const std::string& entity) const;
  double distanceLeft(const std::string& entity, const Eigen::Vector2d& target) const;
  double speedFrom(const SpeedAction& action, const std::string& entity) const;
  Eigen::Vector2d velocityOf(const std::string& entity) const;
  bool touch(const std::string& first, const std::string& second) const;
  bool collides(const EntityCondition& condition, const std::string& entity) const;
  std::vector<std::shared_ptr<Performance>> start(const Action& action,
                                                  const std::vector<std::string>& actors);
  void perform(const Action& action, const std::string& entity,
               const std::shared_ptr<Performance>& performing);
  /// Every other action has its effect at once.
  template <class Other>
  void perform(const Other&, Actor&, const Actor::Performing& performing) {
    performing->over = true;
  }
  void perform(const SpeedAction& action, Actor& actor, const Actor::Performing& performing);
  void perform(const DistanceAction& action, Actor& actor, const Actor::Performing& performing);
  double excess(const DistanceAction& action, const std::string& entity, Side side) const;
  void perform(const LateralDistanceAction& action, Actor& actor,
               const Actor::Performing& performing);
  void perform(const SynchronizeAction& action, Actor& actor, const Actor::Performing& performing);
  void perform(const SpeedProfileAction& action, Actor& actor, const Actor::Performing& performing);
  void perform(const LaneChangeAction& action, Actor& actor, const Actor::Performing& performing);
  /// A place of a trajectory.
  struct CoursePoint {
    MapPose place;
    double time = 0.0;      ///< in the file [s]
    bool oriented = false;  ///< whether its heading counts
  };
  using Course = std::vector<CoursePoint>;
  Course courseOf(const FollowTrajectoryAction& action) const;
  void perform(const LaneOffsetAction& action, Actor& actor, const Actor::Performing& performing);
  void perform(const FollowTrajectoryAction& action, Actor& actor,
               const Actor::Performing& performing);
  void perform(const RouteAction& action, Actor& actor, const Actor::Performing& performing);
  void performGlobal(const Action& action);
  void place(const std::string& entity, const Position& position);
  void change(const ParameterAction& action);
  void measure(Member& member, const traffic::VehicleState& before, double step) const;

  double now_ = 0.0;  ///< when the action starts that is being started [s]
  const Scenario& scenario_;
  const Places& places_;
  Places::PoseOf pose_of_;
  std::map<std::string, Member> actors_;
  std::set<std::string> planned_;
  std::set<std::string> present_;
  std::map<std::string, std::set<std::string>> touched_;  ///< those removed, and whom they touched
  std::map<std::string, std::string> parameters_;
};

}  // namespace cdiff::storyboard
