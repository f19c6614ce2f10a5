// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/road_network.h"
#include "support/network_text.h"
#include "support/real_data.h"

namespace cdiff::map {
namespace {

/// Two lanes eastwards (y = 0 and 4), a signaled junction with an internal junction on the left
/// turn, a route north, and a bridge from south to north at x = 50, 8 m above.
constexpr const char* kCrossing = R"(<?xml version="1.0"?>
<net version="1.9">
  <location netOffset="12.50,-3.00"/>
  <edge id=":j_0" function="internal">
    <lane id=":j_0_0" index="0" speed="8" shape="100,0 120,0"/>
  </edge>
  <edge id=":j_1" function="internal">
    <lane id=":j_1_0" index="0" speed="6" shape="100,4 108,6"/>
  </edge>
  <edge id=":j_2" function="internal">
    <lane id=":j_2_0" index="0" speed="6" shape="108,6 112,20"/>
  </edge>
  <edge id=":j_c0" function="crossing">
    <lane id=":j_c0_0" index="0" allow="pedestrian" speed="1" shape="98,-5 98,9"/>
  </edge>
  <edge id="in" from="a" to="j">
    <lane id="in_0" index="0" speed="13.89" width="3.5" disallow="pedestrian tram" shape="0,0 100,0"/>
    <lane id="in_1" index="1" speed="13.89" shape="0,4 100,4"/>
    <lane id="in_2" index="2" speed="1.39" shape="0,8 100,8"/>
    <lane id="in_3" index="3" speed="13.89" allow="bus bicycle" shape="0,12 100,12"/>
  </edge>
  <edge id="out" from="j" to="b">
    <lane id="out_0" index="0" speed="13.89" shape="120,0 200,0"/>
  </edge>
  <edge id="north" from="j" to="c">
    <lane id="north_0" index="0" speed="13.89" disallow="all" shape="112,20 112,90"/>
  </edge>
  <edge id="bridge" from="d" to="e">
    <lane id="bridge_0" index="0" speed="13.89" allow="passenger" shape="50,-60,8 50,60,8"/>
  </edge>
  <junction id="j" type="traffic_light" x="110" y="5" shape="100,-2 100,6 120,6 120,-2"/>
  <junction id=":j_2_0" type="internal" x="108" y="6"/>
  <connection from="in" to="out" fromLane="0" toLane="0" via=":j_0_0" tl="light" linkIndex="0" dir="s"/>
  <connection from="in" to="out" fromLane="0" toLane="0" via=":j_0_0" tl="light" linkIndex="0" dir="s"/>
  <connection from="in" to="north" fromLane="1" toLane="0" via=":j_1_0" tl="light" linkIndex="1" dir="l"/>
  <connection from=":j_0" to="out" fromLane="0" toLane="0" dir="s"/>
  <connection from=":j_1" to="north" fromLane="0" toLane="0" via=":j_2_0" dir="l"/>
  <connection from=":j_2" to="north" fromLane="0" toLane="0" dir="l"/>
</net>)";

RoadNetwork crossing() { return RoadNetwork::fromText(kCrossing, "crossing"); }

const Lane& laneNamed(const RoadNetwork& network, const std::string& id) {
  const LaneIndex index = network.findLane(id);
  EXPECT_NE(index, kNoLane) << id;
  return network.lane(index);
}

std::string errorOf(const std::string& text) {
  try {
    RoadNetwork::fromText(text, "given.net.xml");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The crossing with one piece of text replaced.
std::string crossingWith(const std::string& old_text, const std::string& new_text) {
  std::string text = kCrossing;
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

TEST(RoadNetwork, ReadsLanesAndPermissions) {
  const RoadNetwork network = crossing();
  EXPECT_EQ(network.netOffset(), Eigen::Vector2d(12.5, -3.0));
  EXPECT_EQ(network.edgeIds(), (std::vector<std::string>{"in", "out", "north", "bridge"}));
  const Lane& first = laneNamed(network, "in_0");
  EXPECT_EQ(first.width, 3.5);
  EXPECT_EQ(first.speed_limit, 13.89);
  EXPECT_EQ(first.edge_id, "in");
  EXPECT_EQ(first.junction_id, "j");
  EXPECT_EQ(first.centerline.length(), 100.0);
  EXPECT_TRUE(first.routable);
  EXPECT_FALSE(first.internal);
  EXPECT_EQ(laneNamed(network, "in_1").width, 3.2);  // SUMO's default
  EXPECT_TRUE(laneNamed(network, "in_2").allows_cars);
  EXPECT_FALSE(laneNamed(network, "in_2").routable);  // 1.39 m/s
  EXPECT_FALSE(laneNamed(network, "in_3").allows_cars);
  EXPECT_FALSE(laneNamed(network, "north_0").allows_cars);
  EXPECT_TRUE(laneNamed(network, "bridge_0").allows_cars);
  EXPECT_FALSE(laneNamed(network, ":j_c0_0").allows_cars);
  EXPECT_TRUE(laneNamed(network, ":j_2_0").internal);
  EXPECT_EQ(laneNamed(network, ":j_2_0").junction_id, "j");
  EXPECT_EQ(laneNamed(network, "bridge_0").centerline.pointAt(60.0), Eigen::Vector3d(50, 0, 8));
}

TEST(RoadNetwork, ReadsNeighborsThatAdmitCars) {
  const RoadNetwork network = crossing();
  const std::vector<LaneIndex> lanes = network.lanesOfEdge("in");
  ASSERT_EQ(lanes.size(), 4u);
  EXPECT_EQ(network.lane(lanes[0]).right, kNoLane);
  EXPECT_EQ(network.lane(lanes[0]).left, lanes[1]);
  EXPECT_EQ(network.lane(lanes[1]).right, lanes[0]);
  EXPECT_EQ(network.lane(lanes[2]).left, kNoLane);  // the fourth is for buses
  EXPECT_TRUE(network.lanesOfEdge("missing").empty());
}

TEST(RoadNetwork, LinksThroughInternalLanesOnce) {
  const RoadNetwork network = crossing();
  const Lane& straight = laneNamed(network, "in_0");
  ASSERT_EQ(straight.next.size(), 1u);  // the file names the connection twice
  EXPECT_EQ(network.lane(straight.next[0].to).id, ":j_0_0");
  EXPECT_EQ(straight.next[0].signal_id, "light");
  EXPECT_EQ(straight.next[0].signal_link, 0);
  EXPECT_EQ(straight.next[0].direction, 's');
  const Lane& left = laneNamed(network, "in_1");
  ASSERT_EQ(left.next.size(), 1u);
  EXPECT_EQ(left.next[0].direction, 'l');
  EXPECT_EQ(left.next[0].signal_link, 1);
  const Lane& waiting = network.lane(left.next[0].to);
  ASSERT_EQ(waiting.next.size(), 1u);  // in -> :j_1 -> :j_2 -> north
  EXPECT_EQ(network.lane(waiting.next[0].to).id, ":j_2_0");
  EXPECT_TRUE(waiting.next[0].signal_id.empty());
  EXPECT_EQ(laneNamed(network, "out_0").previous,
            std::vector<LaneIndex>{network.findLane(":j_0_0")});
}

TEST(RoadNetwork, ContinuesInternalLanesThatTheFileLeavesOpen) {
  const std::string text =
      crossingWith(R"(<connection from=":j_0" to="out" fromLane="0" toLane="0" dir="s"/>)", "");
  const RoadNetwork network = RoadNetwork::fromText(text, "crossing");
  const Lane& via = laneNamed(network, ":j_0_0");
  ASSERT_EQ(via.next.size(), 1u);
  EXPECT_EQ(network.lane(via.next[0].to).id, "out_0");
}

TEST(RoadNetwork, ReadsJunctionsWithoutInternalOnes) {
  const RoadNetwork network = crossing();
  ASSERT_EQ(network.junctions().size(), 1u);
  EXPECT_EQ(network.junctions()[0].type, "traffic_light");
  EXPECT_EQ(network.junctions()[0].shape.size(), 4u);
  EXPECT_EQ(network.junctions()[0].position, Eigen::Vector3d(110, 5, 0));
}

TEST(RoadNetwork, DrawsLanesOfNoLengthAlongTheirNeighbors) {
  const RoadNetwork network = RoadNetwork::fromText(
      crossingWith("shape=\"100,0 120,0\"", "shape=\"100,0 100,0\""), "crossing");
  const Lane& stub = laneNamed(network, ":j_0_0");
  EXPECT_NEAR(stub.centerline.length(), 0.01, 1e-12);
  EXPECT_NEAR(stub.centerline.headingAt(0.0), 0.0, 1e-12);  // as in_0 ends
}

TEST(RoadNetwork, FindsLanesNearAPointOnItsLevel) {
  const RoadNetwork network = crossing();
  // (50, 1): in_0 at 1 m, in_1 at 3 m, in_2 at 7 m; the bridge at 0 m but 8 m higher; in_3 is for
  // buses.
  const auto ground = network.lanesNear({50.0, 1.0}, 0.0, 8.0, core::kPi / 2.0);
  ASSERT_EQ(ground.size(), 3u);
  EXPECT_EQ(network.lane(ground[0].lane).id, "in_0");
  EXPECT_DOUBLE_EQ(ground[0].projection.distance, 1.0);
  EXPECT_DOUBLE_EQ(ground[0].projection.lateral_offset, 1.0);
  EXPECT_DOUBLE_EQ(ground[0].projection.arc_length, 50.0);
  EXPECT_DOUBLE_EQ(ground[0].heading_difference, -core::kPi / 2.0);
  EXPECT_EQ(network.lane(ground[1].lane).id, "in_1");
  EXPECT_DOUBLE_EQ(ground[1].projection.lateral_offset, -3.0);
  EXPECT_EQ(network.lane(ground[2].lane).id, "in_2");
  const auto bridge = network.lanesNear({50.0, 1.0}, 7.0, 8.0);
  ASSERT_EQ(bridge.size(), 1u);
  EXPECT_EQ(network.lane(bridge[0].lane).id, "bridge_0");
  EXPECT_DOUBLE_EQ(bridge[0].projection.elevation, 8.0);
  const auto all = network.lanesNear({50.0, 1.0}, 8.0);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(network.lane(all[0].lane).id, "bridge_0");
  EXPECT_TRUE(network.lanesNear({50.0, 1.0}, 0.0, 0.9).empty());
  EXPECT_TRUE(network.lanesNear({5000.0, 1.0}, 100.0).empty());
}

TEST(RoadNetwork, FindsTheSameLanesAsASearchOverAll) {
  const RoadNetwork network = crossing();
  for (double x = -30.0; x < 230.0; x += 7.3) {
    for (double y = -70.0; y < 100.0; y += 9.1) {
      std::size_t expected = 0;
      for (const Lane& lane : network.lanes()) {
        if (lane.allows_cars && lane.centerline.project({x, y}).distance <= 25.0) ++expected;
      }
      EXPECT_EQ(network.lanesNear({x, y}, 25.0).size(), expected) << x << ", " << y;
    }
  }
}

TEST(RoadNetwork, NamesWhatIsWrong) {
  const std::string broken = errorOf("<net>\n<edge id=\"a\">\n</net>");
  EXPECT_NE(broken.find("given.net.xml"), std::string::npos) << broken;
  EXPECT_NE(broken.find("line 3"), std::string::npos) << broken;
  EXPECT_NE(errorOf("<routes/>").find("no <net>"), std::string::npos);
  EXPECT_NE(errorOf("<net/>").find("no lanes"), std::string::npos);
  const auto expectError = [](const std::string& old_text, const std::string& new_text,
                              const std::string& part) {
    const std::string message = errorOf(crossingWith(old_text, new_text));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expectError("shape=\"120,0 200,0\"", "", "lane 'out_0' has no shape");
  expectError("shape=\"120,0 200,0\"", "shape=\"120,0\"", "lane 'out_0' has no shape");
  expectError("120,0 200,0", "120,0 nan,0", "lane 'out_0': shape point \"nan,0\"");
  expectError("120,0 200,0", "120,0 200", "lane 'out_0': shape point \"200\"");
  expectError("width=\"3.5\"", "width=\"inf\"", "lane 'in_0': width=\"inf\"");
  expectError("width=\"3.5\"", "width=\"1e9\"", "lane 'in_0': width=\"1e9\"; 0 to 100 m");
  for (const char* length : {"nan", "inf", "-5"}) {
    const std::string attribute = std::string("length=\"") + length + "\"";
    expectError("width=\"3.5\"", "width=\"3.5\" " + attribute, "lane 'in_0': " + attribute);
  }
  expectError("120,0 200,0", "120,0 1e15,0",
              "lane 'out_0': the point 1e+15,0 lies more than 1e+06 m from the first lane");
  expectError("via=\":j_0_0\"", "via=\":j_9_0\"", "unknown lane ':j_9_0'");
  expectError("to=\"out\" fromLane", "to=\"gone\" fromLane", "unknown lane 'gone_0'");
  expectError("id=\"in_1\"", "id=\"in_0\"", "lane 'in_0' appears twice");
  expectError("netOffset=\"12.50,-3.00\"", "netOffset=\"12.50,x\"", "netOffset");
}

TEST(RoadNetwork, ReadsRealCities) {
  for (const std::string name : {"cologne1", "ingolstadt1"}) {
    const auto path = test::realData("resco/" + name + ".net.xml");
    CDIFF_SKIP_WITHOUT(path);
    const RoadNetwork network = RoadNetwork::fromText(core::readFile(path, "network"), name);
    EXPECT_EQ(network.lanes().size(), 52u) << name;  // grep -c "<lane" in both files
    for (const Lane& lane : network.lanes()) {
      EXPECT_EQ(lane.next.empty() && lane.internal && lane.allows_cars, false) << lane.id;
    }
  }
}

}  // namespace
}  // namespace cdiff::map
