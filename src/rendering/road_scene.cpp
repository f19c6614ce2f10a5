// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/road_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "rendering/lane_surface.h"

namespace cdiff::rendering {
namespace {

constexpr double kCellSize = 25.0;  // [m]

int cellIndex(double offset, int count) {
  return offset > 0.0 ? static_cast<int>(std::min(offset, count - 1.0)) : 0;
}

/// Twice the signed area of a triangle, positive when counter-clockwise.
double turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool holds(const std::array<Eigen::Vector3d, 3>& triangle, const Eigen::Vector3d& point) {
  return turn(triangle[0], triangle[1], point) >= 0.0 &&
         turn(triangle[1], triangle[2], point) >= 0.0 &&
         turn(triangle[2], triangle[0], point) >= 0.0;
}

bool isEar(const std::vector<Eigen::Vector3d>& ring, std::size_t at) {
  const std::size_t before = (at + ring.size() - 1) % ring.size();
  const std::size_t after = (at + 1) % ring.size();
  const std::array<Eigen::Vector3d, 3> triangle = {ring[before], ring[at], ring[after]};
  if (turn(triangle[0], triangle[1], triangle[2]) <= 0.0) return false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (i == before || i == at || i == after) continue;
    if (turn(ring[(i + ring.size() - 1) % ring.size()], ring[i], ring[(i + 1) % ring.size()]) >=
        0.0)
      continue;  // only a corner that bends inwards can lie in an ear
    if (holds(triangle, ring[i])) return false;
  }
  return true;
}

void dropRepeated(std::vector<Eigen::Vector3d>& ring) {
  const auto same = [](const Eigen::Vector3d& left, const Eigen::Vector3d& right) {
    return (left - right).head<2>().squaredNorm() < 1e-6;
  };
  ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
  while (ring.size() > 1 && same(ring.front(), ring.back())) ring.pop_back();
}

constexpr double kLanePiece = 12.0;        // [m] longest piece of a lane
constexpr double kShortestSurface = 0.05;  // [m]
constexpr double kAsphaltMargin = 0.25;    // [m] beside a lane

Surface surfaceOf(const Eigen::Vector3d* corners, int count, Color color, double rank) {
  Surface surface;
  surface.count = count;
  surface.color = color;
  surface.rank = rank;
  std::copy_n(corners, count, surface.corners.begin());
  surface.up = (corners[2] - corners[0]).cross(corners[count == 4 ? 3 : 1] - corners[1]);
  if (count == 3) surface.up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (surface.up.z() < 0.0) surface.up = -surface.up;
  return surface;
}

void addLane(const map::Lane& lane, std::vector<Surface>& surfaces) {
  const double length = lane.centerline.length();
  if (length < kShortestSurface || lane.width <= 0.0) return;
  const bool road = lane.allows_cars;
  const double half_width = 0.5 * lane.width + (road ? kAsphaltMargin : 0.0);
  const auto sections = crossSections(lane.centerline, 0.0, length, kLanePiece);
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const Eigen::Vector3d corners[4] = {sections[i - 1].at(-half_width),
                                        sections[i].at(-half_width), sections[i].at(half_width),
                                        sections[i - 1].at(half_width)};
    surfaces.push_back(
        surfaceOf(corners, 4, road ? kAsphalt : kPavement, road ? rank::kRoad : rank::kPavement));
    surfaces.back().kind = road ? SceneClass::kRoad : SceneClass::kPavement;
  }
}

}  // namespace

std::vector<Surface> surfacesOf(const map::RoadNetwork& network) {
  std::vector<Surface> surfaces;
  for (const map::Junction& junction : network.junctions()) {
    for (const auto& triangle : triangulate(junction.shape)) {
      surfaces.push_back(surfaceOf(triangle.data(), 3, kAsphalt, rank::kRoad));
    }
  }
  for (const map::Lane& lane : network.lanes()) {
    // Crossings and walking areas lie on the junction's area.
    if (!lane.internal || lane.allows_cars) addLane(lane, surfaces);
  }
  const std::vector<Surface> sides = roadSides(network);
  surfaces.insert(surfaces.end(), sides.begin(), sides.end());
  return surfaces;
}

Bound boundOf(const Eigen::Vector3d* points, int count) {
  Eigen::Vector3d low = points[0];
  Eigen::Vector3d high = points[0];
  for (int i = 1; i < count; ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

SpatialGrid::SpatialGrid(std::vector<Bound> bounds) : bounds_(std::move(bounds)) {
  if (bounds_.empty()) return;
  origin_ = bounds_.front().center.head<2>();
  Eigen::Vector2d end = origin_;
  for (const Bound& bound : bounds_) {
    origin_ = origin_.cwiseMin(bound.center.head<2>());
    end = end.cwiseMax(bound.center.head<2>());
  }
  columns_ = static_cast<int>((end.x() - origin_.x()) / kCellSize) + 1;
  rows_ = static_cast<int>((end.y() - origin_.y()) / kCellSize) + 1;
  sortIntoCells();
  boundCells();
}

void SpatialGrid::sortIntoCells() {
  items_.resize(bounds_.size());
  std::iota(items_.begin(), items_.end(), 0);
  const auto cell_of = [&](int item) {
    return cellOf(bounds_[static_cast<std::size_t>(item)].center);
  };
  std::stable_sort(items_.begin(), items_.end(),
                   [&](int left, int right) { return cell_of(left) < cell_of(right); });
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  cell_begin_.assign(cells + 1, 0);
  for (const int item : items_) ++cell_begin_[cell_of(item) + 1];
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
}

void SpatialGrid::boundCells() {
  for (std::size_t cell = 0; cell + 1 < cell_begin_.size(); ++cell) {
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
      const Bound& bound = bounds_[static_cast<std::size_t>(items_[i])];
      corners.push_back(bound.center.array() - bound.radius);
      corners.push_back(bound.center.array() + bound.radius);
    }
    cell_bounds_.push_back(
        corners.empty() ? Bound{} : boundOf(corners.data(), static_cast<int>(corners.size())));
  }
}

std::size_t SpatialGrid::cellOf(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d offset = (point.head<2>() - origin_) / kCellSize;
  return static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(offset.x());
}

SpatialGrid::CellRange SpatialGrid::cellsAround(const std::vector<View>& views) const {
  CellRange range = {columns_, -1, rows_, -1};
  for (const View& view : views) {
    // Things and cells reach less than two cells beyond the cell of their center.
    const Eigen::Vector2d offset = (view.eye().head<2>() - origin_) / kCellSize;
    const double reach = view.farDistance() / kCellSize + 2.0;
    range.first_column = std::min(range.first_column, cellIndex(offset.x() - reach, columns_));
    range.last_column = std::max(range.last_column, cellIndex(offset.x() + reach, columns_));
    range.first_row = std::min(range.first_row, cellIndex(offset.y() - reach, rows_));
    range.last_row = std::max(range.last_row, cellIndex(offset.y() + reach, rows_));
  }
  return range;
}

void SpatialGrid::visibleIn(std::size_t cell, const View& view, std::vector<int>& found) const {
  if (!view.maySee(cell_bounds_[cell].center, cell_bounds_[cell].radius)) return;
  for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
    const Bound& bound = bounds_[static_cast<std::size_t>(items_[i])];
    if (view.maySee(bound.center, bound.radius)) found.push_back(items_[i]);
  }
}

void SpatialGrid::visible(const std::vector<View>& views,
                          std::vector<std::vector<int>>& found) const {
  found.resize(views.size());
  for (std::vector<int>& of_view : found) of_view.clear();
  if (bounds_.empty()) return;
  const CellRange range = cellsAround(views);
  for (int row = range.first_row; row <= range.last_row; ++row) {
    for (int column = range.first_column; column <= range.last_column; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column);
      if (cell_begin_[cell] == cell_begin_[cell + 1]) continue;
      for (std::size_t i = 0; i < views.size(); ++i) visibleIn(cell, views[i], found[i]);
    }
  }
}

std::vector<std::array<Eigen::Vector3d, 3>> triangulate(std::vector<Eigen::Vector3d> outline) {
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  dropRepeated(outline);
  if (outline.size() < 3) return triangles;
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    area += turn(outline[0], outline[i], outline[i + 1]);
  }
  if (area < 0.0) std::reverse(outline.begin(), outline.end());
  while (outline.size() > 3) {
    std::size_t ear = 0;
    while (ear < outline.size() && !isEar(outline, ear)) ++ear;
    if (ear == outline.size()) break;
    triangles.push_back({outline[(ear + outline.size() - 1) % outline.size()], outline[ear],
                         outline[(ear + 1) % outline.size()]});
    outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    triangles.push_back({outline[0], outline[i], outline[i + 1]});
  }
  return triangles;
}

Marking markingBetween(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, double width,
                       Color color) {
  Marking marking;
  marking.begin = begin;
  marking.end = end;
  marking.color = color;
  const Eigen::Vector2d along = (end - begin).head<2>();
  const double length = std::max(along.norm(), 1e-9);
  marking.side.head<2>() = geometry::leftNormal(along) * (0.5 * width / length);
  return marking;
}

void drawMarking(const Marking& marking, double rank, const View& view, Canvas& canvas) {
  const Eigen::Vector3d up = (marking.end - marking.begin).cross(marking.side);
  if (up.dot(view.eye() - marking.begin) <= 0.0) return;
  canvas.line(view.toCamera(marking.begin), view.toCamera(marking.end),
              view.directionToCamera(marking.side),
              {marking.color, rank, 1.0, {SceneClass::kMarking, 0}});
}

RoadScene::RoadScene(const map::RoadNetwork& network)
    : surfaces_(surfacesOf(network)), markings_(laneMarkings(network)) {
  std::vector<Bound> bounds;
  for (const Surface& surface : surfaces_) {
    bounds.push_back(boundOf(surface.corners.data(), surface.count));
  }
  surface_grid_ = SpatialGrid(std::move(bounds));
  bounds.clear();
  for (const Marking& marking : markings_) {
    const Eigen::Vector3d ends[2] = {marking.begin, marking.end};
    bounds.push_back(boundOf(ends, 2));
  }
  marking_grid_ = SpatialGrid(std::move(bounds));
}

void RoadScene::drawSurface(const Surface& surface, const View& view, Canvas& canvas) const {
  Eigen::Vector3d corners[4];
  for (int i = 0; i < surface.count; ++i) {
    corners[i] = view.toCamera(surface.corners[static_cast<std::size_t>(i)]);
  }
  const bool from_above =
      surface.two_sided || surface.up.dot(view.eye() - surface.corners[0]) > 0.0;
  const Label label = {from_above ? surface.kind : SceneClass::kStructure, 0};
  canvas.fill(corners, surface.count,
              {from_above ? surface.color : kUnderside, surface.rank, 1.0, label});
}

void RoadScene::sortMarkings(const View& view, std::vector<int>& markings) {
  by_distance_.clear();
  for (const int i : markings) {
    const Marking& marking = markings_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d offset = 0.5 * (marking.begin + marking.end) - view.eye();
    const double distance = offset.x() * offset.x() + offset.y() * offset.y();
    by_distance_.emplace_back(-distance, i);
  }
  std::sort(by_distance_.begin(), by_distance_.end());
  std::transform(by_distance_.begin(), by_distance_.end(), markings.begin(),
                 [](const auto& entry) { return entry.second; });
}

void RoadScene::look(const std::vector<View>& views) {
  surface_grid_.visible(views, visible_surfaces_);
  marking_grid_.visible(views, visible_markings_);
}

void RoadScene::draw(std::size_t index, const View& view, Canvas& canvas) {
  for (const int i : visible_surfaces_[index])
    drawSurface(surfaces_[static_cast<std::size_t>(i)], view, canvas);
  sortMarkings(view, visible_markings_[index]);
  for (const int i : visible_markings_[index])
    drawMarking(markings_[static_cast<std::size_t>(i)], rank::kMarking, view, canvas);
}

}  // namespace cdiff::rendering
