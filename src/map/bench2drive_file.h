// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "map/route_source.h"

namespace cdiff::map {

/// A Bench2Drive route file: <routes> with <route id town>, each with the <position x y z> of its
/// <waypoints> (m, CARLA's frame: y to the south).
class Bench2DriveFile {
 public:
  /// Throws InputError for a file that cannot be read or holds no <routes>.
  explicit Bench2DriveFile(const std::string& file);

  /// Throws InputError naming the nearest ids where there is none of this one.
  pugi::xml_node route(const std::string& id) const;

  /// Ids and towns in the file's order.
  std::vector<Bench2DriveEntry> entries() const;

  /// Routes that repeat another one: by the id of each, the lowest id in the same town whose
  /// waypoints are equal, or share more than 90 % of the longer path (within 1 m and 0.5 rad). Such
  /// routes differ in their CARLA scenario, which is not run here, or by a few meters at an end:
  /// they would count one and the same place several times.
  std::map<std::string, std::string> repeatedRoutes() const;

  /// Throws InputError naming the file.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[noreturn]] void failUnknown(const std::string& id) const;

  std::string file_;
  pugi::xml_document document_;
};

}  // namespace cdiff::map
