// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/bench2drive_file.h"

#include <algorithm>
#include <set>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

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

/// Town and waypoints as they are written.
std::string placeOf(const pugi::xml_node& route) {
  std::string place = route.attribute("town").value();
  for (const pugi::xml_node& position : route.child("waypoints").children("position")) {
    for (const char* name : {"x", "y", "z"})
      place += std::string(" ") + position.attribute(name).value();
  }
  return place;
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
  std::map<std::string, std::vector<std::string>> ids_by_place;
  for (const pugi::xml_node& route : document_.child("routes").children("route"))
    ids_by_place[placeOf(route)].emplace_back(route.attribute("id").value());
  std::map<std::string, std::string> repeated;
  for (const auto& [place, ids] : ids_by_place) {
    const std::string& lowest = *std::min_element(ids.begin(), ids.end(), isLower);
    for (const std::string& id : ids) {
      if (id != lowest) repeated[id] = lowest;
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
