// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <limits>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/route_search.h"
#include "map/route_source.h"

namespace cdiff::map {
namespace {

/// A lane of one edge of the list and the cheapest route to it.
struct EdgeLane {
  LaneIndex lane = kNoLane;
  double cost = kInfinity;
  std::vector<LaneIndex> before;  ///< lanes between the lane that it is reached from and itself
  std::size_t parent = 0;         ///< place of that lane in its own layer
  bool beside = false;            ///< reached from a neighbor of the same edge
};

/// Chooses one lane row through a list of edges: connected, and with the fewest lane changes.
class EdgeRow {
 public:
  EdgeRow(const RoadNetwork& network, const std::vector<std::string>& edges)
      : network_(network), edges_(edges) {}

  LanePath choose() {
    for (const std::string& edge : edges_) addLayer(edge);
    for (EdgeLane& first : layers_.front()) first.cost = 0.0;
    for (std::size_t i = 0; i + 1 < layers_.size(); ++i) {
      if (i > 0) spreadBeside(layers_[i]);  // the first edge is entered on the lane that suits
      advance(i);
    }
    return trace();
  }

 private:
  void addLayer(const std::string& edge) {
    const std::vector<LaneIndex> lanes = network_.lanesOfEdge(edge);
    if (lanes.empty()) {
      throw core::InputError("unknown edge '" + edge + "'; the nearest name in this network is '" +
                             core::nearestName(edge, network_.edgeIds()) + "'");
    }
    std::vector<EdgeLane> layer;
    for (const bool slow_too : {false, true}) {
      for (const LaneIndex index : lanes) {
        const Lane& lane = network_.lane(index);
        if (!lane.routable && !(slow_too && lane.allows_cars)) continue;
        layer.push_back({index, kInfinity, {}, 0, false});
      }
      if (!layer.empty()) break;
    }
    if (layer.empty()) throw core::InputError("edge '" + edge + "' has no lane that cars may use");
    layers_.push_back(std::move(layer));
  }

  /// Lane changes inside an edge, from right to left and back.
  void spreadBeside(std::vector<EdgeLane>& layer) const {
    const auto relax = [&](std::size_t from, std::size_t to) {
      const Lane& lane = network_.lane(layer[from].lane);
      if (lane.left != layer[to].lane && lane.right != layer[to].lane) return;
      const double cost = layer[from].cost + laneChangePenalty(lane, lane.centerline.length());
      if (cost >= layer[to].cost) return;
      layer[to] = {layer[to].lane, cost, {}, from, true};
    };
    for (std::size_t i = 0; i + 1 < layer.size(); ++i) relax(i, i + 1);
    for (std::size_t i = layer.size(); i-- > 1;) relax(i, i - 1);
  }

  void advance(std::size_t i) {
    for (std::size_t from = 0; from < layers_[i].size(); ++from) {
      if (layers_[i][from].cost < kInfinity) follow(i, from, {layers_[i][from].lane});
    }
    const auto open = [](const EdgeLane& lane) { return lane.cost < kInfinity; };
    if (std::any_of(layers_[i + 1].begin(), layers_[i + 1].end(), open)) return;
    throw core::InputError("no connection for cars from edge '" + edges_[i] + "' to edge '" +
                           edges_[i + 1] + "'" + successorsText(edges_[i]));
  }

  /// Follows links through the junction after edge `i`; `route` starts with the lane left and ends
  /// with the lane reached.
  void follow(std::size_t i, std::size_t from, const std::vector<LaneIndex>& lanes) {
    for (const LaneLink& link : network_.lane(lanes.back()).next) {
      const Lane& next = network_.lane(link.to);
      if (!next.allows_cars) continue;
      std::vector<LaneIndex> longer = lanes;
      if (next.internal) {
        longer.push_back(link.to);
        follow(i, from, longer);
        continue;
      }
      for (EdgeLane& lane : layers_[i + 1]) {
        if (lane.lane != link.to || layers_[i][from].cost >= lane.cost) continue;
        lane = {lane.lane, layers_[i][from].cost, {lanes.begin() + 1, lanes.end()}, from, false};
      }
    }
  }

  std::string successorsText(const std::string& edge) const {
    std::vector<std::string> found;
    std::vector<LaneIndex> open = network_.lanesOfEdge(edge);
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (const LaneLink& link : network_.lane(open[i]).next) {
        const Lane& next = network_.lane(link.to);
        if (next.internal) open.push_back(link.to);
        if (!next.internal) found.push_back("'" + next.edge_id + "'");
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (found.empty()) return "; it leads nowhere";
    return "; it leads to " + core::joinText(found, ", ");
  }

  LanePath trace() const {
    const auto cheaper = [](const EdgeLane& left, const EdgeLane& right) {
      return left.cost < right.cost;
    };
    const std::vector<EdgeLane>& last = layers_.back();
    auto place = static_cast<std::size_t>(std::min_element(last.begin(), last.end(), cheaper) -
                                          last.begin());
    LanePath path;
    for (std::size_t i = layers_.size(); i-- > 0;) {
      while (layers_[i][place].beside) {
        path.lanes.push_back(layers_[i][place].lane);
        place = layers_[i][place].parent;
      }
      const EdgeLane& lane = layers_[i][place];
      path.lanes.push_back(lane.lane);
      path.lanes.insert(path.lanes.end(), lane.before.rbegin(), lane.before.rend());
      place = lane.parent;
    }
    std::reverse(path.lanes.begin(), path.lanes.end());
    return path;
  }

  const RoadNetwork& network_;
  const std::vector<std::string>& edges_;
  std::vector<std::vector<EdgeLane>> layers_;
};

}  // namespace

Route routeAlongEdges(const LaneGraph& graph, const std::vector<std::string>& edges,
                      double start_offset, double end_offset) {
  if (edges.empty()) throw core::InputError("a route along edges needs at least one edge");
  const RoadNetwork& network = graph.network();
  const LanePath path = EdgeRow(network, edges).choose();
  const double first_length = network.lane(path.lanes.front()).centerline.length();
  const double last_length = network.lane(path.lanes.back()).centerline.length();
  const double goal = last_length - end_offset;
  const auto fail = [](const std::string& edge, double length, const std::string& what) {
    throw core::InputError("edge '" + edge + "' is " + core::formatFixed(length, 2) + " m long; " +
                           what);
  };
  if (start_offset >= first_length) {
    fail(edges.front(), first_length,
         "start_offset " + core::formatNumber(start_offset) + " m lies beyond it");
  }
  if (goal <= (edges.size() == 1 ? start_offset : 0.0)) {
    fail(edges.back(), last_length,
         "end_offset " + core::formatNumber(end_offset) + " m leaves no distance to drive on it");
  }
  return graph.toRoute(path, start_offset, goal);
}

}  // namespace cdiff::map
