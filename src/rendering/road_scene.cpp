// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/road_scene.h"

#include <algorithm>
#include <cstddef>

#include "rendering/lane_surface.h"

namespace cdiff::rendering {
namespace {

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

}  // namespace

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

namespace {

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
  }
}

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

}  // namespace

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
              view.directionToCamera(marking.side), {marking.color, rank, 1.0});
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
  canvas.fill(corners, surface.count, {from_above ? surface.color : kUnderside, surface.rank, 1.0});
}

void RoadScene::sortMarkings(const View& view) {
  by_distance_.clear();
  for (const int i : visible_) {
    const Marking& marking = markings_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d offset = 0.5 * (marking.begin + marking.end) - view.eye();
    const double distance = offset.x() * offset.x() + offset.y() * offset.y();
    by_distance_.emplace_back(-distance, i);
  }
  std::sort(by_distance_.begin(), by_distance_.end());
  std::transform(by_distance_.begin(), by_distance_.end(), visible_.begin(),
                 [](const auto& entry) { return entry.second; });
}

void RoadScene::draw(const View& view, Canvas& canvas) {
  surface_grid_.visible(view, visible_);
  for (const int i : visible_) drawSurface(surfaces_[static_cast<std::size_t>(i)], view, canvas);
  marking_grid_.visible(view, visible_);
  sortMarkings(view);
  for (const int i : visible_) {
    drawMarking(markings_[static_cast<std::size_t>(i)], rank::kMarking, view, canvas);
  }
}

}  // namespace cdiff::rendering
