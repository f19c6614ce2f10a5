// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/cbv_identification_node.h"

#include "core/text.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {

void CbvIdentificationNode::startSession(const msgs::SessionInfo& info) {
  options_ = optionsFromMsg(info);
  network_.emplace(map::RoadNetwork::fromText(info.network_text, info.network_source));
  graph_.emplace(*network_);
  selections_ = advertise<msgs::CbvSelection>(ChannelId::kSelection);
  listen<nav_msgs::Path>(ChannelId::kEgoRoute,
                         [this](const nav_msgs::PathConstPtr& path) { takeRoute(*path); });
}

void CbvIdentificationNode::takeRoute(const nav_msgs::Path& path) {
  if (selector_ || path.poses.empty())
    return;  // an empty path means "no route"; the session's route never changes
  ego_route_ = map::matchRoute(*network_, fromMsg(path));
  selector_ = std::make_unique<cbv::CbvSelector>(options_.cbv, graph().max_cbv, *graph_, ego_route_,
                                                 options_.mode);
}

std::string CbvIdentificationNode::waitingFor() const {
  return selector_ ? "" : "no ego route has come yet";
}

bool CbvIdentificationNode::handle(const Snapshot& message, bool) {
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  if (snapshot.decision_tick) {
    newest_ = selector_->update(snapshot);
    selections_.publish(
        boost::make_shared<const msgs::CbvSelection>(toMsg(newest_, snapshot.time, *network_)));
  } else {
    selector_->observe(snapshot);
  }
  return true;
}

void CbvIdentificationNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  std::vector<std::string> chosen;
  for (const cbv::CbvAssignment& assignment : newest_.assignments)
    chosen.push_back(assignment.vehicle_id);
  status.add("CBVs", core::joinText(chosen, ", "));
  status.add("candidates rejected", newest_.rejected.size());
}

}  // namespace cdiff::node_graph
