// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

namespace pugi {
class xml_node;
}

namespace cdiff::map {

/// Reads a SUMO *.net.xml text into a RoadNetwork (map frame [m]).
class NetworkReader {
 public:
  /// `name` is used in errors.
  explicit NetworkReader(std::string name) : name_(std::move(name)) {}
  RoadNetwork read(std::string_view xml);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  double number(const pugi::xml_node& node, const char* attribute, double fallback,
                const std::string& element) const;
  std::vector<Eigen::Vector3d> points(const std::string& text, const std::string& element) const;
  LaneIndex laneOf(const pugi::xml_node& connection, const char* edge, const char* index,
                   const std::string& element) const;

  void requireExtent(const std::vector<Eigen::Vector3d>& shape, const std::string& element) const;
  void readLocation(const pugi::xml_node& net);
  void readEdge(const pugi::xml_node& edge);
  void readLane(const pugi::xml_node& node, const pugi::xml_node& edge);
  void joinNeighbors(LaneIndex first);
  void readJunction(const pugi::xml_node& node);
  void readConnection(const pugi::xml_node& node);
  void link(LaneIndex from, const LaneLink& link);
  void continueInternalLanes();
  void makeCenterlines();
  double headingAround(LaneIndex lane) const;

  std::string name_;
  RoadNetwork network_;
  std::vector<std::vector<Eigen::Vector3d>> shapes_;  ///< of each lane
  std::vector<std::pair<LaneIndex, LaneLink>>
      via_exits_;  ///< lanes that connections name as via, and their targets
};

}  // namespace cdiff::map
