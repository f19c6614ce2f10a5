// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/route.h"
#include "map/lane_graph.h"
#include "planners/course.h"
#include "support/real_data.h"

namespace cdiff::planners {
namespace {

/// Routes between lanes drawn at random (fixed seed), 150 to 500 m long.
std::vector<map::Route> randomRoutes(const map::RoadNetwork& network, std::size_t count) {
  const map::LaneGraph graph(network);
  std::vector<map::LaneIndex> candidates;
  for (std::size_t i = 0; i < network.lanes().size(); ++i) {
    const map::Lane& lane = network.lanes()[i];
    const bool usable = lane.routable && !lane.internal && lane.centerline.length() > 10.0;
    if (usable) candidates.push_back(static_cast<map::LaneIndex>(i));
  }
  const core::RandomStream random(7, "routes");
  std::vector<map::Route> routes;
  for (std::uint32_t draw = 0; routes.size() < count && draw < 1000; ++draw) {
    const map::LanePosition start{candidates[random.index({}, 2 * draw, candidates.size())], 5.0};
    const map::LanePosition goal{candidates[random.index({}, 2 * draw + 1, candidates.size())],
                                 5.0};
    const auto way = graph.shortestPath(start, goal, 500.0);
    if (!way || way->length < 150.0) continue;
    routes.push_back(graph.toRoute(*way, start.arc_length, goal.arc_length));
  }
  return routes;
}

TEST(PdmLiteTown, CompletesRoutesOfATownWithinItsLanes) {
  const std::filesystem::path file = test::realData("carla_towns/Town05.net.xml");
  CDIFF_SKIP_WITHOUT(file);
  const auto network = map::RoadNetwork::fromText(core::readFile(file, "network"), "Town05");
  const std::vector<map::Route> routes = randomRoutes(network, 10);
  ASSERT_EQ(routes.size(), 10u);
  double worst = 0.0;
  for (const map::Route& route : routes) {
    testing::ClosedLoop loop(network);
    const Eigen::Vector2d start = route.path().positionAt(0.5);
    loop.drive(testing::vehicleAt("ego", start.x(), start.y(), route.path().headingAt(0.5), 0.0),
               route);
    map::RouteProgress progress(route);
    const double time_limit = 10.0 + route.length() / 6.0;
    loop.run(time_limit, [&] {
      if (progress.percent() >= 100.0) return;
      progress.update(loop.vehicle(0).state.position);
      worst = std::max(worst, progress.deviation());
    });
    EXPECT_EQ(progress.percent(), 100.0) << route.length() << " m";
  }
  // Half a lane of 3.5 m less half a car of 1.8 m: 0.85 m.
  EXPECT_LT(worst, 0.85);
  RecordProperty("worst_offset_m", std::to_string(worst));
}

}  // namespace
}  // namespace cdiff::planners
