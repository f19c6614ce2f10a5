// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/challenge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "planning/challenge_trial.h"
#include "planning/route_follower.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planning {
namespace {

using reference_driver::CarefulDriver;
using reference_driver::DrivenPath;
using reference_driver::OwnMotion;
using reference_driver::SeenVehicle;

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kPromisedPlace = 0.3;  // [m]
constexpr double kPromisedSpeed = 1.0;  // [m/s]
constexpr double kGhostTime = 4.0;      // [s]
constexpr double kSwitchGain = 0.1;     // of delta [s]
constexpr double kSwitchHold = 0.5;     // between two promises [s]
constexpr double kCrawlingCbv = 1.0;    // attacks no more [m/s]
constexpr double kSlowEgo = 0.5;        // has answered [m/s]
constexpr double kSight = 80.0;         // of the ego [m]

double leastDelay(const std::string& level) {
  const std::map<std::string, double> delays{{"easy", 0.6}, {"medium", 0.3}, {"hard", 0.1}};
  const auto known = delays.find(level);
  if (known != delays.end()) return known->second;
  const std::vector<std::string> names{"easy", "medium", "hard"};
  throw core::InputError("key 'challenge' is '" + level + "'; expected one of {" +
                         core::joinText(names, ", ") + "}" + core::didYouMean(level, names));
}

}  // namespace

struct Challenge::Parts {
  /// The ghost of a promise, driven by C.
  struct Ghost {
    OwnMotion own;
    CarefulDriver driver;
    double since = 0.0;     ///< [s]
    double switched = 0.0;  ///< last change of the promise [s]
    double delta = 0.0;     ///< extra delay with which C answers the promise [s]
  };
  /// What is remembered of a CBV.
  struct Attack {
    std::optional<Ghost> ghost;
    std::vector<traffic::VehicleState> promised;  ///< from this decision on
  };

  PlanningContext context;
  double least_delay;
  EgoFollower follower;
  std::optional<traffic::Vehicle> ego;
  OwnMotion own;
  std::optional<DrivenPath> path;
  CarefulDriver driver;  ///< C as it has watched from the ego's place
  std::optional<ChallengeCourse> course;
  std::map<std::string, Attack> attacks;

  geometry::Polyline egoLine() const;
  double followEgo(const traffic::TrafficSnapshot& snapshot);
  std::vector<SeenVehicle> seenCbvs(const traffic::TrafficSnapshot& snapshot) const;
  void moveGhost(const std::string& id, const std::vector<SeenVehicle>& seen, Attack& attack);
  bool keepsPromise(const ChallengePlan& plan, const Attack& attack) const;
  ChallengeTrial examine(const traffic::Vehicle& cbv, const ChallengePlan& plan,
                         const Attack& attack) const;
  std::tuple<int, std::size_t, double> rankOf(const ChallengePlan& plan,
                                              const ChallengeTrial& trial,
                                              const Attack& attack) const;
  void conclude(const ChallengePlan& plan, const ChallengeTrial& trial, Attack& attack) const;
};

Challenge::Challenge(const PlanningContext& context, const std::string& level)
    : parts_(new Parts{context, leastDelay(level), {}, {}, {}, {}, CarefulDriver(), {}, {}}) {}

Challenge::~Challenge() = default;

geometry::Polyline Challenge::Parts::egoLine() const {
  if (context.ego_route != nullptr && !context.ego_route->empty()) return context.ego_route->path();
  const Eigen::Vector2d& place = ego->state.position;
  const Eigen::Vector2d ahead = place + geometry::direction(ego->state.heading);
  return geometry::Polyline({{place.x(), place.y(), 0.0}, {ahead.x(), ahead.y(), 0.0}});
}

/// Its place on its line [m].
double Challenge::Parts::followEgo(const traffic::TrafficSnapshot& snapshot) {
  if (context.ego_route == nullptr || context.ego_route->empty()) return 0.0;
  follower.update(*context.ego_route, snapshot, context.simulation_step);
  return follower.arcLength();
}

std::vector<SeenVehicle> Challenge::Parts::seenCbvs(
    const traffic::TrafficSnapshot& snapshot) const {
  std::vector<SeenVehicle> seen;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    const bool cbv = other.role == traffic::VehicleRole::kCbv;
    if (!cbv || !isFinite(other.state) || traffic::onDifferentLevels(*ego, other)) continue;
    if ((other.state.position - ego->state.position).norm() > kSight) continue;
    std::optional<std::size_t> hint;
    auto vehicle = path->see(other.state, other.dimensions, hint);
    if (!vehicle) continue;
    vehicle->id = core::hashText(other.id);
    vehicle->acceleration = other.acceleration;
    seen.push_back(*vehicle);
  }
  return seen;
}

/// Over the time since the last decision. It ends when the ego has slowed down, when the CBV
/// crawls, has passed the ghost or leaves its corridor, or after kGhostTime.
void Challenge::Parts::moveGhost(const std::string& id, const std::vector<SeenVehicle>& seen,
                                 Attack& attack) {
  const auto rows =
      static_cast<std::size_t>(std::lround(context.decision_period / traffic::kRolloutStep));
  const std::size_t past = std::min(rows, attack.promised.size());
  attack.promised.erase(attack.promised.begin(),
                        attack.promised.begin() + static_cast<std::ptrdiff_t>(past));
  if (!attack.ghost) return;
  Ghost& ghost = *attack.ghost;
  const double braking = ghost.driver.brake(ghost.own, seen, context.decision_period);
  reference_driver::advance(ghost.own, -braking, kForever, context.decision_period);
  const auto mine = std::find_if(seen.begin(), seen.end(), [&](const SeenVehicle& vehicle) {
    return vehicle.id == core::hashText(id);
  });
  bool over = own.time - ghost.since > kGhostTime || mine == seen.end();
  if (!over) {
    const auto conflict = conflictOf(ghost.own, ghost.own.speed, *mine);
    const bool crawls = std::hypot(mine->along_speed, mine->across_speed) < kCrawlingCbv;
    over = conflict.gap < 0.0 || conflict.in_corridor.empty() || crawls || own.speed < kSlowEgo;
  }
  if (over) attack.ghost.reset();
}

void Challenge::startDecision(const traffic::TrafficSnapshot& snapshot) {
  Parts& parts = *parts_;
  parts.course.reset();
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr || !isFinite(ego->state)) return;
  parts.ego = *ego;
  const double arc_length = parts.followEgo(snapshot);
  parts.path.emplace(parts.egoLine(), arc_length, kSight);
  const double offset = parts.path->poseAt(arc_length).toBody(ego->state.position).y();
  parts.own = {snapshot.time,    arc_length,        offset,
               ego->state.speed, ego->acceleration, ego->dimensions};
  const std::vector<SeenVehicle> seen = parts.seenCbvs(snapshot);
  parts.driver.brake(parts.own, seen, parts.context.decision_period);
  for (auto& [id, attack] : parts.attacks) parts.moveGhost(id, seen, attack);
  parts.course.emplace(parts.context, parts.own, *parts.path, parts.driver);
}

bool Challenge::Parts::keepsPromise(const ChallengePlan& plan, const Attack& attack) const {
  const std::size_t common = std::min(plan.states.size(), attack.promised.size());
  for (std::size_t i = 0; i < common; ++i) {
    const traffic::VehicleState& planned = plan.states[i];
    const traffic::VehicleState& promised = attack.promised[i];
    if ((planned.position - promised.position).norm() > kPromisedPlace) return false;
    if (std::abs(planned.speed - promised.speed) > kPromisedSpeed) return false;
  }
  return common > 0;
}

ChallengeTrial Challenge::Parts::examine(const traffic::Vehicle& cbv, const ChallengePlan& plan,
                                         const Attack& attack) const {
  const bool finite = std::all_of(plan.states.begin(), plan.states.end(), isFinite);
  if (!finite) {
    ChallengeTrial lost;
    lost.refusal = "it is not finite";
    lost.margin = 0.0;
    return lost;
  }
  ChallengeTrial trial = course->examine(cbv, plan);
  if (own.speed <= kStandingEgo) trial.hit_time.reset();
  if (plan.only_to_hit && !trial.refusal.empty()) {
    trial.margin = 0.0;  // never the one that is left
    return trial;
  }
  const bool promised = attack.ghost && keepsPromise(plan, attack);
  const bool answered = course->egoAnswers(trial);
  if (!trial.refusal.empty()) return trial;
  course->findRoad(trial, plan.states.size());
  if (!answered && !promised) {
    trial.refusal = "a careful driver in the ego's place cannot answer it";
  } else if (attack.ghost) {
    ChallengeTrial of_ghost = trial;
    if (!course->answers(attack.ghost->driver, attack.ghost->own, of_ghost, 0.0))
      trial.refusal = "the ghost cannot answer it";
  }
  if (promised) {
    trial.delta = attack.ghost->delta;
  } else if (trial.refusal.empty() && trial.hit_time) {
    course->findDelta(trial);
    if (trial.delta < least_delay) trial.refusal = "it leaves a careful driver too little time";
  }
  return trial;
}

/// For the choice, the lowest first. A promised plan goes first while it still hits. Of plans that
/// are refused, the one that leaves C longest.
std::tuple<int, std::size_t, double> Challenge::Parts::rankOf(const ChallengePlan& plan,
                                                              const ChallengeTrial& trial,
                                                              const Attack& attack) const {
  if (!trial.refusal.empty()) return {9, 0, -trial.margin};
  const bool promised = attack.ghost && plan.kept && trial.hit_time;
  const bool hits = trial.hit_time && trial.off_road == 0 && !plan.brakes && !promised;
  const bool gains = hits && (!attack.ghost || (own.time - attack.ghost->switched >= kSwitchHold &&
                                                trial.delta <= attack.ghost->delta - kSwitchGain));
  if (gains) return {0, 0, trial.delta};
  if (promised) return {1, 0, 0.0};
  const bool idle = plan.brakes || plan.kept;
  if (trial.approach_time && !idle && trial.off_road == 0) return {2, 0, *trial.approach_time};
  return {idle ? 4 : 3, trial.off_road, plan.score};
}

void Challenge::Parts::conclude(const ChallengePlan& plan, const ChallengeTrial& trial,
                                Attack& attack) const {
  attack.promised = plan.states;
  if (!trial.refusal.empty() || plan.brakes) {
    attack.ghost.reset();
  } else if (trial.hit_time && !attack.ghost) {
    attack.ghost = Ghost{own, driver, own.time, own.time, trial.delta};
  } else if (trial.hit_time && !plan.kept) {
    attack.ghost->switched = own.time;
    attack.ghost->delta = trial.delta;
  }
}

guidance::ChallengeReport Challenge::choose(const traffic::Vehicle& cbv,
                                            const std::vector<ChallengePlan>& plans) {
  Parts& parts = *parts_;
  guidance::ChallengeReport report;
  report.state = "drives";
  if (!parts.course) return report;
  Parts::Attack& attack = parts.attacks[cbv.id];
  std::vector<ChallengeTrial> trials;
  for (const ChallengePlan& plan : plans) trials.push_back(parts.examine(cbv, plan, attack));
  std::size_t best = 0;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    report.refusals.push_back(trials[i].refusal);
    if (parts.rankOf(plans[i], trials[i], attack) < parts.rankOf(plans[best], trials[best], attack))
      best = i;
  }
  const ChallengeTrial& trial = trials[best];
  const bool attacked = attack.ghost.has_value();
  parts.conclude(plans[best], trial, attack);
  parts.course->choose(trial);
  const bool withdrawn = !trial.refusal.empty() || (attacked && plans[best].brakes);
  report.chosen = static_cast<std::int64_t>(best);
  report.state = withdrawn ? "withdrawn" : attack.ghost ? "attacks" : "drives";
  report.reason = trial.refusal;
  report.delta = trial.delta;
  if (trial.brake_time) report.last_brake_time = *trial.brake_time + trial.delta;
  if (!attack.ghost) return report;
  const geometry::OrientedBox box = parts.path->boxOf(attack.ghost->own);
  report.ghost = traffic::VehicleState{box.center, parts.ego->state.elevation, box.heading,
                                       attack.ghost->own.speed};
  return report;
}

}  // namespace cdiff::planning
