// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/road_network.h"

#include <algorithm>

#include "e2e_cdiff/core/angle.h"
#include "map/network_reader.h"
#include "map/spatial_index.h"

namespace cdiff::map {
namespace {

/// Nearest first, ties by lane index.
bool nearer(const LaneMatch& left, const LaneMatch& right) {
  if (left.projection.distance != right.projection.distance) {
    return left.projection.distance < right.projection.distance;
  }
  return left.lane < right.lane;
}

}  // namespace

RoadNetwork::RoadNetwork() = default;
RoadNetwork::RoadNetwork(RoadNetwork&&) noexcept = default;
RoadNetwork& RoadNetwork::operator=(RoadNetwork&&) noexcept = default;
RoadNetwork::~RoadNetwork() = default;

RoadNetwork RoadNetwork::fromText(std::string_view xml, const std::string& name) {
  return NetworkReader(name).read(xml);
}

LaneIndex RoadNetwork::findLane(const std::string& id) const {
  const auto found = lane_by_id_.find(id);
  return found == lane_by_id_.end() ? kNoLane : found->second;
}

std::vector<LaneIndex> RoadNetwork::lanesOfEdge(const std::string& edge_id) const {
  std::vector<LaneIndex> found;
  for (LaneIndex lane = findLane(edge_id + "_0"); lane != kNoLane;
       lane = findLane(edge_id + "_" + std::to_string(found.size()))) {
    found.push_back(lane);
  }
  return found;
}

std::vector<LaneMatch> RoadNetwork::lanesNear(const Eigen::Vector2d& position, double elevation,
                                              double radius, double heading,
                                              double level_height) const {
  SpatialIndex::Query query;
  query.position = position;
  query.radius = radius;
  query.elevation = elevation;
  query.level_height = level_height;
  std::vector<LaneMatch> matches;
  for (const SpatialIndex::Hit& hit : index_->find(lanes_, query)) {
    const geometry::Polyline& line = lane(hit.lane).centerline;
    const auto segment = static_cast<std::size_t>(hit.segment);
    LaneMatch match;
    match.lane = hit.lane;
    match.projection =
        line.project(position, line.arcLengths()[segment], line.arcLengths()[segment + 1]);
    match.heading_difference = core::angleDifference(match.projection.heading, heading);
    matches.push_back(match);
  }
  std::sort(matches.begin(), matches.end(), nearer);
  return matches;
}

std::vector<LaneMatch> RoadNetwork::lanesNear(const Eigen::Vector2d& position,
                                              double radius) const {
  return lanesNear(position, 0.0, radius, 0.0, std::numeric_limits<double>::infinity());
}

}  // namespace cdiff::map
