// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "session/demand_file.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

constexpr const char* kDemand = R"(<routes>
 <vType id="car"/>
 <route id="r" edges="a b  c"><stop lane="b_1" startPos="2" endPos="-3" until="600"/></route>
 <vehicle id="v" route="r" depart="1"><stop edge="c" duration="20"/></vehicle>
 <vehicle id="w" depart="9"><route edges="d e"/></vehicle>
 <trip id="t" from="a" to="c" depart="4"><stop busStop="s" duration="5"/></trip>
 <flow id="f" route="r" begin="0" end="10" number="20"/>
</routes>)";

class DemandFiles : public testing::Test {
 protected:
  DemandFiles() { std::ofstream(file()) << kDemand; }
  std::string file() const { return (folder_.path() / "cars.rou.xml").string(); }
  test::TemporaryFolder folder_;
};

TEST_F(DemandFiles, CountVehiclesOfATime) {
  const DemandFile demand(file());
  EXPECT_NEAR(demand.vehicles(0.0, 5.0), 10.0 + 2.0, 1e-9);  // half of the flow, v and t
  EXPECT_NEAR(demand.vehicles(0.0, 99.0), 20.0 + 3.0, 1e-9);
}

TEST_F(DemandFiles, CountVehiclesOfAFlowWithDrawnTimes) {
  std::ofstream(file())
      << R"xml(<routes><flow id="f" begin="0" end="100" period="exp(0.5)"/></routes>)xml";
  EXPECT_NEAR(DemandFile(file()).vehicles(0.0, 10.0), 5.0, 1e-9);
}

TEST_F(DemandFiles, KnowRoutes) {
  const DemandFile demand(file());
  const std::vector<std::string> named = {"a", "b", "c"};
  EXPECT_EQ(demand.routeOf("v"), named);
  EXPECT_EQ(demand.routeOf("f.7"), named);
  EXPECT_EQ(demand.routeOf("w"), (std::vector<std::string>{"d", "e"}));
  EXPECT_TRUE(demand.routeOf("t").empty());
  EXPECT_TRUE(demand.routeOf("v.7").empty());
  EXPECT_TRUE(demand.routeOf("nobody").empty());
}

TEST_F(DemandFiles, KnowStopsOfVehicleAndRoute) {
  const DemandFile demand(file());
  const std::vector<DemandStop> stops = demand.stopsOf("v");
  ASSERT_EQ(stops.size(), 2U);
  EXPECT_EQ(stops[0].lane, "b_1");
  EXPECT_EQ(stops[0].edge, "b");
  EXPECT_EQ(stops[0].begin, 2.0);
  EXPECT_EQ(stops[0].end, -3.0);
  EXPECT_EQ(stops[0].until, 600.0);
  EXPECT_FALSE(stops[0].duration);
  EXPECT_EQ(stops[1].edge, "c");
  EXPECT_EQ(stops[1].duration, 20.0);
  ASSERT_EQ(demand.stopsOf("t").size(), 1U);
  EXPECT_TRUE(demand.stopsOf("t")[0].edge.empty());
  EXPECT_TRUE(demand.stopsOf("w").empty());
}

}  // namespace
}  // namespace cdiff::session
