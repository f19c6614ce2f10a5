// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "e2e_cdiff/DecisionRecord.h"
#include "node_graph/lockstep/paced_answers.h"
#include "node_graph/lockstep/tick_answers.h"
#include "session/scenario_options.h"

namespace cdiff::node_graph {

/// Keeps account, for the traffic simulator node, of the decisions of a session that does not wait
/// for late answers (paced by the wall clock): which answers have arrived, how late, and what drove
/// each vehicle meanwhile. A decision is settled once nothing more is awaited for it: every answer
/// is here, its planner has answered a later decision, or 10 s of simulated time have passed. Each
/// settled decision gives one DecisionRecord message.
class DecisionTracker {
 public:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;
  /// "Slot" under which the arrival of the selection is noted.
  static constexpr int kSelection = -2;

  explicit DecisionTracker(const session::ScenarioOptions& options);

  /// A decision has been published.
  void open(const Snapshot& snapshot) { open_.push_back({snapshot, {}, {}}); }
  /// An answer to `tick` has arrived for `slot` (of a CBV, kEgoSlot, or kSelection); only the first
  /// one counts. `now`: time of any steady clock [s].
  void arrived(int slot, std::uint64_t tick, double now) {
    arrivals_.try_emplace({tick, slot}, now);
  }
  /// A tick, with or without a decision, has ended in which these actions were applied.
  void ended(std::uint64_t tick, const std::vector<AppliedAction>& applied, double now);
  /// Records of the decisions, oldest first, that are settled at `tick` (with `all`: of every open
  /// one), which are then closed.
  std::vector<::e2e_cdiff::DecisionRecord::ConstPtr> settle(const TickAnswers& answers,
                                                            std::uint64_t tick, bool all);
  /// Tick of the oldest decision that is not settled.
  std::optional<std::uint64_t> oldestOpen() const;
  /// Answers of settled decisions that came late or never.
  std::uint64_t late() const { return late_; }

 private:
  struct Decision {
    Snapshot snapshot;
    std::optional<double> ended_at;
    std::vector<AppliedAction> applied;
  };
  bool settled(const Decision& decision, const TickAnswers& answers, std::uint64_t tick) const;
  ::e2e_cdiff::DecisionRecord recordOf(const Decision& decision, const TickAnswers& answers) const;
  void fill(::e2e_cdiff::DecidedVehicle& vehicle, const Decision& decision,
            const TickAnswers& answers) const;
  double lateness(const Decision& decision, int slot, std::uint64_t tick) const;
  void count(const ::e2e_cdiff::DecisionRecord& record);
  void forget();  // drops what was noted about settled decisions

  std::string ego_planner_;
  std::string cbv_planner_;
  std::uint64_t ticks_per_decision_;
  std::uint64_t give_up_after_;  ///< ticks after which a silent planner's answer is given up
  std::deque<Decision> open_;
  std::map<std::pair<std::uint64_t, int>, double> arrivals_;  ///< [s], by tick and slot
  std::set<std::pair<std::uint64_t, int>> drove_;             ///< (tick, slot) of plans that drove
  std::uint64_t late_ = 0;
};

/// The record of a decision that waited for all its answers.
::e2e_cdiff::DecisionRecord punctualRecord(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                                           const TickAnswers& answers);

/// Whose answer came late, and whether the vehicle braked fully for want of it.
struct LatePlanner {
  std::string name;  ///< of the planner; "cbv_identification" for the selection
  bool full_brake = false;
  bool operator<(const LatePlanner& other) const {
    return std::tie(name, full_brake) < std::tie(other.name, other.full_brake);
  }
};
/// Sentences on what came late.
std::map<LatePlanner, std::string> latenessTexts(const ::e2e_cdiff::DecisionRecord& record);

}  // namespace cdiff::node_graph
