// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/lockstep_pacer.h"

#include <algorithm>

#include "core/stage_times.h"
#include "node_graph/lockstep/decision_tracker.h"
#include "node_graph/messages/session_conversions.h"

namespace cdiff::node_graph {
namespace {

constexpr double kSendAgainAfter =
    1.0;  // [s] of wall time without an answer of an external planner

}  // namespace

void LockstepPacer::take(const Topic& topic, const AnyMessage& message) {
  waits_.arrived(topic, answers_.add(topic, message));
}

void LockstepPacer::published(const Snapshot& snapshot) {
  published_ = snapshot;
  published_at_ = Clock::now();
  waits_.published(snapshot->tick, published_at_);
  recorded_ = !snapshot->decision_tick || !session_.graph.recordsDecisions();
}

std::vector<Missing> LockstepPacer::missingAnswers() const {
  std::vector<Missing> missing;
  for (const Topic& topic : answers_.missing(*published_)) {
    const std::string node = answererOf(topic, session_.graph);
    const bool command = topic.id == ChannelId::kEgoControl;
    missing.push_back({node, (command ? egoCommandOf(session_.graph) : topic).name() +
                                 " for tick " + std::to_string(published_->tick) + " (" + node +
                                 ")"});
  }
  return missing;
}

/// Observers may lag, so that a tick that costs them more holds up nothing.
std::vector<Missing> LockstepPacer::missingAtTick() const {
  std::vector<Missing> missing = missingAnswers();
  if (published_->tick < kMostLag) return missing;
  for (Missing& node : unacknowledged(published_->tick - kMostLag))
    missing.push_back(std::move(node));
  return missing;
}

std::vector<Missing> LockstepPacer::unacknowledged(std::uint64_t tick) const {
  std::vector<Missing> missing;
  for (const std::string& node : session_.participants.notAcknowledged(tick))
    missing.push_back({node, node + "'s acknowledgement of tick " + std::to_string(tick)});
  return missing;
}

std::optional<SessionEnd> LockstepPacer::wait() {
  const auto again = [this] { sendAgainForLateListener(); };
  if (!recorded_) {  // observers wait for the record
    if (auto cause = session_.watch.waitFor([this] { return missingAnswers(); },
                                            session_.answer_limit, again))
      return cause;
    close();
  }
  return session_.watch.waitFor([this] { return missingAtTick(); }, session_.answer_limit, again);
}

std::optional<SessionEnd> LockstepPacer::waitForObservers() {
  return session_.watch.waitFor([this] { return unacknowledged(published_->tick); },
                                session_.answer_limit);
}

/// A node of the user may connect while the first snapshot is sent; it gets the same snapshot
/// again.
void LockstepPacer::sendAgainForLateListener() {
  if (secondsSince(published_at_) < kSendAgainAfter) return;
  const std::vector<Topic> missing = answers_.missing(*published_);
  const bool of_user = std::any_of(missing.begin(), missing.end(), [this](const Topic& topic) {
    return session_.graph.external(topic.row().publisher);
  });
  if (!of_user) return;
  output_.publish_again(published_);
  published_at_ = Clock::now();
}

TickInput LockstepPacer::advance() {
  {
    const core::TimedStage stage("reserve");
    output_.keep(published_, answers_);
  }
  if (!published_->decision_tick) return {};
  const std::vector<Answer> answers = answers_.answers(*published_);
  reportFaults(answers);
  TickInput input{fromMsg(*answers_.selection(published_->tick), session_.setup.network()),
                  actionsOf(answers)};
  answers_.forgetBefore(published_->tick);
  return input;
}

/// The session goes on, or ends, with what has arrived.
void LockstepPacer::close() {
  if (!recorded_)
    publishRecord(
        boost::make_shared<const msgs::DecisionRecord>(punctualRecord(*published_, answers_)));
  recorded_ = true;
}

}  // namespace cdiff::node_graph
