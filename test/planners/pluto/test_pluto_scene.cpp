// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planners/course.h"
#include "planners/pluto/pluto_scene.h"
#include "traffic/vehicle_class.h"

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
  const PlutoInput result = input();
  for (const PlutoPolygon& polygon : result.polygons) {
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

TEST(PlutoLights, AreReadByTheirLetter) {
  LanePiece piece;
  piece.signal = "light";
  const std::pair<const char*, LightState> states[] = {
      {"xg", LightState::kGreen},  {"xG", LightState::kGreen},  {"xy", LightState::kYellow},
      {"xY", LightState::kYellow}, {"xu", LightState::kYellow}, {"xr", LightState::kRed},
      {"xR", LightState::kRed},    {"xo", LightState::kNone},   {"g", LightState::kNone}};
  for (const auto& [letters, state] : states) {
    piece.link = 1;
    EXPECT_EQ(lightState({{"other", "rr"}, {"light", letters}}, piece), state) << letters;
    piece.link = -1;
    EXPECT_EQ(lightState({{"light", letters}}, piece), LightState::kNone);
  }
  piece.link = 0;
  EXPECT_EQ(lightState({{"light", "g"}}, piece), LightState::kGreen);
  EXPECT_EQ(lightState({{"other", "g"}}, piece), LightState::kNone);
}

// A bend: after k m along the first heading it lies 0.1 k^2 m to the left and is turned by 0.05 k.
TEST(PlutoLines, AreGivenEveryThreeMetersInTheirOwnFrameAndTheVehicles) {
  const geometry::Pose2d first{{10.0, 5.0}, 0.5};
  const geometry::Pose2d frame{{8.0, 4.0}, 0.3};
  ReferenceLine line;
  for (int k = 0; k <= 7; ++k)
    line.poses.push_back({first.toMap({1.0 * k, 0.1 * k * k}), 0.5 + 0.05 * k});
  const PlutoLine token = plutoLine(frame, line);
  ASSERT_EQ(token.points.size(), 3U * kLineChannels);
  EXPECT_NEAR(token.pose[2], 0.2 / core::kPi, 1e-6);
  for (int i = 0; i < 3; ++i) {
    const double k = 3.0 * i, next = std::min(k + 3.0, 7.0);
    const Eigen::Vector2d seen = frame.toBody(first.toMap({k, 0.1 * k * k}));
    const double expected[] = {
        k / 20.0,           0.1 * k * k / 20.0, (next - k) / 3.0, 0.1 * (next * next - k * k) / 3.0,
        std::cos(0.05 * k), std::sin(0.05 * k), seen.x() / 10.0,  seen.y() / 10.0};
    for (std::size_t c = 0; c < 8; ++c)
      EXPECT_NEAR(token.points[static_cast<std::size_t>(i) * 8 + c], expected[c], 1e-5) << i << c;
  }
}

// A bus 10 m to the left that turns by 0.2 to the left at 4 m/s, the vehicle heading along x: from
// heading 0 to 0.2 its speed changes by 4 (cos 0.2 - 1) and 4 sin 0.2.
TEST_F(PlutoSceneTest, ATurningAgentIsGivenWithItsTurnAndSize) {
  for (int i = 0; i < 2; ++i) {
    traffic::Vehicle bus = vehicleAt("bus", 0.4 * i, 10.0 + 0.1 * i, 0.2 * i, 4.0);
    bus.dimensions = {12.0, 2.5, 3.2};
    decide({vehicleAt("own", 0.0, 0.0, 0.0, 0.0), bus});
  }
  const PlutoAgent agent = input().agents.at(0);
  EXPECT_EQ(agent.kind, static_cast<std::uint8_t>(traffic::classOf({12.0, 2.5, 3.2})));
  EXPECT_NE(agent.kind, static_cast<std::uint8_t>(traffic::classOf({4.5, 1.8, 1.5})));
  EXPECT_NEAR(agent.pose[0], 0.4 / 80.0, 1e-6);
  EXPECT_NEAR(agent.pose[1], 10.1 / 80.0, 1e-6);
  EXPECT_NEAR(agent.pose[2], 0.2 / core::kPi, 1e-6);
  const double row[] = {0.4,
                        0.1,
                        4.0 * (std::cos(0.2) - 1.0),
                        4.0 * std::sin(0.2),
                        std::cos(0.2),
                        std::sin(0.2),
                        0.25,
                        1.2,
                        1.0};
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(agent.history[(kPlutoHistory - 1) * kAgentChannels + i], row[i], 1e-5) << i;
}

// Known at the first and the third of three decisions, not at the second.
TEST_F(PlutoSceneTest, AnAgentThatWasAwayHasNoHistory) {
  const traffic::Vehicle own = vehicleAt("own", 0.0, 0.0, 0.0, 0.0);
  const traffic::Vehicle other = vehicleAt("a", 10.0, 0.0, 0.0, 0.0);
  decide({own, other});
  decide({own});
  decide({own, other});
  const PlutoInput result = input();
  for (const float value : result.agents.at(0).history) EXPECT_EQ(value, 0.0F);
}

TEST_F(PlutoSceneTest, VehiclesOnAnotherLevelAreNoTokens) {
  traffic::Vehicle above = vehicleAt("above", 10.0, 0.0, 0.0, 0.0);
  above.state.elevation = 6.0;
  decide({vehicleAt("own", 0.0, 0.0, 0.0, 0.0), above});
  EXPECT_TRUE(input().agents.empty());
}

// From x = 160 m what lies on `in` has been driven.
TEST_F(PlutoSceneTest, WhatIsBehindIsNotOnTheRoute) {
  decide({vehicleAt("own", 160.0, 0.0, 0.0, 3.0)});
  const PlutoInput result = input();
  int in = 0;
  for (const PlutoPolygon& polygon : result.polygons) {
    const std::string& id = network_.lane(builder_.pieces().all()[polygon.piece].lane).id;
    in += id == "in_0" ? 1 : 0;
    EXPECT_EQ(polygon.on_route, id == "out_0" ? 1 : 0) << id;
    EXPECT_EQ(polygon.internal, 0);
  }
  EXPECT_EQ(in, 2);
}

}  // namespace
}  // namespace cdiff::planners
