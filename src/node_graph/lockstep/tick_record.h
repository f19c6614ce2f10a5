// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "node_graph/lockstep/tick_answers.h"
#include "session/session_observer.h"

namespace cdiff::node_graph {

/// What observers are shown of a tick, made of its messages: the same whether these come from nodes
/// or from a bag.
class TickRecordView {
 public:
  /// `answers` as far as they have arrived. Throws InputError for a selection that does not fit
  /// `network`.
  TickRecordView(const ::e2e_cdiff::TrafficSnapshot& message, const TickAnswers& answers,
                 const map::RoadNetwork& network);
  TickRecordView(const TickRecordView&) = delete;
  TickRecordView& operator=(const TickRecordView&) = delete;

  /// Points into this object.
  const session::TickRecord& record() const { return record_; }
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }
  /// nullptr when there is none.
  const cbv::CbvSelection* selection() const { return selection_ ? &*selection_ : nullptr; }

 private:
  traffic::TrafficSnapshot snapshot_;
  std::optional<cbv::CbvSelection> selection_;
  std::vector<planning::PlannedAction> actions_;
  std::vector<session::SlotImage> images_;
  session::TickRecord record_;
};

/// The last state with the end of a session that published none itself, as World::end would have
/// made it; `fault` gets the last state's tick.
traffic::TrafficSnapshot endedAfter(const traffic::TrafficSnapshot& last, double simulation_step,
                                    traffic::SessionStatus status, const traffic::Fault& fault);

}  // namespace cdiff::node_graph
