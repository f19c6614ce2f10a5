// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "node_graph/lockstep/decision_tracker.h"
#include "node_graph/lockstep/paced_answers.h"
#include "node_graph/lockstep/pacer.h"

namespace cdiff::node_graph {

/// A tick ends when its time on the wall clock has come (real_time_factor above 0), whatever has
/// been answered: late answers are replaced, recorded and counted. A node that is not heard at all
/// ends the session.
class WallClockPacer : public Pacer {
 public:
  WallClockPacer(const PacedSession& session, PacerOutput output);

  void take(const Topic& topic, const AnyMessage& message) override;
  void published(const Snapshot& snapshot) override;
  std::optional<SessionEnd> wait() override;
  TickInput advance() override;
  void close() override { settle(true); }
  std::uint64_t late() const override { return decisions_.late(); }
  bool silentFor(double simulated_seconds) const override {
    return !silentNodes(simulated_seconds / options().real_time_factor).empty();
  }

 private:
  bool waitsForRollout(const Topic& topic, const AnyMessage& message);
  std::vector<Missing> silentNodes(double seconds) const;
  std::optional<SessionEnd> overdueAcknowledgement();
  void settle(bool all);
  void keepSettled();
  void forgetSettled();

  PacedAnswers paced_answers_;
  DecisionTracker decisions_;
  std::map<int, AnyMessage> early_controls_;  ///< by slot: come before their rollouts
  std::set<LatePlanner> late_planners_;       ///< of which one late answer is reported
  std::deque<Snapshot> unsettled_;            ///< from an open decision on
  Clock::time_point ego_heard_at_;            ///< last command of the external ego
  Clock::time_point cbvs_heard_at_;           ///< last command for a CBV, or decision without CBVs
  Clock::time_point acknowledged_at_;         ///< last time that the observers came on
  std::uint64_t acknowledged_ = 0;            ///< tick that all of them had acknowledged then
};

}  // namespace cdiff::node_graph
