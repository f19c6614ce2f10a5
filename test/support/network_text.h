// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small SUMO networks written in a test: edges, junctions and connections, given by lane center
/// lines.
#pragma once

#include <string>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/map/road_network.h"

namespace cdiff::test {

/// What most lanes of a test share.
struct LaneText {
  double width = 4.0;   ///< [m]
  double speed = 10.0;  ///< [m/s]
  std::string allow;    ///< vehicle classes; empty = all
};

class NetworkText {
 public:
  /// An edge with one lane per shape (from right to left), e.g. "0,0 100,0"; internal when the id
  /// starts with ':'.
  NetworkText& edge(const std::string& id, const std::vector<std::string>& shapes,
                    const std::string& from = "a", const std::string& to = "b",
                    const LaneText& lane = {}) {
    edges_ += "<edge id=\"" + id + "\"" +
              (id.front() == ':' ? " function=\"internal\">"
                                 : " from=\"" + from + "\" to=\"" + to + "\">");
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      edges_ += "<lane id=\"" + id + "_" + std::to_string(i) + "\" index=\"" + std::to_string(i) +
                "\" speed=\"" + core::formatNumber(lane.speed) + "\" length=\"1\" width=\"" +
                core::formatNumber(lane.width) + "\" shape=\"" + shapes[i] + "\"" +
                (lane.allow.empty() ? "" : " allow=\"" + lane.allow + "\"") + "/>";
    }
    edges_ += "</edge>\n";
    return *this;
  }

  NetworkText& junction(const std::string& id, const std::string& shape,
                        const std::string& type = "priority") {
    junctions_ += "<junction id=\"" + id + "\" type=\"" + type + "\" x=\"0\" y=\"0\" shape=\"" +
                  shape + "\"/>\n";
    return *this;
  }

  /// From lane to lane ("edge_0" style ids) through an internal lane, as SUMO writes it: two
  /// records. `attributes` of the first, e.g. `state="s"`.
  NetworkText& connection(const std::string& from, const std::string& to,
                          const std::string& via = "", char direction = 's',
                          const std::string& attributes = "") {
    connections_ += record(from, to, direction) + (via.empty() ? "" : " via=\"" + via + "\"") +
                    (attributes.empty() ? "" : " " + attributes) + "/>\n";
    if (!via.empty()) connections_ += record(via, to, direction) + "/>\n";
    return *this;
  }

  std::string text() const {
    return "<net version=\"1.9\">\n" + edges_ + junctions_ + connections_ + "</net>\n";
  }
  map::RoadNetwork network() const { return map::RoadNetwork::fromText(text(), "test network"); }

 private:
  static std::string record(const std::string& from, const std::string& to, char direction) {
    const std::size_t from_end = from.rfind('_');
    const std::size_t to_end = to.rfind('_');
    return "<connection from=\"" + from.substr(0, from_end) + "\" to=\"" + to.substr(0, to_end) +
           "\" fromLane=\"" + from.substr(from_end + 1) + "\" toLane=\"" + to.substr(to_end + 1) +
           "\" dir=\"" + direction + "\"";
  }
  std::string edges_;
  std::string junctions_;
  std::string connections_;
};

}  // namespace cdiff::test
