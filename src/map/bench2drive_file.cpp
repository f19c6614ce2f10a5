// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/bench2drive_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::map {
namespace {

std::string nearestIds(const std::string& id, std::vector<std::string> ids) {
  std::vector<std::string> nearest;
  while (nearest.size() < 3 && !ids.empty()) {
    nearest.push_back(core::nearestName(id, ids));
    ids.erase(std::find(ids.begin(), ids.end(), nearest.back()));
  }
  return core::joinText(nearest, ", ");
}

constexpr double kSameLine = 1.0;       ///< two lines nearer than this are one [m]
constexpr double kSameHeading = 0.5;    ///< where their headings differ by less [rad]
constexpr double kSameShare = 0.9;      ///< on more than this share of the longer one
constexpr double kSampleSpacing = 1.0;  ///< between points that are compared [m]

/// Town and waypoints as they are written.
std::string placeOf(const pugi::xml_node& route) {
  std::string place = route.attribute("town").value();
  for (const pugi::xml_node& position : route.child("waypoints").children("position")) {
    for (const char* name : {"x", "y", "z"})
      place += std::string(" ") + position.attribute(name).value();
  }
  return place;
}

/// A route, and the line through its waypoints in CARLA's frame; empty without two points.
struct RouteLine {
  std::string id;
  std::string town;
  std::string place;
  geometry::Polyline line;
};

RouteLine lineOf(const pugi::xml_node& route) {
  RouteLine line{
      route.attribute("id").value(), route.attribute("town").value(), placeOf(route), {}};
  std::vector<Eigen::Vector3d> points;
  for (const pugi::xml_node& position : route.child("waypoints").children("position")) {
    const Eigen::Vector3d point(position.attribute("x").as_double(),
                                position.attribute("y").as_double(),
                                position.attribute("z").as_double());
    if (!point.allFinite()) return line;  // whoever drives it says what is wrong
    if (points.empty() || (point - points.back()).head<2>().norm() > 0.001) points.push_back(point);
  }
  if (points.size() > 1) line.line = geometry::Polyline(points);
  return line;
}

/// Share of the longer line that the other one follows: near it, at its level, in its direction.
double sharedPart(const geometry::Polyline& first, const geometry::Polyline& second) {
  const bool swap = first.length() < second.length();
  const geometry::Polyline& longer = swap ? second : first;
  const geometry::Polyline& shorter = swap ? first : second;
  int shared = 0;
  const int samples = static_cast<int>(longer.length() / kSampleSpacing) + 1;
  for (int i = 0; i < samples; ++i) {
    const double at = i * kSampleSpacing;
    const Eigen::Vector3d point = longer.pointAt(at);
    const geometry::Projection near = shorter.project(point.head<2>());
    const double turn = core::angleDifference(near.heading, longer.headingAt(at));
    if (near.distance < kSameLine && std::abs(near.elevation - point.z()) < kSameLine &&
        std::abs(turn) < kSameHeading)
      ++shared;
  }
  return static_cast<double>(shared) / samples;
}

bool repeats(const RouteLine& route, const RouteLine& other) {
  if (route.place == other.place) return true;
  if (route.town != other.town || route.line.empty() || other.line.empty()) return false;
  return sharedPart(route.line, other.line) > kSameShare;
}

/// Of whole numbers without leading zeros: the shorter one is lower.
bool isLower(const std::string& left, const std::string& right) {
  return left.size() != right.size() ? left.size() < right.size() : left < right;
}

}  // namespace

Bench2DriveFile::Bench2DriveFile(const std::string& file) : file_(file) {
  const std::string text = core::readFile(file, "route file");
  const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
  if (!result) {
    fail(std::string("not XML: ") + result.description() + " at offset " +
         std::to_string(result.offset));
  }
  if (!document_.child("routes"))
    fail("no <routes> element; a Bench2Drive route file was expected");
}

pugi::xml_node Bench2DriveFile::route(const std::string& id) const {
  for (const pugi::xml_node& route : document_.child("routes").children("route")) {
    if (id == route.attribute("id").value()) return route;
  }
  failUnknown(id);
}

std::vector<Bench2DriveEntry> Bench2DriveFile::entries() const {
  std::vector<Bench2DriveEntry> entries;
  for (const pugi::xml_node& route : document_.child("routes").children("route"))
    entries.push_back({route.attribute("id").value(), route.attribute("town").value()});
  return entries;
}

std::map<std::string, std::string> Bench2DriveFile::repeatedRoutes() const {
  std::vector<RouteLine> routes;
  for (const pugi::xml_node& route : document_.child("routes").children("route"))
    routes.push_back(lineOf(route));
  std::sort(routes.begin(), routes.end(), [](const RouteLine& left, const RouteLine& right) {
    return isLower(left.id, right.id);
  });
  std::vector<const RouteLine*> kept;
  std::map<std::string, std::string> repeated;
  for (const RouteLine& route : routes) {
    const auto same = std::find_if(kept.begin(), kept.end(),
                                   [&](const RouteLine* other) { return repeats(route, *other); });
    if (same == kept.end()) {
      kept.push_back(&route);
    } else if (route.id != (*same)->id) {
      repeated[route.id] = (*same)->id;
    }
  }
  return repeated;
}

void Bench2DriveFile::fail(const std::string& what) const {
  throw core::InputError("route file '" + file_ + "': " + what);
}

void Bench2DriveFile::failUnknown(const std::string& id) const {
  std::vector<std::string> ids;
  std::set<std::string> towns;
  for (const pugi::xml_node& route : document_.child("routes").children("route")) {
    ids.emplace_back(route.attribute("id").value());
    towns.insert(route.attribute("town").value());
  }
  if (ids.empty()) fail("it holds no <route>");
  fail("no route '" + id + "'; the nearest ids are " + nearestIds(id, ids) + " (" +
       std::to_string(ids.size()) + " routes in " + std::to_string(towns.size()) + " towns)");
}

}  // namespace cdiff::map
