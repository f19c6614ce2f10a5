// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "storyboard/reading.h"

namespace cdiff::storyboard {
namespace {

using Kind = Position::Kind;

void readOrientation(const XoscElement& element, const Reading& reading, Position& position) {
  const auto orientation = element.find("Orientation");
  if (!orientation) return;
  position.oriented = true;
  position.heading = (reading.carla ? -1.0 : 1.0) * orientation->number("h", 0.0);
  position.absolute_heading = orientation->text("type", "absolute") == "absolute";
}

Position readWorld(const XoscElement& element, const Reading& reading) {
  const double side = reading.carla ? -1.0 : 1.0;
  Position position;
  position.point = {element.number("x"), side * element.number("y"), element.number("z", 0.0)};
  position.level = element.has("z");
  position.oriented = element.has("h");
  position.heading = side * element.number("h", 0.0);
  position.absolute_heading = true;
  return position;
}

Position readDifferences(const XoscElement& element, const Reading& reading, Kind kind) {
  Position position;
  position.kind = kind;
  position.entity = element.text("entityRef");
  const double side = reading.carla ? -1.0 : 1.0;
  position.point = {element.number("dx"), side * element.number("dy"), element.number("dz", 0.0)};
  readOrientation(element, reading, position);
  return position;
}

Position readObject(const XoscElement& element, const Reading& reading) {
  return readDifferences(element, reading, Kind::kObject);
}

Position readRelativeWorld(const XoscElement& element, const Reading& reading) {
  return readDifferences(element, reading, Kind::kRelativeWorld);
}

Position readLane(const XoscElement& element, const Reading& reading) {
  Position position;
  position.kind = Kind::kLane;
  position.road = element.text("roadId");
  position.lane = element.integer("laneId");
  position.s = element.number("s");
  position.t = element.number("offset", 0.0);
  readOrientation(element, reading, position);
  return position;
}

Position readRoad(const XoscElement& element, const Reading& reading) {
  Position position;
  position.kind = Kind::kRoad;
  position.road = element.text("roadId");
  position.s = element.number("s");
  position.t = element.number("t");
  readOrientation(element, reading, position);
  return position;
}

Position readRelativeLane(const XoscElement& element, const Reading& reading) {
  Position position;
  position.kind = Kind::kRelativeLane;
  position.entity = element.text("entityRef");
  position.lane = element.integer("dLane");
  position.s = element.has("dsLane") ? element.number("dsLane") : element.number("ds");
  position.t = element.number("offset", 0.0);
  readOrientation(element, reading, position);
  return position;
}

Position readRelativeRoad(const XoscElement& element, const Reading& reading) {
  Position position;
  position.kind = Kind::kRelativeRoad;
  position.entity = element.text("entityRef");
  position.s = element.number("ds");
  position.t = element.number("dt");
  readOrientation(element, reading, position);
  return position;
}

Position readRoutePosition(const XoscElement& element, const Reading& reading) {
  Position position;
  const XoscElement where = element.child("InRoutePosition").only();
  if (where.name() == "FromCurrentEntity") {
    position.kind = Kind::kObject;
    position.entity = where.text("entityRef");
    return position;
  }
  position.kind = Kind::kRoute;
  position.route = readWaypoints(element.child("RouteRef").only(), reading);
  if (position.route.size() < 2) element.fail("expected a route of at least two <Waypoint>");
  position.s = where.number("pathS");
  if (where.name() == "FromLaneCoordinates") {
    position.lane = where.integer("laneId");
    position.t = where.number("laneOffset", 0.0);
  } else {
    position.t = where.number("t", 0.0);
  }
  readOrientation(element, reading, position);
  return position;
}

struct PositionRow {
  const char* element;
  Position (*read)(const XoscElement&, const Reading&);  ///< nullptr: refused
};

constexpr PositionRow kPositions[] = {{"WorldPosition", readWorld},
                                      {"LanePosition", readLane},
                                      {"RoadPosition", readRoad},
                                      {"RelativeWorldPosition", readRelativeWorld},
                                      {"RelativeObjectPosition", readObject},
                                      {"RelativeLanePosition", readRelativeLane},
                                      {"RelativeRoadPosition", readRelativeRoad},
                                      {"RoutePosition", readRoutePosition},
                                      {"TrajectoryPosition", nullptr},
                                      {"GeoPosition", nullptr}};

}  // namespace

std::vector<Position> readWaypoints(const XoscElement& element, const Reading& reading) {
  const XoscElement route = reading.catalogs.resolve(element);
  if (route.flag("closed", false)) Reading::refuse(route, "a closed route");
  std::vector<Position> waypoints;
  for (const XoscElement& waypoint : route.children("Waypoint"))
    waypoints.push_back(readPosition(waypoint, reading));
  if (waypoints.empty()) route.fail("expected at least one <Waypoint>");
  return waypoints;
}

Position readOnlyPosition(const XoscElement& holder, const Reading& reading) {
  const XoscElement element = holder.only();
  const auto& row = rowOf(kPositions, element, "this kind of position");
  Position position = row.read(element, reading);
  position.source = element.source();
  return position;
}

Position readPosition(const XoscElement& parent, const Reading& reading) {
  return readOnlyPosition(parent.child("Position"), reading);
}

std::vector<ElementSupport> positionSupport() {
  std::vector<ElementSupport> rows;
  for (const PositionRow& row : kPositions)
    rows.push_back({row.element, row.read != nullptr ? Support::kSupported : Support::kRefused});
  return rows;
}

}  // namespace cdiff::storyboard
