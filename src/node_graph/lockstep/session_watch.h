// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/participant_tracker.h"

namespace cdiff::node_graph {

/// Why a session ends from outside.
struct SessionEnd {
  traffic::SessionStatus status = traffic::SessionStatus::kError;
  std::string source;  ///< who is to blame
  std::string text;
};

/// What a session lacks.
struct Missing {
  std::string node;  ///< who owes it
  std::string what;
};

/// The traffic simulator's waits, all of wall time: for what, how long, and who is to blame when it
/// does not come. Any wait ends early when the user stops the session, a node reports an error, or
/// one that is counted on leaves.
class SessionWatch {
 public:
  using Clock = std::chrono::steady_clock;
  using MissingNow = std::function<std::vector<Missing>()>;
  using OtherCause = std::function<std::optional<SessionEnd>()>;

  /// References must outlive the object.
  SessionWatch(StopSignal& stop, const ParticipantTracker& participants,
               const Connections& connections)
      : stop_(stop), participants_(participants), connections_(connections) {}

  /// Asked at each look, too.
  void setOtherCause(OtherCause cause) { other_cause_ = std::move(cause); }
  /// What ends a session at once.
  std::optional<SessionEnd> disturbance();
  /// Nodes that are not ready, or not connected both ways.
  std::vector<Missing> notReady() const;
  /// Handles messages until nothing is missing; the session's end when something still is after
  /// `seconds`. `meanwhile` is called at each look.
  std::optional<SessionEnd> waitFor(const MissingNow& missing_now, double seconds,
                                    const std::function<void()>& meanwhile = {});
  /// Handles messages until then.
  std::optional<SessionEnd> sleepUntil(Clock::time_point due);
  /// The end of a session that lacks something after `seconds`. Of several nodes the one to blame
  /// says nothing at all, not even that it waits; it is ended, and not waited for again.
  SessionEnd endOfPatience(const std::vector<Missing>& missing, double seconds);
  /// Waits until the observers have finished, at most `seconds`, but not for who was blamed, and
  /// only 5 s for who runs and was never heard: it may just have begun its files. Who has not
  /// finished then is ended: it may not write beside the simulator, nor hold up the end of the
  /// launch.
  void waitForObservers(double seconds);

 private:
  bool observersPending(double waited) const;

  StopSignal& stop_;
  const ParticipantTracker& participants_;
  const Connections& connections_;
  OtherCause other_cause_;
  std::set<std::string> blamed_;  ///< nodes that are not waited for any more
};

}  // namespace cdiff::node_graph
