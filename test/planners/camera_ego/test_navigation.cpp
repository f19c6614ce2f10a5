// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/camera_ego/navigation.h"
#include "planners/course.h"

namespace cdiff::planners {
namespace {

/// 80 m to a junction, a left turn of radius 10 m in it (15.7 m), 80 m on.
struct LeftTurn {
  map::RoadNetwork network =
      testing::makeNetwork({{"in", testing::straight(0.0, 0.0, 80.0, 0.0)},
                            {":j", bend(), 13.89, true},
                            {"out", testing::straight(90.0, 10.0, 90.0, 90.0)}},
                           {{"in", "out", "", "M"}});
  map::Route route = testing::routeAlong(network, {"in", ":j", "out"});

  static testing::Points bend() {
    testing::Points points;
    for (int i = 0; i <= 18; ++i) {
      const double angle = core::degreesToRadians(5.0 * i);
      points.emplace_back(80.0 + 10.0 * std::sin(angle), 10.0 * (1.0 - std::cos(angle)), 0.0);
    }
    return points;
  }
};

TEST(Navigation, CommandsATurnFromFiftyMetersBeforeToItsEnd) {
  const LeftTurn turn;
  if (turn.route.junctionStretches().empty()) GTEST_FAIL() << "the course has no junction";
  const auto [begin, end] = turn.route.junctionStretches().front();
  const Navigation navigation(turn.network, turn.route);
  // A node every 50 m: at 50 m "follow", at about 80 m the turn.
  EXPECT_EQ(navigation.next(0.0).command, RoadCommand::kFollow);
  EXPECT_NEAR(navigation.next(0.0).arc_length, 50.0, 1e-9);
  EXPECT_EQ(navigation.next(46.1).command, RoadCommand::kLeft) << "50 m is nearer than 4 m";
  EXPECT_NEAR(navigation.next(60.0).position.x(), 80.0, 1.1);
  EXPECT_EQ(navigation.next(begin + 1.0).command, RoadCommand::kLeft) << "in the turn";
  EXPECT_NEAR(navigation.next(begin + 1.0).arc_length, end, 1e-9);
  EXPECT_EQ(navigation.next(end + 1.0).command, RoadCommand::kFollow);
  EXPECT_NEAR(navigation.next(1e6).arc_length, turn.route.length(), 1e-9);
}

TEST(Navigation, NumbersAreThoseOfRoadOption) {
  EXPECT_EQ(roadCommandOf(0), RoadCommand::kLeft);
  EXPECT_EQ(roadCommandOf(5), RoadCommand::kChangeRight);
  EXPECT_EQ(roadCommandOf(-2), RoadCommand::kFollow) << "no command, as in Bench2Drive's agents";
  try {
    roadCommandOf(6);
    FAIL() << "6 was taken";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("command is 6; expected 0 (left) to 5"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::planners
