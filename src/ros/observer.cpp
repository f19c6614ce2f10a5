// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/observer.h"

namespace cdiff::ros {

namespace msgs = ::e2e_cdiff;

void Observer::listenToAnswers(Party party, const session::ScenarioOptions& options) {
  answers_ = TickAnswers(options.simulation_step, awaitedBy(party, graph()), options.camera);
  for (const Channel& row : channels()) {
    const bool collected = row.use == Use::kAnswer || row.use == Use::kReport;
    if (!collected || !listensTo(row, party, graph())) continue;
    for (const Topic& topic : topicsOf(row, graph().max_cbv)) {
      listen(topic, [this, topic](const AnyMessage& message) {
        const std::string wrong = unusable(message, topic, graph());
        if (wrong.empty()) answers_.add(topic, message);
        return wrong;
      });
    }
  }
}

bool Observer::complete(const msgs::TrafficSnapshot& snapshot, bool superseded) {
  constexpr double kPatience = 0.5;  // [s] of wall time for messages that are on their way
  const bool all = answers_.missing(snapshot).empty();
  if (all || over() || (superseded && !graph().recordsDecisions())) {
    waiting_since_ = {};
    return true;
  }
  if (!superseded || !answers_.decision(snapshot.tick)) return false;
  const ::ros::WallTime now = ::ros::WallTime::now();
  if (waiting_since_.isZero()) waiting_since_ = now;
  if ((now - waiting_since_).toSec() < kPatience) return false;
  waiting_since_ = {};
  return true;
}

}  // namespace cdiff::ros
