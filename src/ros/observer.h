// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What metrics and recorder have in common: they listen to all answers of a tick and take it when
/// they are complete.
#pragma once

#include "ros/participant.h"
#include "ros/tick_answers.h"
#include "session/scenario_options.h"

namespace cdiff::ros {

class Observer : public Participant {
 public:
  using Participant::Participant;

 protected:
  /// Listens to all that the table of channels says of answers and reports for an observer of this
  /// part; from now on a decision is complete with all that the table asks for.
  void listenToAnswers(Party party, const session::ScenarioOptions& options);
  /// Whether all answers to a tick are here, or nothing more of it will come: in lockstep when it
  /// is `superseded` by a later one.
  bool complete(const ::e2e_cdiff::TrafficSnapshot& snapshot, bool superseded);
  const TickAnswers& answers() const { return answers_; }
  /// Drops the answers to a tick and to those before it.
  void forgetUntil(std::uint64_t tick) { answers_.forgetBefore(tick + 1); }

 private:
  TickAnswers answers_;
  ::ros::WallTime waiting_since_;  ///< for what a decision's record names; zero when not
};

}  // namespace cdiff::ros
