// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/pacer.h"

#include <set>
#include <utility>

namespace cdiff::node_graph {

void Pacer::reportFaults(const std::vector<Answer>& answers) const {
  std::set<std::pair<std::string, std::string>> reported;
  for (const Answer& answer : answers) {
    if (!answer.fault.empty() && reported.emplace(answer.planner, answer.fault).second)
      output_.fault(answer.planner, answer.fault);
  }
}

void Pacer::publishRecord(const ::e2e_cdiff::DecisionRecord::ConstPtr& record) {
  output_.record(record);
  answers_.add(ChannelId::kDecisionRecord, record);
}

}  // namespace cdiff::node_graph
