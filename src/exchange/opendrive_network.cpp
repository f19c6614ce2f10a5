// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/opendrive_network.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/file.h"
#include "core/scratch_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/road_network.h"

namespace cdiff::exchange {
namespace {

namespace fs = std::filesystem;

/// Cuts what lies between two marks, the second one included.
void cut(std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t first = text.find(begin);
  if (first == std::string::npos) return;
  const std::size_t last = text.find(end, first + begin.size());
  if (last != std::string::npos) text.erase(first, last + end.size() - first);
}

/// Says in the header that the coordinates are those of the map frame.
void markAsOurs(std::string& text) {
  const std::string begin = "<header ";
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return;
  text.insert(at + begin.size(), std::string("vendor=\"") + map::kOpenDriveVendor + "\" ");
}

/// Distance from a point of a lane to the nearest lane center of about the same heading [m].
std::optional<double> distanceTo(const map::RoadNetwork& network, const Eigen::Vector3d& point,
                                 double heading) {
  constexpr double kReach = 10.0;      // [m]
  constexpr double kMostTurned = 0.8;  // [rad]
  for (const map::LaneMatch& match :
       network.lanesNear(point.head<2>(), point.z(), kReach, heading)) {
    if (std::abs(match.heading_difference) < kMostTurned) return match.projection.distance;
  }
  return std::nullopt;
}

LaneAccuracy accuracyOf(std::vector<double> distances, std::size_t missing) {
  LaneAccuracy accuracy{distances.size(), missing};
  if (distances.empty()) return accuracy;
  std::sort(distances.begin(), distances.end());
  accuracy.p99 = distances[(distances.size() - 1) * 99 / 100];
  accuracy.largest = distances.back();
  return accuracy;
}

/// Compares the lanes of edges, or those inside junctions.
LaneAccuracy compare(const map::RoadNetwork& ours, const map::RoadNetwork& theirs, bool internal) {
  constexpr double kSpacing = 1.0;  // [m]
  std::vector<double> distances;
  std::size_t missing = 0;
  for (const map::Lane& lane : ours.lanes()) {
    if (lane.internal != internal || !lane.allows_cars) continue;
    const double length = lane.centerline.length();
    for (double at = 0.0; at <= length; at += kSpacing) {
      const auto distance =
          distanceTo(theirs, lane.centerline.pointAt(at), lane.centerline.headingAt(at));
      if (distance) {
        distances.push_back(*distance);
      } else {
        ++missing;
      }
    }
  }
  return accuracyOf(std::move(distances), missing);
}

std::string partText(const LaneAccuracy& accuracy, const std::string& where) {
  if (accuracy.points + accuracy.missing == 0) return "no lane " + where;
  return core::formatFixed(accuracy.largest, 2) + " m " + where + " (p99 " +
         core::formatFixed(accuracy.p99, 2) + ")" +
         (accuracy.missing > 0 ? ", " + std::to_string(accuracy.missing) + " points without lane"
                               : "");
}

}  // namespace

OpenDriveNetwork openDriveOf(const map::ImportedNetwork& network) {
  const core::ScratchFolder scratch;
  const fs::path source = scratch.path() / "network.net.xml";
  const fs::path file = scratch.path() / "network.xodr";
  const std::string subject = "network '" + network.source.string() + "'";
  core::writeFileAtomically(source, network.text);
  map::runNetconvert({"--sumo-net-file", source.string(), "--opendrive-output", file.string(),
                      "--xml-validation", "never"},
                     subject);
  OpenDriveNetwork converted;
  converted.text = core::readFile(file, "OpenDRIVE network");
  cut(converted.text, "<!-- generated on", "-->\n");
  cut(converted.text, " date=\"", "\"");
  markAsOurs(converted.text);
  core::writeFileAtomically(file, converted.text);
  const auto ours = map::RoadNetwork::fromText(network.text, network.source.string());
  const auto theirs = map::RoadNetwork::fromText(map::convertOpenDrive(file), subject);
  converted.roads = compare(ours, theirs, false);
  converted.junctions = compare(ours, theirs, true);
  return converted;
}

std::string accuracyText(const OpenDriveNetwork& network) {
  return "largest distance of lane centers " + partText(network.roads, "on roads") + ", " +
         partText(network.junctions, "in junctions");
}

}  // namespace cdiff::exchange
