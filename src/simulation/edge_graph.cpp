// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/edge_graph.h"

#include <algorithm>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::simulation {

using map::kNoLane;
using map::Lane;
using map::LaneIndex;

namespace {

constexpr int kLongestChain = 8;  ///< internal lanes in a row; junctions have one to three

/// The first lane outside the junction that a lane leads to.
LaneIndex leaveJunction(const map::RoadNetwork& network, LaneIndex lane) {
  for (int i = 0; i < kLongestChain && network.lane(lane).internal; ++i) {
    if (network.lane(lane).next.empty()) return kNoLane;
    lane = network.lane(lane).next.front().to;
  }
  return network.lane(lane).internal ? kNoLane : lane;
}

/// The last lane before the junction that an internal lane lies in.
LaneIndex beforeJunction(const map::RoadNetwork& network, LaneIndex lane) {
  for (int i = 0; i < kLongestChain && network.lane(lane).internal; ++i) {
    if (network.lane(lane).previous.empty()) return kNoLane;
    lane = network.lane(lane).previous.front();
  }
  return network.lane(lane).internal ? kNoLane : lane;
}

double turnBetween(const Lane& from, const Lane& to) {
  const double before = from.centerline.headingAt(from.centerline.length());
  return std::abs(core::angleDifference(to.centerline.headingAt(0.0), before));
}

}  // namespace

EdgeGraph::EdgeGraph(const map::RoadNetwork& network) : network_(network) {
  for (const std::string& id : network.edgeIds()) {
    edge_by_id_.emplace(id, static_cast<int>(edge_by_id_.size()));
  }
  for (const std::string& id : network.edgeIds()) {
    Edge edge;
    edge.lanes = network.lanesOfEdge(id);
    if (!edge.lanes.empty()) edge.length = network.lane(edge.lanes.front()).centerline.length();
    for (LaneIndex lane : edge.lanes) addLinks(edge, lane);
    edges_.push_back(std::move(edge));
  }
  for (LaneIndex lane = 0; lane < static_cast<LaneIndex>(network.lanes().size()); ++lane) {
    const LaneIndex before = beforeJunction(network, lane);
    edge_of_lane_.push_back(before == kNoLane ? kNoEdge : find(network.lane(before).edge_id));
    const LaneIndex after = leaveJunction(network, lane);
    edge_after_lane_.push_back(after == kNoLane ? kNoEdge : find(network.lane(after).edge_id));
  }
}

void EdgeGraph::addLinks(Edge& edge, LaneIndex from) {
  const Lane& lane = network_.lane(from);
  for (const map::LaneLink& link : lane.next) {
    Link connection;
    connection.from_lane = from;
    connection.to_lane = leaveJunction(network_, link.to);
    if (connection.to_lane == kNoLane) continue;
    const Lane& next = network_.lane(connection.to_lane);
    if (!lane.allows_cars || !next.allows_cars) continue;
    connection.to = find(next.edge_id);
    connection.routable = lane.routable && next.routable;
    connection.turn = turnBetween(lane, next);
    edge.links.push_back(connection);
  }
}

int EdgeGraph::find(const std::string& id) const {
  const auto found = edge_by_id_.find(id);
  return found == edge_by_id_.end() ? kNoEdge : found->second;
}

bool EdgeGraph::connected(int from, int to) const {
  const std::vector<Link>& ways = links(from);
  return std::any_of(ways.begin(), ways.end(), [to](const Link& link) { return link.to == to; });
}

bool EdgeGraph::onRoute(LaneIndex lane, const std::vector<int>& edges) const {
  const int before = edgeOf(lane);
  const int after = edgeAfter(lane);
  const bool inside = network_.lane(lane).internal;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i] != before) continue;
    if (!inside || (i + 1 < edges.size() && edges[i + 1] == after)) return true;
  }
  return false;
}

LaneIndex EdgeGraph::nextLane(LaneIndex lane, const std::vector<int>& edges) const {
  const auto here = std::find(edges.begin(), edges.end(), edgeOf(lane));
  if (here == edges.end() || here + 1 == edges.end()) return kNoLane;
  for (const map::LaneLink& link : network_.lane(lane).next) {
    if (edgeAfter(link.to) == *(here + 1)) return link.to;
  }
  return kNoLane;
}

void EdgeGraph::extend(std::vector<int>& edges, double length) const {
  constexpr std::size_t kAtLeast = 2;
  double added = 0.0;
  for (std::size_t count = 0; added < length || count < kAtLeast; ++count) {
    const Link* best = nullptr;
    for (const Link& link : links(edges.back())) {
      const bool again = std::find(edges.begin(), edges.end(), link.to) != edges.end();
      if (link.routable && !again && (best == nullptr || link.turn < best->turn)) best = &link;
    }
    if (best == nullptr) return;
    edges.push_back(best->to);
    added += this->length(best->to);
  }
}

std::vector<std::string> EdgeGraph::ids(const std::vector<int>& edges) const {
  std::vector<std::string> names;
  names.reserve(edges.size());
  for (int edge : edges) names.push_back(id(edge));
  return names;
}

}  // namespace cdiff::simulation
