// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/slot_figures.h"

#include <limits>

#include "metrics/formulas/ttc_2d.h"

namespace cdiff::node_graph {

std::vector<SlotFigure> slotFigures(const traffic::TrafficSnapshot& snapshot,
                                    const cbv::CbvSelection& selection) {
  std::vector<SlotFigure> figures;
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return figures;
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const traffic::Vehicle* cbv = snapshot.find(assignment.vehicle_id);
    if (cbv == nullptr) continue;
    const auto time = metrics::timeToCollision2d({ego->box(), ego->state.velocity()},
                                                 {cbv->box(), cbv->state.velocity()});
    const int slot = assignment.slot;
    figures.push_back(
        {Topic(ChannelId::kCbvTtc, slot), time.value_or(std::numeric_limits<double>::quiet_NaN())});
    figures.push_back(
        {Topic(ChannelId::kCbvGap, slot), geometry::distance(ego->box(), cbv->box())});
    figures.push_back({Topic(ChannelId::kCbvScore, slot), assignment.interaction_score});
  }
  return figures;
}

}  // namespace cdiff::node_graph
