// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/perception.h"

#include <algorithm>

#include "core/text.h"
#include "e2e_cdiff/planning/perception.h"
#include "page/pictures/map_canvas.h"

namespace cdiff::page {
namespace {

constexpr double kWayOpacity = 0.8;

/// Corners of a rectangle around a pose, x from `back` to `front`, y from `right` to `left` [m].
Points rectangle(const geometry::Pose2d& pose, double back, double front, double right,
                 double left) {
  return {pose.toMap({back, right}), pose.toMap({front, right}), pose.toMap({front, left}),
          pose.toMap({back, left})};
}

PerceivedPath vehiclePath(const planning::PerceivedVehicle& vehicle, const MapCanvas& canvas) {
  const double x = 0.5 * vehicle.dimensions.length, y = 0.5 * vehicle.dimensions.width;
  return {"vehicle-seen", vehicle.score,
          canvas.ring(rectangle(vehicle.state.pose(), -x, x, -y, y))};
}

PerceivedPath wayPath(const planning::PerceivedVehicle& vehicle, const MapCanvas& canvas) {
  Points way = {vehicle.state.position};
  const Points& places = planning::likeliest(vehicle.forecasts).places;
  way.insert(way.end(), places.begin(), places.end());
  return {"forecast", kWayOpacity * vehicle.score, canvas.line(way)};
}

/// All occupied cells of one time.
PerceivedPath occupancyPath(const planning::PerceivedOccupancy& occupancy,
                            const MapCanvas& canvas) {
  const double half = 0.5 * occupancy.cell;
  std::string data;
  for (const Eigen::Vector2d& center : planning::occupiedCells(occupancy))
    data += canvas.ring(rectangle(occupancy.frame, center.x() - half, center.x() + half,
                                  center.y() - half, center.y() + half));
  return {"occupied", 0.5 / (1.0 + occupancy.time), data};
}

}  // namespace

std::vector<PerceivedPath> perceivedPaths(const planning::Perception& perception,
                                          const MapCanvas& canvas) {
  std::vector<PerceivedPath> paths;
  for (const planning::PerceivedOccupancy& occupancy : perception.occupancy)
    paths.push_back(occupancyPath(occupancy, canvas));
  for (const planning::PerceivedLine& line : perception.lines)
    paths.push_back({line.kind + "-seen", line.score, canvas.line(line.points)});
  for (const planning::PerceivedVehicle& vehicle : perception.vehicles) {
    if (!vehicle.forecasts.empty()) paths.push_back(wayPath(vehicle, canvas));
    paths.push_back(vehiclePath(vehicle, canvas));
  }
  paths.erase(std::remove_if(paths.begin(), paths.end(),
                             [](const PerceivedPath& path) { return path.data.empty(); }),
              paths.end());
  return paths;
}

bool showsPerception(const record::Timeline& timeline) {
  const auto& frames = timeline.frames();
  return std::any_of(frames.begin(), frames.end(),
                     [](const record::TimelineFrame& frame) { return !frame.perception.empty(); });
}

core::Markup perceivedSvg(const record::Timeline& timeline, const MapCanvas& canvas) {
  if (!showsPerception(timeline)) return {};
  const auto& frames = timeline.frames();
  const auto last =
      std::find_if(frames.rbegin(), frames.rend(),
                   [](const record::TimelineFrame& frame) { return !frame.perception.empty(); });
  core::Markup paths;
  for (const PerceivedPath& path : perceivedPaths(last->perception, canvas))
    paths += core::element("path", {{"class", "perceived " + path.style},
                                    {"d", path.data},
                                    {"style", "--opacity:" + core::formatFixed(path.opacity, 2)}});
  return core::element("g", {{"id", "perceived"}}, paths) + "\n";
}

}  // namespace cdiff::page
