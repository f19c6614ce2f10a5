// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "node_graph/lockstep/answer_waits.h"
#include "node_graph/lockstep/pacer.h"

namespace cdiff::node_graph {

/// The world goes on when every answer that the tick needs is here and no observer is more than
/// kMostLag ticks behind, however long that takes within the limit.
class LockstepPacer : public Pacer {
 public:
  using Pacer::Pacer;

  void take(const Topic& topic, const AnyMessage& message) override;
  void published(const Snapshot& snapshot) override;
  std::optional<SessionEnd> wait() override;
  TickInput advance() override;
  std::optional<SessionEnd> waitForObservers() override;
  void close() override;
  std::map<std::string, double> waits() const override { return waits_.means(); }

 private:
  std::vector<Missing> missingAnswers() const;
  std::vector<Missing> missingAtTick() const;
  std::vector<Missing> unacknowledged(std::uint64_t tick) const;
  void sendAgainForLateListener();

  AnswerWaits waits_;
  Clock::time_point published_at_;
  bool recorded_ = true;  ///< whether the record of the current decision was published
};

}  // namespace cdiff::node_graph
