// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/map_markers.h"

#include "node_graph/messages/marker_parts.h"
#include "rendering/lane_surface.h"
#include "rendering/road_scene.h"

namespace cdiff::node_graph {
namespace {

using visualization_msgs::Marker;

constexpr double kMarkingLift = 0.04;  // [m] above the road

/// `color` as the canvas has it (0x00bbggrr).
MarkerColor unpacked(rendering::Color color) {
  const auto part = [&](int shift) {
    return static_cast<float>((color >> shift) & 0xFFU) / 255.0F;
  };
  return {part(0), part(8), part(16), 1.0F};
}

Marker surfaceMarker(const map::RoadNetwork& network) {
  Marker marker = makeMarker("surfaces", 0, Marker::TRIANGLE_LIST, marker_color::kSoft);
  for (const rendering::Surface& surface : rendering::surfacesOf(network)) {
    // Of surfaces in one plane the one of the higher rank lies on top.
    const Eigen::Vector3d lift(0.0, 0.0, surface.rank - rendering::rank::kRoad);
    const auto at = [&](std::size_t i) -> Eigen::Vector3d { return surface.corners[i] + lift; };
    const MarkerColor color = unpacked(surface.color);
    addTriangle(marker, at(0), at(1), at(2), color);
    if (surface.count == 4) addTriangle(marker, at(0), at(2), at(3), color);
  }
  return marker;
}

Marker markingMarker(const map::RoadNetwork& network) {
  Marker marker = makeMarker("markings", 0, Marker::TRIANGLE_LIST, marker_color::kWhite);
  const Eigen::Vector3d lift(0.0, 0.0, kMarkingLift);
  for (const rendering::Marking& marking : rendering::laneMarkings(network)) {
    const Eigen::Vector3d begin = marking.begin + lift;
    const Eigen::Vector3d end = marking.end + lift;
    const Eigen::Vector3d corners[4] = {begin - marking.side, end - marking.side,
                                        end + marking.side, begin + marking.side};
    addQuad(marker, corners, unpacked(marking.color));
  }
  return marker;
}

std::vector<Marker> egoGoalMarkers(const map::Route& route) {
  const geometry::Polyline& path = route.path();
  Eigen::Vector3d goal = path.points().back();
  Marker disc = makeMarker("ego_goal", 0, Marker::CYLINDER, marker_color::kEgo);
  disc.pose.position = toMarkerPoint(goal, 0.1);
  disc.scale.x = disc.scale.y = 4.0;
  disc.scale.z = 0.1;
  Labels label("ego_goal_label");
  goal += Eigen::Vector3d(0.0, -4.0, 1.0);
  label.add(0, "goal of the ego", goal, 2.0, marker_color::kEgo);
  std::vector<Marker> markers = {disc};
  appendMarkers(markers, label.markers());
  return markers;
}

}  // namespace

visualization_msgs::MarkerArray mapMarkers(const session::SessionSetup& setup) {
  visualization_msgs::MarkerArray array;
  array.markers = {deleteAllMarkers(), surfaceMarker(setup.network()),
                   markingMarker(setup.network())};
  appendMarkers(array.markers,
                routeMarkers("ego_route", 0, setup.egoRoute(), marker_color::kEgoRoute));
  appendMarkers(array.markers, egoGoalMarkers(setup.egoRoute()));
  return array;
}

}  // namespace cdiff::node_graph
