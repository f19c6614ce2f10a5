// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <set>

#include "map/route_source.h"
#include "suite/new_scenario.h"
#include "suite/route_suggester.h"
#include "support/error_text.h"
#include "support/network_text.h"

namespace cdiff::suite {
namespace {

/// Four by four crossings, 120 m apart: streets along x (A0B0 ...) have priority.
class GridRoutes : public testing::Test {
 protected:
  std::vector<SuggestedRoute> suggest(const RouteEnds& ends = {}) const {
    return suggestRoutes(graph_, ends, 8);
  }
  map::RoadNetwork network_ = map::RoadNetwork::fromText(generatedNetwork("grid", 1), "grid");
  map::LaneGraph graph_{network_};
};

TEST_F(GridRoutes, CanBeDrivenAndMeetOtherStreams) {
  const std::vector<SuggestedRoute> routes = suggest();
  ASSERT_EQ(routes.size(), 8U);
  std::set<std::vector<std::string>> seen;
  for (const SuggestedRoute& route : routes) {
    EXPECT_TRUE(seen.insert(route.edges).second) << routeText(route);
    const map::Route driven =
        map::routeAlongEdges(graph_, route.edges, route.start_offset, route.end_offset);
    EXPECT_NEAR(driven.length(), route.length, 0.06);
    EXPECT_GE(route.length, 150.0) << "80 m before the junction, 80 m after it";
    EXPECT_LE(route.length, 250.0);
    EXPECT_GE(route.conflicts, 2) << "other arms of a crossing: three, two for a right turn";
  }
  EXPECT_EQ(routes.front().manoeuvre, "left") << "of equals, the one across the oncoming stream";
}

TEST_F(GridRoutes, AreTheSameEachTime) {
  const std::vector<SuggestedRoute> first = suggest();
  const std::vector<SuggestedRoute> again = suggest();
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].edges, again[i].edges);
}

TEST_F(GridRoutes, LeadFromEdgeToEdge) {
  const std::vector<SuggestedRoute> routes = suggest({"A0B0", "C1D1"});
  ASSERT_EQ(routes.size(), 1U);
  EXPECT_EQ(routes[0].edges.front(), "A0B0");
  EXPECT_EQ(routes[0].edges.back(), "C1D1");
  EXPECT_EQ(routes[0].edges.size(), 4U) << "three blocks east and one north";
  for (const SuggestedRoute& route : suggest({"A1B1", ""})) EXPECT_EQ(route.edges[0], "A1B1");
  for (const SuggestedRoute& route : suggest({"", "B1B2"})) EXPECT_EQ(route.edges.back(), "B1B2");
}

TEST_F(GridRoutes, OfUnknownEdgesNameTheNearest) {
  const std::string error = test::errorOf([&] { suggest({"A0B9", ""}); });
  EXPECT_NE(error.find("--from 'A0B9' is no edge of the network; the nearest name is 'A0B"),
            std::string::npos)
      << error;
}

TEST(SuggestedRoutes, NeedAWayForCars) {
  // Two roads that do not meet.
  const map::RoadNetwork apart = test::NetworkText()
                                     .edge("one", {"0,0 100,0"}, "a", "b")
                                     .edge("two", {"0,50 300,50"}, "c", "d")
                                     .network();
  const map::LaneGraph graph(apart);
  const std::string error = test::errorOf([&] { suggestRoutes(graph, {"one", "two"}, 3); });
  EXPECT_NE(error.find("no way for cars from 'one' to 'two'"), std::string::npos) << error;
  // Without junctions the longest road is offered, though nothing meets it there.
  const std::vector<SuggestedRoute> routes = suggestRoutes(graph, {}, 3);
  ASSERT_EQ(routes.size(), 2U);
  EXPECT_EQ(routes[0].edges, std::vector<std::string>{"two"});
  EXPECT_EQ(routes[0].conflicts, 0);
}

TEST(SuggestedRoutes, AreNoneOnFootpaths) {
  const map::RoadNetwork paths =
      test::NetworkText().edge("path", {"0,0 100,0"}, "a", "b", {2.0, 3.0, "pedestrian"}).network();
  const std::string error = test::errorOf([&] { suggestRoutes(map::LaneGraph(paths), {}, 3); });
  EXPECT_NE(error.find("no road for cars: none of its 1 edges"), std::string::npos) << error;
  const std::string edge = test::errorOf([&] {
    suggestRoutes(map::LaneGraph(paths), {"path", ""}, 3);
  });
  EXPECT_NE(edge.find("no lane of this edge is for cars"), std::string::npos) << edge;
}

TEST(GeneratedNetworks, AreTheSameForTheSameSeedAndHaveRoutes) {
  for (const char* kind : {"grid", "crossing", "roundabout"}) {
    const std::string text = generatedNetwork(kind, 2);
    EXPECT_EQ(text, generatedNetwork(kind, 2)) << kind;
    const map::RoadNetwork network = map::RoadNetwork::fromText(text, kind);
    EXPECT_GE(suggestRoutes(map::LaneGraph(network), {}, 8).front().conflicts, 1) << kind;
  }
  EXPECT_NE(generatedNetwork("crossing", 2), generatedNetwork("crossing", 3));
}

}  // namespace
}  // namespace cdiff::suite
