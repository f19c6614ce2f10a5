// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/road_network.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "map/network_reader.h"
#include "map/spatial_index.h"

namespace cdiff::map {
namespace {

using Index = std::size_t;

/// Nearest first, ties by lane index.
bool nearer(const LaneMatch& left, const LaneMatch& right) {
  if (left.projection.distance != right.projection.distance) {
    return left.projection.distance < right.projection.distance;
  }
  return left.lane < right.lane;
}

}  // namespace

RoadNetwork::SpatialIndex::Entry::Entry(const std::vector<Lane>& lanes, LaneIndex of_lane,
                                        int of_segment)
    : lane(of_lane), segment(of_segment) {
  const auto& points = lanes[static_cast<Index>(lane)].centerline.points();
  const Eigen::Vector3d& from = points[static_cast<Index>(segment)];
  const Eigen::Vector3d& to = points[static_cast<Index>(segment) + 1];
  start = from.head<2>();
  along = (to - from).head<2>();
  squared_length = along.squaredNorm();
  elevation = from.z();
  rise = to.z() - from.z();
}

RoadNetwork::SpatialIndex::SpatialIndex(const std::vector<Lane>& lanes) {
  setBounds(lanes);
  const Index cells = static_cast<Index>(columns_) * static_cast<Index>(rows_);
  cell_begin_.assign(cells + 1, 0);
  for (const Lane& lane : lanes) {
    visitCells(lane, [&](Index cell, int) { ++cell_begin_[cell + 1]; });
  }
  for (Index cell = 0; cell < cells; ++cell) cell_begin_[cell + 1] += cell_begin_[cell];
  entries_.resize(cell_begin_.back());
  std::vector<Index> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (Index i = 0; i < lanes.size(); ++i) {
    visitCells(lanes[i], [&](Index cell, int segment) {
      entries_[next[cell]++] = Entry(lanes, static_cast<LaneIndex>(i), segment);
    });
  }
}

void RoadNetwork::SpatialIndex::setBounds(const std::vector<Lane>& lanes) {
  constexpr double kMaxCells = 1e6;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const Lane& lane : lanes) {
    if (!lane.allows_cars) continue;
    for (const Eigen::Vector3d& point : lane.centerline.points()) {
      low = low.cwiseMin(point.head<2>());
      high = high.cwiseMax(point.head<2>());
    }
  }
  if (!(low.x() <= high.x())) return;
  origin_ = low;
  const Eigen::Vector2d size = high - low;
  const auto count = [&] { return (size.x() / cell_size_ + 1.0) * (size.y() / cell_size_ + 1.0); };
  while (count() > kMaxCells) cell_size_ *= 2.0;
  columns_ = static_cast<int>(size.x() / cell_size_) + 1;
  rows_ = static_cast<int>(size.y() / cell_size_) + 1;
}

int RoadNetwork::SpatialIndex::columnOf(double x) const {
  const double column = std::floor((x - origin_.x()) / cell_size_);
  return static_cast<int>(std::clamp(column, 0.0, columns_ - 1.0));
}

int RoadNetwork::SpatialIndex::rowOf(double y) const {
  const double row = std::floor((y - origin_.y()) / cell_size_);
  return static_cast<int>(std::clamp(row, 0.0, rows_ - 1.0));
}

/// Calls visit(cell, segment) once or more for every cell that a segment of the lane passes.
template <class Visit>
void RoadNetwork::SpatialIndex::visitCells(const Lane& lane, Visit&& visit) const {
  if (!lane.allows_cars) return;
  const auto& points = lane.centerline.points();
  for (Index i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector2d start = points[i].head<2>();
    const Eigen::Vector2d along = points[i + 1].head<2>() - start;
    const int pieces = static_cast<int>(along.norm() / cell_size_) + 1;
    for (int piece = 0; piece < pieces; ++piece) {
      const Eigen::Vector2d from = start + along * (static_cast<double>(piece) / pieces);
      const Eigen::Vector2d to = start + along * (static_cast<double>(piece + 1) / pieces);
      const int last_row = rowOf(std::max(from.y(), to.y()));
      const int last_column = columnOf(std::max(from.x(), to.x()));
      for (int row = rowOf(std::min(from.y(), to.y())); row <= last_row; ++row) {
        for (int column = columnOf(std::min(from.x(), to.x())); column <= last_column; ++column) {
          visit(static_cast<Index>(row) * static_cast<Index>(columns_) + static_cast<Index>(column),
                static_cast<int>(i));
        }
      }
    }
  }
}

/// By lane, each lane's nearest first.
bool RoadNetwork::SpatialIndex::before(const Hit& left, const Hit& right) {
  if (left.lane != right.lane) return left.lane < right.lane;
  if (left.squared_distance != right.squared_distance) {
    return left.squared_distance < right.squared_distance;
  }
  return left.segment < right.segment;
}

/// The segments of a lane mostly come one after the other: only the nearest of them stays.
void RoadNetwork::SpatialIndex::keepNearest(const Hit& hit, std::vector<Hit>& hits) {
  if (hits.empty() || hits.back().lane != hit.lane) {
    hits.push_back(hit);
  } else if (before(hit, hits.back())) {
    hits.back() = hit;
  }
}

std::vector<RoadNetwork::SpatialIndex::Hit> RoadNetwork::SpatialIndex::find(
    const Query& query) const {
  std::vector<Hit> hits;
  if (!query.position.allFinite() || !(query.radius >= 0.0)) return hits;
  const double limit = query.radius * query.radius;
  const int last_row = rowOf(query.position.y() + query.radius);
  const int first_column = columnOf(query.position.x() - query.radius);
  const int last_column = columnOf(query.position.x() + query.radius);
  for (int row = rowOf(query.position.y() - query.radius); row <= last_row; ++row) {
    const Index row_begin = static_cast<Index>(row) * static_cast<Index>(columns_);
    const Index end = cell_begin_[row_begin + static_cast<Index>(last_column) + 1];
    for (Index i = cell_begin_[row_begin + static_cast<Index>(first_column)]; i < end; ++i) {
      const Entry& entry = entries_[i];
      const Eigen::Vector2d offset = query.position - entry.start;
      const double fraction = std::clamp(entry.along.dot(offset) / entry.squared_length, 0.0, 1.0);
      const double squared = (offset - fraction * entry.along).squaredNorm();
      if (squared > limit) continue;
      const double elevation = entry.elevation + fraction * entry.rise;
      if (std::abs(elevation - query.elevation) > query.level_height) continue;
      keepNearest({entry.lane, entry.segment, squared}, hits);
    }
  }
  std::sort(hits.begin(), hits.end(), before);
  const auto same_lane = [](const Hit& left, const Hit& right) { return left.lane == right.lane; };
  hits.erase(std::unique(hits.begin(), hits.end(), same_lane), hits.end());
  return hits;
}

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
  for (const SpatialIndex::Hit& hit : index_->find(query)) {
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
