// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/DecisionRecord.h"
#include "ros/lockstep/paced_answers.h"
#include "ros/lockstep/tick_answers.h"
#include "session/scenario_options.h"

namespace cdiff::ros {

/// The decisions of a session that may go on without an answer: which answers have arrived, how
/// late, and what drove each vehicle meanwhile. A decision is settled once nothing more of it is
/// awaited.
class DecisionBook {
 public:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;
  /// Stands for the selection where an answer is named by its slot.
  static constexpr int kSelection = -2;

  explicit DecisionBook(const session::ScenarioOptions& options);

  /// A decision has been published.
  void open(const Snapshot& snapshot) { open_.push_back({snapshot, {}, {}}); }
  /// An answer came for `slot` (kEgoSlot, kSelection); the first of a tick counts. `now`:
  /// wall-clock time [s], of which differences count alone.
  void arrived(int slot, std::uint64_t tick, double now) {
    arrivals_.try_emplace({tick, slot}, now);
  }
  /// A tick, decision or not, went by with these actions.
  void ended(std::uint64_t tick, const std::vector<AppliedAction>& applied, double now);
  /// The oldest decisions of which nothing more is awaited at `tick`, or all; each comes out once.
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
  void forget();

  std::string ego_planner_;
  std::string cbv_planner_;
  std::uint64_t ticks_per_decision_;
  std::uint64_t give_up_after_;  ///< ticks
  std::deque<Decision> open_;
  std::map<std::pair<std::uint64_t, int>, double> arrivals_;  ///< by tick and slot
  std::set<std::pair<std::uint64_t, int>> drove_;             ///< tick of the plan and slot
  std::uint64_t late_ = 0;
};

/// The record of a decision that waited for all its answers.
::e2e_cdiff::DecisionRecord punctualRecord(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                                           const TickAnswers& answers);

/// Sentences on what came late, by planner ("cbv_identification" for the selection).
std::map<std::string, std::string> latenessTexts(const ::e2e_cdiff::DecisionRecord& record);

}  // namespace cdiff::ros
