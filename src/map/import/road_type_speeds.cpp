// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/import/road_type_speeds.h"

#include <pugixml.hpp>
#include <sstream>

#include "core/text.h"

namespace cdiff::map {
namespace {

/// A limit as OpenDRIVE writes it; an empty `max` stands for none.
struct Limit {
  std::string max;
  std::string unit = "m/s";
};

/// The limit that a road's type gives, else the usual one of a motorway or a rural road.
Limit limitOf(pugi::xml_node type) {
  const pugi::xml_node speed = type.child("speed");
  const std::string kind = type.attribute("type").value();
  if (speed) return {speed.attribute("max").value(), speed.attribute("unit").as_string("m/s")};
  if (kind == "motorway") return {"130", "km/h"};
  if (kind == "rural") return {"100", "km/h"};
  return {};
}

/// The type of a road where a section begins [m]: the last one from there or before.
pugi::xml_node typeAt(pugi::xml_node road, double begin) {
  pugi::xml_node found;
  for (const pugi::xml_node type : road.children("type")) {
    if (!found || type.attribute("s").as_double() <= begin) found = type;
  }
  return found;
}

/// Whether it is a speed: OpenDRIVE also knows the words "no limit" and "undefined".
bool isGiven(const Limit& limit) { return core::parseNumber(limit.max).value_or(0.0) > 0.0; }

/// Gives the lanes of a section a limit that have none; whether there were such lanes.
bool addLimits(pugi::xml_node section, const Limit& limit) {
  bool added = false;
  for (const char* const side : {"left", "right"}) {
    for (pugi::xml_node lane : section.child(side).children("lane")) {
      if (lane.child("speed")) continue;
      pugi::xml_node speed = lane.append_child("speed");
      speed.append_attribute("sOffset") = 0;
      speed.append_attribute("max") = limit.max.c_str();
      speed.append_attribute("unit") = limit.unit.c_str();
      added = true;
    }
  }
  return added;
}

bool addLimits(pugi::xml_node road) {
  bool added = false;
  for (const pugi::xml_node section : road.child("lanes").children("laneSection")) {
    const Limit limit = limitOf(typeAt(road, section.attribute("s").as_double()));
    if (isGiven(limit)) added = addLimits(section, limit) || added;
  }
  return added;
}

}  // namespace

std::optional<std::string> withSpeedsOfRoadTypes(const std::string& opendrive) {
  pugi::xml_document document;
  if (!document.load_buffer(opendrive.data(), opendrive.size())) return std::nullopt;
  bool added = false;
  for (const pugi::xml_node road : document.child("OpenDRIVE").children("road"))
    added = addLimits(road) || added;
  if (!added) return std::nullopt;
  std::ostringstream text;
  document.save(text, "", pugi::format_raw);
  return text.str();
}

}  // namespace cdiff::map
