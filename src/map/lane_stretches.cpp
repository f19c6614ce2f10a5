// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "map/lane_search.h"
#include "map/route_builder.h"

namespace cdiff::map {
namespace {

constexpr double kChangeStretch = 60.0;  // [m] a change happens within so much of its lane

double lengthOf(const RoadNetwork& network, LaneIndex lane) {
  return network.lane(lane).centerline.length();
}

/// Lanes lanes[first..last] of a path that lie side by side.
struct SideBySide {
  std::size_t first = 0;
  std::size_t last = 0;
  double begin = 0.0;  ///< arc length on the first where the way enters [m]
  double end = 0.0;    ///< arc length on the last where the way leaves [m]
};

/// An arc length on the lane at place `from` of a path, carried over to the lane at place `to`
/// beside it.
double carriedOver(const RoadNetwork& network, const LanePath& path, std::size_t from,
                   std::size_t to, double arc_length) {
  while (from != to) {
    const std::size_t next = from < to ? from + 1 : from - 1;
    arc_length = arcLengthAbreast(network, path.lanes[from], arc_length, path.lanes[next]);
    from = next;
  }
  return arc_length;
}

void appendGroup(const RoadNetwork& network, const LanePath& path, const SideBySide& group,
                 std::vector<LaneStretch>& drive) {
  const double changes = static_cast<double>(group.last - group.first);
  const double leave = carriedOver(network, path, group.last, group.first, group.end);
  const double zone = std::clamp(leave - group.begin, 0.0, kChangeStretch * changes);
  double begin = group.begin;
  for (std::size_t i = group.first; i <= group.last; ++i) {
    const bool last = i == group.last;
    const double done = static_cast<double>(i - group.first) + 0.5;
    const double change = last ? 0.0 : group.begin + zone * done / changes;
    double end = last ? group.end : carriedOver(network, path, group.first, i, change);
    end = std::max(begin, end);
    if (i == 0 && !drive.empty() && drive.back().lane == path.lanes[i]) {
      drive.back().end = std::max(drive.back().end, end);
    } else {
      drive.push_back({path.lanes[i], begin, end});
    }
    if (!last) begin = arcLengthAbreast(network, path.lanes[i], end, path.lanes[i + 1]);
  }
}

}  // namespace

bool follows(const RoadNetwork& network, LaneIndex from, LaneIndex to) {
  const std::vector<LaneLink>& next = network.lane(from).next;
  return std::any_of(next.begin(), next.end(), [&](const LaneLink& link) { return link.to == to; });
}

void appendPath(const RoadNetwork& network, const LanePath& path, double start, double goal,
                std::vector<LaneStretch>& drive) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= path.lanes.size(); ++i) {
    const bool last = i == path.lanes.size();
    if (!last && !follows(network, path.lanes[i - 1], path.lanes[i])) continue;
    SideBySide group;
    group.first = first;
    group.last = i - 1;
    if (first == 0) group.begin = start;
    group.end = last ? goal : lengthOf(network, path.lanes[i - 1]);
    appendGroup(network, path, group, drive);
    first = i;
  }
}

}  // namespace cdiff::map
