// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/bench2drive_file.h"
#include "map/route_source.h"
#include "support/error_text.h"
#include "support/network_text.h"
#include "support/real_data.h"

namespace cdiff::map {
namespace {

using Names = std::vector<std::string>;

/// Eastwards a (100 m, two lanes), junction 20 m, b (80 m, two lanes, joined lane to lane); c
/// leaves b's left lane only; a route back "r" beside a (y = 8) that starts 300 m farther on.
test::NetworkText street() {
  test::NetworkText text;
  text.edge("a", {"0,0 100,0", "0,4 100,4"})
      .edge(":j_0", {"100,0 120,0", "100,4 120,4"})
      .edge("b", {"120,0 200,0", "120,4 200,4"})
      .edge("c", {"200,4 200,104"})
      .edge("d", {"200,104 200,108 100,108 0,108 0,60 60,60"})
      .edge("lonely", {"0,-50 50,-50"})
      .connection("a_0", "b_0", ":j_0_0")
      .connection("a_1", "b_1", ":j_0_1")
      .connection("b_1", "c_0", "", 'l')
      .connection("c_0", "d_0");
  return text;
}

using test::errorOf;

#define EXPECT_ERROR(action, part)                               \
  do {                                                           \
    const std::string message = errorOf([&] { action; });        \
    EXPECT_NE(message.find(part), std::string::npos) << message; \
  } while (false)

class RouteSource : public ::testing::Test {
 protected:
  RoadNetwork network_ = street().network();
  LaneGraph graph_{network_};
};

TEST(RouteSourceInJunctions, ACircleOfLanesInAJunctionEnds) {
  test::NetworkText text;
  text.edge("a", {"0,0 100,0"}).edge(":j_0", {"100,0 120,0"}).edge("b", {"120,0 200,0"});
  text.connection("a_0", "b_0", ":j_0_0").connection(":j_0_0", ":j_0_0");
  const RoadNetwork network = text.network();
  const LaneGraph graph(network);
  EXPECT_EQ(routeAlongEdges(graph, {"a", "b"}, 5.0, 10.0).edges(), (Names{"a", "b"}));
  EXPECT_ERROR(routeAlongEdges(graph, {"b", "a"}, 5.0, 10.0), "no connection for cars");
}

TEST_F(RouteSource, FollowsEdgesWithTheFewestLaneChanges) {
  const Route route = routeAlongEdges(graph_, {"a", "b"}, 5.0, 10.0);
  EXPECT_EQ(route.edges(), (Names{"a", "b"}));
  EXPECT_NEAR(route.length(), 95.0 + 20.0 + 70.0, 1e-6);
  EXPECT_TRUE(route.laneChanges().empty());
  EXPECT_EQ(network_.lane(route.lanes().front()).id, "a_0");
  // Only the left lane leads to c: the route starts on it.
  const Route turning = routeAlongEdges(graph_, {"a", "b", "c"}, 5.0, 10.0);
  EXPECT_EQ(network_.lane(turning.lanes().front()).id, "a_1");
  EXPECT_TRUE(turning.laneChanges().empty());
  EXPECT_EQ(turning.edges(), (Names{"a", "b", "c"}));
}

TEST_F(RouteSource, NamesWrongEdges) {
  EXPECT_ERROR(routeAlongEdges(graph_, {"a", "lonley"}, 5, 5),
               "unknown edge 'lonley'; the nearest name in this network is 'lonely'");
  EXPECT_ERROR(routeAlongEdges(graph_, {"a", "c"}, 5, 5),
               "no connection for cars from edge 'a' to edge 'c'; it leads to 'b'");
  EXPECT_ERROR(routeAlongEdges(graph_, {"a"}, 60, 45),
               "edge 'a' is 100.00 m long; end_offset 45 m");
  EXPECT_ERROR(routeAlongEdges(graph_, {"a", "b"}, 100, 5), "start_offset 100 m lies beyond it");
  EXPECT_ERROR(routeAlongEdges(graph_, {}, 5, 5), "at least one edge");
}

TEST_F(RouteSource, FollowsCenterLinesThroughNoisyPoints) {
  const Route route = routeThroughPoints(
      graph_,
      {{10, 0.4, 0}, {10.05, 0.4, 0}, {40, -0.8, 0}, {39.8, -0.8, 0}, {95, 0.2, 0}, {160, 0, 0}});
  EXPECT_EQ(route.edges(), (Names{"a", "b"}));
  EXPECT_NEAR(route.length(), 150.0, 1e-6);
  for (const Eigen::Vector3d& point : route.path().points()) EXPECT_NEAR(point.y(), 0.0, 1e-9);
}

TEST_F(RouteSource, ChangesLanesBetweenTheKeyPointsThatAskForIt) {
  const Route route = routeThroughPoints(graph_, {{10, 0, 0}, {40, 0, 0}, {60, 4, 0}, {90, 4, 0}});
  ASSERT_EQ(route.laneChanges().size(), 1u);
  EXPECT_NEAR(route.laneChanges()[0], 40.0, 1.5);  // x = 50, halfway between the two points
  EXPECT_NEAR(route.path().pointAt(10.0).y(), 0.0, 1e-9);
  EXPECT_NEAR(route.path().points().back().y(), 4.0, 1e-9);
  EXPECT_NEAR(route.path().pointAt(20.0).y(), 0.0, 1e-6);  // the blend starts at 37.5 m
}

TEST_F(RouteSource, NamesWrongPoints) {
  EXPECT_ERROR(routeThroughPoints(graph_, {{10, 0, 0}, {20, 0, 0}, {30, -2.31, 0}}),
               "point 2 (30.00, -2.31) is 2.31 m off every lane");
  EXPECT_ERROR(routeThroughPoints(graph_, {{10, 0, 0}, {9000, 0, 0}}), "more than 1 km off");
  EXPECT_ERROR(routeThroughPoints(graph_, {{10, 0, 0}, {20, 0, 0}, {20, -50, 0}}),
               "no lane-connected route from point 1 (20.00, 0.00) to point 2 (20.00, -50.00)");
  // From b (x = 150) to d (0, 70): 50 m to the end of b, 100 m of c, then 4 + 100 + 100 + 38 m of d
  // = 392 m; the distance is hypot(150, 66) = 163.9 m, so 347.8 m are allowed.
  EXPECT_ERROR(
      routeThroughPoints(graph_, {{150, 4, 0}, {0, 70, 0}}),
      "route from point 0 (150.00, 4.00) to point 1 (0.00, 70.00) is 392.0 m for a distance of "
      "163.9 m (limit twice the distance + 20 m)");
  EXPECT_ERROR(routeThroughPoints(graph_, {{10, 0, 0}}), "two distinct points");
}

TEST(RouteOptions, AskForExactlyOneSource) {
  RouteOptions options;
  EXPECT_ERROR(options.validate(), "has 0 sources");
  options.edges = {"a"};
  EXPECT_NO_THROW(options.validate());
  options.points = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_ERROR(options.validate(), "has 2 sources");
  options = RouteOptions();
  options.bench2drive_file = "routes.xml";
  EXPECT_ERROR(options.validate(), "needs bench2drive_id");
  options.bench2drive_id = "7";
  EXPECT_NO_THROW(options.validate());
  options.bench2drive_file.clear();
  options.edges = {"a"};
  EXPECT_ERROR(options.validate(), "needs bench2drive_file");
}

TEST(RouteOptions, LoadsEveryKey) {
  RouteOptions options;
  core::loadOptions({"test",
                     "points: [[1, 2], [3, 4, 5]]\nstart_offset: 7\nend_offset: 8\n"
                     "start_speed: 3\nbench2drive_id: x\nbench2drive_file: f\nedges: [e]\n"},
                    options);
  ASSERT_EQ(options.points.size(), 2u);
  EXPECT_EQ(options.points[1], Eigen::Vector3d(3, 4, 5));
  EXPECT_EQ(options.start_offset, 7.0);
  EXPECT_EQ(options.end_offset, 8.0);
  EXPECT_EQ(options.start_speed, 3.0);
  EXPECT_EQ(options.bench2drive_id, "x");
  EXPECT_EQ(options.bench2drive_file, "f");
  EXPECT_EQ(options.edges, Names{"e"});
}

class RouteFile : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() /
            ("e2e_cdiff_routes_" + std::to_string(::getpid()) + ".xml");
    core::writeFileAtomically(file_, R"(<routes>
      <route id="101" town="Town01"><waypoints>
        <position x="10" y="-0" z="0"/><position x="40" y="0.5" z="0"/></waypoints></route>
      <route id="107" town="Town02"><waypoints>
        <position x="10" y="x" z="0"/></waypoints></route>
      <route id="900" town="Town01"><waypoints>
        <position x="10" y="500" z="0"/><position x="40" y="500" z="0"/></waypoints></route>
    </routes>)");
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::filesystem::path file_;
};

TEST_F(RouteFile, FlipsYAndAddsTheOffset) {
  std::string text = street().text();
  text.insert(text.find("<edge"), "<location netOffset=\"3.5,0.25\"/>");
  const RoadNetwork network = RoadNetwork::fromText(text, "street");
  const auto points = readBench2DriveRoute(file_.string(), "101", network);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1], Eigen::Vector3d(43.5, -0.25, 0.0));
  EXPECT_EQ(bench2DriveTown(file_.string(), "107"), "Town02");
  RouteOptions options;
  options.bench2drive_file = file_.string();
  options.bench2drive_id = "101";
  EXPECT_NEAR(makeRoute(LaneGraph(network), options).length(), 30.0, 1e-6);
}

TEST_F(RouteFile, NamesWhatIsWrong) {
  const RoadNetwork network = street().network();
  const std::string file = file_.string();
  EXPECT_ERROR(readBench2DriveRoute(file, "102", network),
               "no route '102'; the nearest ids are 101, 107, 900 (3 routes in 2 towns)");
  EXPECT_ERROR(readBench2DriveRoute(file, "107", network), "route '107', position 0: y=\"x\"");
  EXPECT_ERROR(readBench2DriveRoute(file + ".none", "1", network), "cannot read route file");
  RouteOptions options;
  options.bench2drive_file = file;
  options.bench2drive_id = "900";
  EXPECT_ERROR(makeRoute(LaneGraph(network), options), "is for Town01; on this network: point 0");
}

/// 103 and 99 are where 101 is: the lowest of the three ids is kept. 104 lies in another town, 105
/// has one other number.
TEST_F(RouteFile, FindsRoutesThatRepeatAnotherOne) {
  const auto route = [](const char* id, const char* town, const char* x) {
    return std::string("<route id=\"") + id + "\" town=\"" + town + "\"><waypoints><position x=\"" +
           x + "\" y=\"1\" z=\"0\"/></waypoints></route>";
  };
  core::writeFileAtomically(file_, "<routes>" + route("101", "Town01", "10") +
                                       route("103", "Town01", "10") + route("99", "Town01", "10") +
                                       route("104", "Town02", "10") +
                                       route("105", "Town01", "10.5") + "</routes>");
  const std::map<std::string, std::string> expected = {{"101", "99"}, {"103", "99"}};
  EXPECT_EQ(Bench2DriveFile(file_.string()).repeatedRoutes(), expected);
}

/// Straight on along x, with a waypoint every 10 m.
std::string straight(const std::string& id, int first_x, int last_x, double y, double z = 0.0) {
  const int step = first_x < last_x ? 10 : -10;
  std::string text = "<route id=\"" + id + "\" town=\"Town01\"><waypoints>";
  for (int x = first_x; x != last_x + step; x += step)
    text += "<position x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" z=\"" +
            std::to_string(z) + "\"/>";
  return text + "</waypoints></route>";
}

/// 6 is 100 of the 110 m of 2, beside it by 0.4 m; 3 lies in the next lane, 4 leads back, 5 is on
/// a bridge, 7 shares 80 m.
TEST_F(RouteFile, FindsRoutesWhosePathsOverlap) {
  core::writeFileAtomically(
      file_, "<routes>" + straight("6", 0, 100, 0.0) + straight("2", 0, 110, 0.4) +
                 straight("3", 0, 100, 3.5) + straight("4", 100, 0, 0.0) +
                 straight("5", 0, 100, 0.0, 6.0) + straight("7", 30, 130, 0.0) + "</routes>");
  const std::map<std::string, std::string> expected = {{"6", "2"}};
  EXPECT_EQ(Bench2DriveFile(file_.string()).repeatedRoutes(), expected);
}

TEST(Bench2Drive, NamesTheRepeatedRoutesOfTheRealFile) {
  const auto file = test::realData("bench2drive/bench2drive220.xml");
  CDIFF_SKIP_WITHOUT(file);
  const auto repeated = Bench2DriveFile(file.string()).repeatedRoutes();
  for (const char* id : {"25896", "26435", "26456"}) EXPECT_EQ(repeated.at(id), "25854");
  EXPECT_EQ(repeated.at("26406"), "24785");
  EXPECT_EQ(repeated.at("26408"), "26394");  // 2 m longer
}

TEST(Bench2Drive, CountsTheRoutesOfTheRealFile) {
  const auto file = test::realData("bench2drive/bench2drive220.xml");
  CDIFF_SKIP_WITHOUT(file);
  const RoadNetwork network = street().network();
  EXPECT_ERROR(readBench2DriveRoute(file.string(), "25382", network), "(220 routes in 12 towns)");
  EXPECT_EQ(bench2DriveTown(file.string(), "25381"), "Town05");
}

}  // namespace
}  // namespace cdiff::map
