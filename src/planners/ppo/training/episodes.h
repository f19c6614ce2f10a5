// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "cbv/cbv_selector.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/ppo/ppo_network.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// One decision of a CBV and what it brought (ppo_rules.h).
struct PpoStep {
  PpoObservation observation{};
  PpoAction action{};
  double reward = 0.0;
};

/// How an episode ended. kCut: it did not end, but was left: the CBV's route, the session or the
/// iteration was over.
enum class PpoEnd { kGoal, kEgoContact, kOtherContact, kCut };

/// The decisions of one CBV in order, until its goal, any contact, or a cut.
struct PpoEpisode {
  std::vector<PpoStep> steps;  ///< at least one
  PpoEnd end = PpoEnd::kCut;
  PpoObservation last{};  ///< what it saw after the last step; of kCut only

  /// Sum of the rewards, not discounted.
  double total() const;
};

/// Who decides: the actor's Gaussian while it learns, tanh(mean) where it is judged.
struct PpoPolicy {
  const PpoActor& actor;
  bool explores = true;
  core::RandomStream noise;  ///< keyed by vehicle and tick
};

/// The episodes of one session: what its CBVs saw, did and were rewarded for. Called in this order:
/// `look` at every tick, at decision ticks then `settle` and `act` for each CBV, `finish` at the
/// end.
class PpoEpisodeLog {
 public:
  /// Both must outlive the object.
  PpoEpisodeLog(const PpoPolicy& policy, const map::Route& ego_route);

  /// Follows the ego; ends the episodes of those who touch another vehicle at this tick.
  void look(const traffic::TrafficSnapshot& snapshot);
  /// Rewards the last decision of each CBV; ends the episodes of those who reached the goal and
  /// cuts those whose vehicle is not assigned any more.
  void settle(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection);
  /// The action of a CBV, from now on to be rewarded. A vehicle whose observation is not finite
  /// brakes and is not recorded.
  planning::PlannedAction act(const traffic::TrafficSnapshot& snapshot,
                              const planning::PlanningTask& task);
  /// Cuts what has not ended, and gives all episodes, in the order in which they ended.
  std::vector<PpoEpisode> finish();

  /// Whether the vehicle has reached its goal.
  bool arrived(const std::string& id) const { return arrived_.count(id) != 0; }
  /// Decisions rewarded so far.
  std::size_t steps() const { return steps_; }

 private:
  /// An episode that goes on, with the decision that waits for its reward.
  struct Open {
    PpoEpisode episode;
    PpoStep pending;
    double distance = 0.0;  ///< from the goal when it was decided [m]
    bool decided = false;   ///< whether there is a pending decision
  };
  using Opens = std::map<std::string, Open>;

  /// Adds the pending decision with its reward.
  void reward(const PpoOutcome& outcome, Open& open);
  Opens::iterator close(Opens::iterator open, PpoEnd end);
  Opens::iterator settleOne(const traffic::TrafficSnapshot& snapshot, bool assigned,
                            Opens::iterator open);
  PpoAction decide(const std::string& id, std::uint64_t tick,
                   const PpoObservation& observation) const;

  const PpoPolicy& policy_;
  const map::Route& ego_route_;
  planning::RouteFollower ego_;
  PpoGoal goal_;
  Opens open_;  ///< by vehicle
  std::set<std::string> arrived_;
  std::vector<PpoEpisode> ended_;
  std::size_t steps_ = 0;
};

/// CBV identification that records episodes, and gives vehicles that have reached their goal back
/// to the traffic.
class PpoEpisodeSelector : public cbv::VehicleSelector {
 public:
  /// `log` must outlive the object.
  PpoEpisodeSelector(std::unique_ptr<cbv::VehicleSelector> selector, PpoEpisodeLog& log)
      : selector_(std::move(selector)), log_(log) {}
  void observe(const traffic::TrafficSnapshot& snapshot) override;
  cbv::CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;

 private:
  std::unique_ptr<cbv::VehicleSelector> selector_;
  PpoEpisodeLog& log_;
  std::set<std::string> given_back_;
};

/// The planner of CBVs while episodes are recorded.
class PpoEpisodePlanner : public planning::Planner {
 public:
  /// `log` must outlive the object.
  explicit PpoEpisodePlanner(PpoEpisodeLog& log) : log_(log) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  PpoEpisodeLog& log_;
};

}  // namespace cdiff::planners
