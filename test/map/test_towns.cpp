// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Every Bench2Drive route on the four towns that we have: built, near its waypoints, smooth, and
/// matched again.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <pugixml.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "map/import/network_import.h"
#include "map/route_source.h"
#include "support/real_data.h"

namespace cdiff::map {
namespace {

namespace fs = std::filesystem;

double millisecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

std::vector<std::string> routeIds(const std::string& file, const std::string& town) {
  pugi::xml_document document;
  document.load_file(file.c_str());
  std::vector<std::string> ids;
  for (const pugi::xml_node& route : document.child("routes").children("route")) {
    if (town == route.attribute("town").value()) ids.emplace_back(route.attribute("id").value());
  }
  return ids;
}

double straightSum(const std::vector<Eigen::Vector3d>& points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    sum += (points[i] - points[i - 1]).head<2>().norm();
  }
  return sum;
}

bool nearLaneChange(const Route& route, double arc_length) {
  return std::any_of(route.laneChanges().begin(), route.laneChanges().end(),
                     [&](double change) { return std::abs(change - arc_length) < 15.0; });
}

void expectNearWaypoints(const Route& route, const std::vector<Eigen::Vector3d>& points) {
  for (const Eigen::Vector3d& point : points) {
    const geometry::Projection at = route.path().project(point.head<2>());
    EXPECT_LT(at.distance, nearLaneChange(route, at.arc_length) ? 2.0 : 0.5)
        << "waypoint " << point.transpose() << " at " << at.arc_length;
    // netconvert keeps few elevations: Town05's ramps lie up to 3.1 m off the waypoints. Levels are
    // 5 m and more apart.
    EXPECT_LT(std::abs(at.elevation - point.z()), 4.0) << "waypoint " << point.transpose();
  }
}

/// Largest change of heading between neighboring segments, per meter [rad/m].
double largestBend(const Route& route) {
  double largest = 0.0;
  const std::vector<double>& arcs = route.path().arcLengths();
  for (std::size_t i = 1; i + 1 < arcs.size(); ++i) {
    const double before = route.path().headingAt((arcs[i - 1] + arcs[i]) / 2.0);
    const double after = route.path().headingAt((arcs[i] + arcs[i + 1]) / 2.0);
    const double bend = std::abs(core::angleDifference(after, before)) / (arcs[i + 1] - arcs[i]);
    if (bend > largest) largest = bend;
  }
  return largest;
}

double shareOfEqualLanes(const Route& first, const Route& second) {
  std::size_t equal = 0;
  for (std::size_t i = 0; i < first.lanes().size(); ++i) {
    equal += first.lanes()[i] == second.lanes()[i] ? 1 : 0;
  }
  return static_cast<double>(equal) / static_cast<double>(first.lanes().size());
}

/// Where a test route starts or ends: long enough to be told from the points alone.
bool usableEnd(const Lane& lane) {
  return lane.routable && !lane.internal && lane.centerline.length() > 5.0;
}

/// Keeps the cache of imported networks out of the user's own.
class Towns : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("e2e_cdiff_towns_" + std::to_string(::getpid()));
    ::setenv("E2E_CDIFF_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_P(Towns, BuildsEveryBench2DriveRoute) {
  const std::string town = GetParam();
  const fs::path source = test::realData("carla_towns/" + town + ".net.xml");
  CDIFF_SKIP_WITHOUT(source);
  auto begin = std::chrono::steady_clock::now();
  const ImportedNetwork imported = importNetwork(source.string());
  const double import_ms = millisecondsSince(begin);
  begin = std::chrono::steady_clock::now();
  const RoadNetwork network = RoadNetwork::fromText(imported.text, town);
  const double parse_ms = millisecondsSince(begin);
  const LaneGraph graph(network);
  const std::string file = test::realData("bench2drive/bench2drive220.xml").string();
  const std::vector<std::string> ids = routeIds(file, town);
  ASSERT_FALSE(ids.empty());
  double build_ms = 0.0;
  double match_ms = 0.0;
  for (const std::string& id : ids) {
    SCOPED_TRACE("route " + id);
    const auto points = readBench2DriveRoute(file, id, network);
    begin = std::chrono::steady_clock::now();
    const Route route = routeThroughPoints(graph, points);
    build_ms += millisecondsSince(begin);
    expectNearWaypoints(route, points);
    EXPECT_GT(route.length(), 0.95 * straightSum(points));
    EXPECT_LT(route.length(), 1.2 * straightSum(points));
    begin = std::chrono::steady_clock::now();
    const Route matched = matchRoute(network, route.path().points());
    match_ms += millisecondsSince(begin);
    EXPECT_EQ(matched.edges(), route.edges());
    EXPECT_GT(shareOfEqualLanes(route, matched), 0.98);
    EXPECT_LT(core::radiansToDegrees(largestBend(route)), 12.0);  // the lanes themselves: up to 28
  }
  std::printf("%s: import %.1f ms, parse %.1f ms, %zu routes, build %.1f ms, match %.1f ms each\n",
              town.c_str(), import_ms, parse_ms, ids.size(),
              build_ms / static_cast<double>(ids.size()),
              match_ms / static_cast<double>(ids.size()));
}

TEST_P(Towns, MatchesRoutesWithLaneChangesAgain) {
  const std::string town = GetParam();
  const fs::path source = test::realData("carla_towns/" + town + ".net.xml");
  CDIFF_SKIP_WITHOUT(source);
  const RoadNetwork network = RoadNetwork::fromText(importNetwork(source.string()).text, town);
  const LaneGraph graph(network);
  const auto count = static_cast<LaneIndex>(network.lanes().size());
  std::size_t ways = 0;
  std::size_t changes = 0;
  for (LaneIndex i = 0; i < count; ++i) {
    const LaneIndex start = (i * 7) % count;
    const LaneIndex goal = (i * 31 + 17) % count;
    if (!usableEnd(network.lane(start)) || !usableEnd(network.lane(goal))) continue;
    const double begin = network.lane(start).centerline.length() * 0.3;
    const double end = network.lane(goal).centerline.length() * 0.7;
    const auto path = graph.shortestPath({start, begin}, {goal, end}, 2000.0);
    if (!path || path->length < 5.0) continue;
    SCOPED_TRACE(network.lane(start).id + " to " + network.lane(goal).id);
    const Route route = graph.toRoute(*path, begin, end);
    EXPECT_LT(route.length(), 1.03 * path->length + 2.0);
    // Internal lanes that lead backwards (7.6 m in Town03, there and back) count in the way and not
    // in the route.
    EXPECT_GT(route.length(), 0.97 * path->length - 18.0);
    const Route matched = matchRoute(network, route.path().points());
    EXPECT_EQ(matched.edges(), route.edges());
    EXPECT_EQ(matched.signals().size(), route.signals().size());
    EXPECT_GT(shareOfEqualLanes(route, matched), 0.95);
    EXPECT_LT(core::radiansToDegrees(largestBend(route)), 20.0);
    ++ways;
    changes += route.laneChanges().size();
  }
  EXPECT_GT(ways, 10u);
  std::printf("%s: %zu ways with %zu lane changes\n", town.c_str(), ways, changes);
}

INSTANTIATE_TEST_SUITE_P(Carla, Towns, ::testing::Values("Town01", "Town03", "Town04", "Town05"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace cdiff::map
