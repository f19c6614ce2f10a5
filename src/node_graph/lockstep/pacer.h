// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/lockstep/session_watch.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/session_graph.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// What moves the world from one tick to the next.
struct TickInput {
  std::optional<cbv::CbvSelection> selection;  ///< what to take over and release
  std::vector<planning::PlannedAction> actions;
};

/// What a pacer knows of its session; references must outlive it.
struct PacedSession {
  const session::SessionSetup& setup;
  const SessionGraph& graph;
  const ParticipantTracker& participants;
  SessionWatch& watch;
  double answer_limit = 30.0;  ///< [s] of wall time for the answers to a tick
};

/// Where a pacer's findings go.
struct PacerOutput {
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;

  std::function<void(const std::string& source, const std::string& text)> fault;
  std::function<void(const ::e2e_cdiff::DecisionRecord::ConstPtr& record)> record;
  /// A tick is over and its answers are all that count.
  std::function<void(const Snapshot& snapshot, const TickAnswers& answers)> keep;
  /// A listener may have come late to a snapshot.
  std::function<void(const Snapshot& snapshot)> publish_again;
};

/// Decides when a tick of the traffic simulator is over, and which of the answers that have come by
/// then move the world.
class Pacer {
 public:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;
  using Clock = std::chrono::steady_clock;

  Pacer(const PacedSession& session, PacerOutput output)
      : session_(session),
        output_(std::move(output)),
        answers_(session.setup.options().simulation_step) {}
  virtual ~Pacer() = default;
  Pacer(const Pacer&) = delete;
  Pacer& operator=(const Pacer&) = delete;

  /// The first tick follows now.
  void begin() { begin_ = Clock::now(); }
  /// Wall time since then [s].
  double elapsed() const { return secondsSince(begin_); }
  /// An answer has come.
  virtual void take(const Topic& topic, const AnyMessage& message) { answers_.add(topic, message); }
  /// A tick has begun.
  virtual void published(const Snapshot& snapshot) = 0;
  /// Waits until the tick is over.
  virtual std::optional<SessionEnd> wait() = 0;
  /// What moves the world now; called once a tick, after `wait`.
  virtual TickInput advance() = 0;
  /// The world has come to its end: waits until the observers have all that came before it.
  virtual std::optional<SessionEnd> waitForObservers() { return std::nullopt; }
  /// The session ends: decisions close with what has come.
  virtual void close() = 0;
  /// Mean waits for answers [ms] by channel; none where nothing waits for them.
  virtual std::map<std::string, double> waits() const { return {}; }
  /// Answers that came late or never.
  virtual std::uint64_t late() const { return 0; }
  /// Whether a node that drives has been silent for a simulated time [s].
  virtual bool silentFor(double) const { return false; }

 protected:
  const session::ScenarioOptions& options() const { return session_.setup.options(); }
  /// When that wall time since the first tick [s] is over.
  Clock::time_point wallTime(double seconds) const {
    return begin_ +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  /// One that all CBVs share is reported once.
  void reportFaults(const std::vector<Answer>& answers) const;
  void publishRecord(const ::e2e_cdiff::DecisionRecord::ConstPtr& record);

  PacedSession session_;
  PacerOutput output_;
  TickAnswers answers_;
  Snapshot published_;  ///< of the tick that stands
  Clock::time_point begin_ = Clock::now();
};

}  // namespace cdiff::node_graph
