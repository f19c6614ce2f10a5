// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/pluto/pluto_scene.h"

namespace cdiff::planners {
namespace {

using testing::straight;
using testing::vehicleAt;

/// A road of 300 m along x whose second half is behind a light; decisions every 0.1 s.
class PlutoSceneTest : public ::testing::Test {
 protected:
  void decide(std::vector<traffic::Vehicle> vehicles) {
    snapshot_.time = 0.1 * static_cast<double>(decisions_++);
    snapshot_.vehicles = std::move(vehicles);
    tracks_.add(snapshot_);
  }
  PlutoInput input() {
    PlutoMoment moment;
    moment.frames = tracks_.frames();
    moment.vehicles = &tracks_.vehicles();
    moment.own = tracks_.vehicles().numberOf(snapshot_.vehicles.front());
    moment.route = &route_;
    moment.arc_length = snapshot_.vehicles.front().state.position.x();
    moment.target_speed = 8.0;
    moment.signals = &snapshot_.signals;
    return builder_.inputOf(moment, builder_.linesOf(moment));
  }

  map::RoadNetwork network_ = testing::makeNetwork({{"in", straight(0.0, 0.0, 150.0, 0.0), 6.0},
                                                    {"out", straight(150.0, 0.0, 300.0, 0.0)},
                                                    {"far", straight(0.0, 60.0, 300.0, 60.0)}},
                                                   {{"in", "out", "light"}});
  map::Route route_ = testing::routeAlong(network_, {"in", "out"});
  PlutoArchitecture architecture_;
  PlutoSceneBuilder builder_{architecture_, network_};
  RecentTracks tracks_{0.1};
  traffic::TrafficSnapshot snapshot_;
  int decisions_ = 0;
};

// The vehicle heads along +y at the origin; the other drives along +y 10 m to its right, 0.5 m in
// 0.1 s, and is faster by 0.2 m/s every time. In the vehicle's frame +y is x.
TEST_F(PlutoSceneTest, AnAgentsHistoryAreDifferencesInTheVehiclesFrame) {
  const double up = 0.5 * core::kPi;
  for (int i = 0; i < 3; ++i)
    decide({vehicleAt("own", 0.0, 0.0, up, 0.0), vehicleAt("a", 10.0, 0.5 * i, up, 5.0 + 0.2 * i)});
  const PlutoInput result = input();
  ASSERT_EQ(result.agents.size(), 1U);
  const PlutoAgent& agent = result.agents[0];
  EXPECT_NEAR(agent.pose[0], 1.0 / 80.0, 1e-6);
  EXPECT_NEAR(agent.pose[1], -10.0 / 80.0, 1e-6);
  EXPECT_NEAR(agent.pose[2], 0.0, 1e-6);
  const double row[] = {0.5, 0.0, 0.2, 0.0, 1.0, 0.0, 0.18, 0.45, 1.0};
  for (std::int64_t i = 0; i < kPlutoHistory * kAgentChannels; ++i) {
    // Three decisions make two differences, which are the last.
    const bool known = i >= 18 * kAgentChannels;
    EXPECT_NEAR(agent.history[static_cast<std::size_t>(i)], known ? row[i % kAgentChannels] : 0.0,
                1e-5)
        << i;
  }
}

TEST_F(PlutoSceneTest, AGapInTheDecisionsStartsTheHistoryAnew) {
  for (int i = 0; i < 30; ++i)
    decide({vehicleAt("own", 0.0, 0.0, 0.0, 0.0), vehicleAt("a", 10.0, 0.0, 0.0, 0.0)});
  EXPECT_EQ(tracks_.frames().size(), 21U);
  EXPECT_EQ(input().agents[0].history[kAgentChannels - 1], 1.0F);
  ++decisions_;  // one at which the planner was not asked
  decide({vehicleAt("own", 0.0, 0.0, 0.0, 0.0), vehicleAt("a", 10.0, 0.0, 0.0, 0.0)});
  EXPECT_EQ(tracks_.frames().size(), 1U);
  const PlutoInput result = input();
  for (const float value : result.agents[0].history) EXPECT_EQ(value, 0.0F);
}

// 80.1 m is too far; a and b are as far away as each other; 24 of 30 stay.
TEST_F(PlutoSceneTest, TheNearestVehiclesAreTokens) {
  decide({vehicleAt("own", 100.0, 0.0, 0.0, 0.0), vehicleAt("far", 180.1, 0.0, 0.0, 0.0),
          vehicleAt("b", 110.0, 0.0, 0.0, 0.0), vehicleAt("a", 90.0, 0.0, 0.0, 0.0)});
  PlutoInput result = input();
  ASSERT_EQ(result.agents.size(), 2U);
  EXPECT_EQ(tracks_.vehicles().id(result.agents[0].vehicle), "a");
  EXPECT_EQ(tracks_.vehicles().id(result.agents[1].vehicle), "b");
  std::vector<traffic::Vehicle> many = {vehicleAt("own", 100.0, 0.0, 0.0, 0.0)};
  for (int i = 0; i < 30; ++i)
    many.push_back(vehicleAt("v" + std::to_string(i), 100.0 + i, 5.0, 0.0, 0.0));
  decide(many);
  EXPECT_EQ(input().agents.size(), 24U);
}

// 150 m are cut into three pieces of 50 m. From x = 140 m within 80 m: 50 to 150 m of `in`, `out`
// up to 220 m, which are two pieces, and those of `far` from about 87 m on, 60 m to the side.
TEST_F(PlutoSceneTest, PolygonsKnowRouteLightAndLimit) {
  snapshot_.signals = {{"light", "r"}};
  decide({vehicleAt("own", 140.0, 0.0, 0.0, 3.0)});
  int in = 0;
  int out = 0;
  int far = 0;
  for (const PlutoPolygon& polygon : input().polygons) {
    const LanePiece& piece = builder_.pieces().all()[polygon.piece];
    const std::string& id = network_.lane(piece.lane).id;
    in += id == "in_0" ? 1 : 0;
    out += id == "out_0" ? 1 : 0;
    far += id == "far_0" ? 1 : 0;
    EXPECT_EQ(polygon.on_route, id == "far_0" ? 0 : 1) << id;
    const auto light = id == "out_0" ? LightState::kRed : LightState::kNone;
    EXPECT_EQ(polygon.light, static_cast<std::uint8_t>(light)) << id;
    // The lower of the lane's limit and the driver's 8 m/s, in 15 m/s.
    EXPECT_NEAR(polygon.limit, (id == "in_0" ? 6.0 : 8.0) / 15.0, 1e-6) << id;
  }
  EXPECT_EQ(in, 2);
  EXPECT_EQ(out, 2);
  EXPECT_EQ(far, 3);
}

TEST_F(PlutoSceneTest, APieceIsDescribedInItsOwnFrame) {
  const LanePiece& piece = builder_.pieces().all().front();
  EXPECT_NEAR(piece.pose.position.x(), 25.0, 1e-9);
  EXPECT_NEAR(piece.reach, 25.0, 1e-6);
  // The first point lies 25 m behind the middle; steps of 50 / 19 m; a lane of 3.2 m.
  const double first[] = {-2.5, 0.0, 50.0 / 19.0, 0.0, 1.0, 0.0, 0.0, 1.6, 0.0, -1.6};
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(piece.points[i], first[i], 1e-5) << i;
}

TEST_F(PlutoSceneTest, MotionIsThatOfTheVehicle) {
  traffic::Vehicle own = vehicleAt("own", 10.0, 0.0, 0.0, 5.0);
  own.acceleration = -2.0;
  own.applied_action = {0.0, 0.25, 0.5};
  decide({own});
  const PlutoInput result = input();
  EXPECT_NEAR(result.motion[0], 0.5, 1e-6);
  EXPECT_NEAR(result.motion[1], -0.5, 1e-6);
  EXPECT_NEAR(result.motion[2], 0.25, 1e-6);
  EXPECT_TRUE(result.agents.empty());
  ASSERT_EQ(result.lines.size(), 1U);
  EXPECT_EQ(result.lines[0].points.size(), 41U * kLineChannels);
}

// Of a vehicle 1 m to the left of its lane and turned by 0.1 to the left, the line lies to the
// right.
TEST_F(PlutoSceneTest, ALineIsGivenAsTheVehicleSeesIt) {
  decide({vehicleAt("own", 10.0, 1.0, 0.1, 5.0)});
  const PlutoInput result = input();
  ASSERT_EQ(result.lines.size(), 1U);
  const float* second = result.lines[0].points.data() + kLineChannels;  // 3 m ahead
  const double expected[] = {0.15, 0.0, 1.0, 0.0, 1.0, 0.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(second[i], expected[i], 1e-5) << i;
  EXPECT_NEAR(second[6], (3.0 * std::cos(0.1) - std::sin(0.1)) / 10.0, 1e-5);
  EXPECT_NEAR(second[7], (-3.0 * std::sin(0.1) - std::cos(0.1)) / 10.0, 1e-5);
}

}  // namespace
}  // namespace cdiff::planners
