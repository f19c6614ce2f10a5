// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/driving_score.h"
#include "metrics/straight_road.h"
#include "support/network_text.h"

namespace cdiff::metrics {
namespace {

constexpr double kTail = 0.8 * 2.4;  // behind the center of a vehicle of 4.8 m
constexpr double kFront = 2.4;

/// East along y = 0 with a line at x = 100: straight on (link 0) or left (link 1); north along x =
/// 50 with a line at y = -10; a bridge 8 m above the line. `rule` goes to all links.
map::RoadNetwork crossing(const std::string& straight, const std::string& left) {
  return test::NetworkText()
      .edge("in", {"0,0 100,0"}, "w", "j")
      .edge("out", {"120,0 300,0"}, "j", "e")
      .edge("north", {"110,10 110,100"}, "j", "n")
      .edge("bridge", {"0,0,8 300,0,8"}, "x", "y")
      .edge(":j_0", {"100,0 120,0"})
      .edge(":j_1", {"100,0 110,10"})
      .junction("j", "100,-10 120,-10 120,10 100,10")
      .connection("in_0", "out_0", ":j_0_0", 's', straight)
      .connection("in_0", "north_0", ":j_1_0", 'l', left)
      .network();
}

map::RoadNetwork lights() {
  return crossing(R"(tl="L" linkIndex="0" state="o")", R"(tl="L" linkIndex="1" state="o")");
}

map::Route straightOn(const map::RoadNetwork& network) {
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x <= 200; x += 2) points.emplace_back(x, 0.0, 0.0);
  return map::matchRoute(network, points);
}

/// Drives the ego east from x to x, step by step of 0.5 m.
void drive(StopLines& lines, double from, double to, const std::string& state, double y = 0.0,
           double z = 0.0) {
  for (double x = from; x <= to; x += 0.5) {
    traffic::Vehicle vehicle = test::ego(x, y, 10.0);
    vehicle.state.elevation = z;
    lines.observe(vehicle, {{"L", state}});
  }
}

TEST(RedLights, CountWhenTheTailCrossesOnRed) {
  const map::RoadNetwork network = lights();
  const map::Route route = straightOn(network);
  StopLines red(network, route, {});
  drive(red, 80.0, 100.0 + kTail - 0.1, "rG");
  EXPECT_EQ(red.redLights(), 0U);  // the tail is still before the line
  drive(red, 100.0 + kTail + 0.1, 130.0, "rG");
  EXPECT_EQ(red.redLights(), 1U);
  EXPECT_EQ(red.lightsCrossed(), 1U);
  StopLines jumped(network, route, {});
  drive(jumped, 80.0, 130.0, "ug");  // red-yellow: not yet free
  EXPECT_EQ(jumped.redLights(), 1U);
}

TEST(RedLights, AreNotGreenYellowOrOff) {
  const map::RoadNetwork network = lights();
  const map::Route route = straightOn(network);
  for (const std::string state : {"Gr", "gr", "yr", "Yr", "or", "Or"}) {
    StopLines lines(network, route, {});
    drive(lines, 80.0, 130.0, state);
    EXPECT_EQ(lines.redLights(), 0U) << state;
    EXPECT_EQ(lines.lightsCrossed(), 1U) << state;
  }
}

TEST(RedLights, OffTheRouteOnlyWhereEveryLinkIsRed) {
  const map::RoadNetwork network = lights();
  StopLines one(network, map::Route(), {});
  drive(one, 80.0, 130.0, "rG");
  EXPECT_EQ(one.redLights(), 0U);
  StopLines both(network, map::Route(), {});
  drive(both, 80.0, 130.0, "rr");
  EXPECT_EQ(both.redLights(), 1U);
}

TEST(RedLights, AreNotRunBesideTheLaneAboveItOrAgainstIt) {
  const map::RoadNetwork network = lights();
  const map::Route route = straightOn(network);
  StopLines beside(network, route, {});
  drive(beside, 80.0, 130.0, "rr", 2.1);  // the lane is 4 m wide
  EXPECT_EQ(beside.lightsCrossed(), 0U);
  StopLines above(network, route, {});
  drive(above, 80.0, 130.0, "rr", 0.0, 8.0);
  EXPECT_EQ(above.lightsCrossed(), 0U);
  StopLines against(network, route, {});
  for (double x = 130.0; x > 80.0; x -= 0.5) {
    traffic::Vehicle vehicle = test::ego(x, 0.0, 10.0);
    vehicle.state.heading = core::kPi;
    against.observe(vehicle, {{"L", "rr"}});
  }
  EXPECT_EQ(against.lightsCrossed(), 0U);
}

TEST(RedLights, OfAnUnknownLightAreNotCharged) {
  const map::RoadNetwork network = lights();
  StopLines lines(network, straightOn(network), {});
  for (double x = 80.0; x < 130.0; x += 0.5) lines.observe(test::ego(x, 0.0, 10.0), {});
  EXPECT_EQ(lines.redLights(), 0U);
  EXPECT_EQ(lines.lightsCrossed(), 1U);
}

/// A stop sign before which the ego comes down to a speed with its front at a distance.
std::size_t notObeyed(const std::string& state, double front_before_line, double speed) {
  const std::string link = "state=\"" + state + "\"";
  const map::RoadNetwork network = crossing(link, link);
  StopLines lines(network, straightOn(network), {});
  drive(lines, 80.0, 90.0, "");
  lines.observe(test::ego(100.0 - kFront - front_before_line, 0.0, speed), {});
  drive(lines, 98.0, 130.0, "");
  EXPECT_EQ(lines.stopSignsCrossed(), state == "s" || state == "w" ? 1U : 0U);
  return lines.stopSigns();
}

TEST(StopSigns, AskForAStopWithinFourMeters) {
  EXPECT_EQ(notObeyed("s", 3.9, 0.09), 0U);
  EXPECT_EQ(notObeyed("w", 3.9, 0.09), 0U);  // all-way stop
  EXPECT_EQ(notObeyed("s", 3.9, 0.11), 1U);
  EXPECT_EQ(notObeyed("s", 4.1, 0.0), 1U);
  EXPECT_EQ(notObeyed("w", 4.1, 0.0), 1U);
}

TEST(StopSigns, AreNotPriorityJunctions) {
  EXPECT_EQ(notObeyed("m", 30.0, 0.0), 0U);
  EXPECT_EQ(notObeyed("M", 30.0, 0.0), 0U);
}

TEST(StopSigns, AskAgainAtTheNextTime) {
  const map::RoadNetwork network = crossing(R"(state="s")", R"(state="s")");
  StopLines lines(network, straightOn(network), {});
  lines.observe(test::ego(97.0, 0.0, 0.0), {});
  drive(lines, 97.0, 130.0, "");
  EXPECT_EQ(lines.stopSigns(), 0U);
  drive(lines, 80.0, 130.0, "");  // the same line once more, without a stop
  EXPECT_EQ(lines.stopSigns(), 1U);
  EXPECT_EQ(lines.stopSignsCrossed(), 2U);
}

}  // namespace
}  // namespace cdiff::metrics
