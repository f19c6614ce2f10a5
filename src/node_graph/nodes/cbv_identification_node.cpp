// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/cbv_identification_node.h"

#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {

void CbvIdentificationNode::startSession(const msgs::SessionInfo& info) {
  const session::ScenarioOptions options = optionsFromMsg(info);
  options_ = options.cbv.inMode(options.mode);
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
  selector_ = std::make_unique<cbv::CbvSelector>(options_, graph().max_cbv, *graph_, ego_route_);
}

std::string CbvIdentificationNode::waitingFor() const {
  return selector_ ? "" : "no ego route has come yet";
}

bool CbvIdentificationNode::handle(const Snapshot& message, bool) {
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  if (snapshot.decision_tick) {
    selections_.publish(boost::make_shared<const msgs::CbvSelection>(
        toMsg(selector_->update(snapshot), snapshot.time, *network_)));
  } else {
    selector_->observe(snapshot);
  }
  return true;
}

}  // namespace cdiff::node_graph
