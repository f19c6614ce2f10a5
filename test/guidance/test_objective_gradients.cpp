// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "guidance/drivable_area_objective.h"
#include "guidance/guidance_world.h"
#include "guidance/objective_registry.h"
#include "guidance/route_objective.h"

namespace cdiff::guidance {
namespace {

using test::GuidanceWorld;
using traffic::Rollout;

/// Step 1e-5 on values up to 1e3: truncation below 1e-8 (third derivatives below 1e2), rounding
/// 1e3 x 2e-16 / 1e-5 = 2e-8.
constexpr double kStep = 1e-5;
constexpr double kTolerance = 1e-6;

/// Returns the number of cells with a gradient, so that a test can see that there were some.
int expectGradient(const Objective& objective, const GuidanceScene& scene, const Rollout& rollout) {
  const Rollout gradient = test::gradientOf(objective, scene, rollout);
  int used = 0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    for (int column = 0; column < traffic::kRolloutColumns; ++column) {
      Rollout above = rollout;
      Rollout below = rollout;
      above(row, column) += kStep;
      below(row, column) -= kStep;
      const double difference =
          (test::valueOf(objective, scene, above) - test::valueOf(objective, scene, below)) /
          (2.0 * kStep);
      EXPECT_NEAR(gradient(row, column), difference, kTolerance * (1.0 + std::abs(difference)))
          << "row " << row << ", column " << column;
      if (gradient(row, column) != 0.0) ++used;
    }
  }
  return used;
}

const geometry::Pose2d kFrames[] = {
    {{0.0, 0.0}, 0.0}, {{310.0, -75.0}, 0.7}, {{-2000.0, 950.0}, -2.6}};

int expectGradientEverywhere(const Objective& objective) {
  int used = 0;
  for (const geometry::Pose2d& frame : kFrames) {
    GuidanceWorld world(frame);
    for (std::uint32_t trial = 0; trial < 3; ++trial) {
      used += expectGradient(objective, world.scene(), test::wandering(trial));
      world.scene().state = world.placed(94.0, -1.0, 0.3, 8.0);  // the bend and the route's end
      world.scene().route_arc_length = 94.0;
      world.setOther(103.0, 0.5);
      used += expectGradient(objective, world.scene(), test::wandering(trial));
      world.scene().state = world.placed(40.0, 0.5, -0.4, 8.0);
      world.scene().route_arc_length = 40.0;
    }
  }
  return used;
}

TEST(ObjectiveGradients, EveryObjectiveOfTheTable) {
  for (const std::string& name : objectiveNames()) {
    SCOPED_TRACE(name);
    EXPECT_GT(expectGradientEverywhere(*makeObjective(name)), 50);
  }
}

TEST(ObjectiveGradients, DrivableAreaAtTheBumpersTurnsTheHeading) {
  DrivableAreaObjective objective;
  objective.points = "bumpers";
  EXPECT_GT(expectGradientEverywhere(objective), 50);
  GuidanceWorld world;
  // The front is over the left border: turning right (a smaller heading) lowers J.
  EXPECT_GT(test::gradientOf(objective, world.scene(), test::standing(0.0, 1.0, 0.6))(
                0, traffic::kRolloutHeading),
            0.0);
}

TEST(ObjectiveGradients, RouteWithHeading) {
  RouteObjective objective;
  objective.heading_weight = 2.0;
  EXPECT_GT(expectGradientEverywhere(objective), 50);
}

TEST(ObjectiveGradients, RouteOutsideAKinkPointsAwayFromIt) {
  GuidanceWorld world;
  // A turn of 45 degrees to the left 45 m along; on its outer side the kink is the nearest point.
  const map::Route route(world.network(), {{0, 0, 0}, {45, 0, 0}, {60, 15, 0}}, {0, 0, 0});
  world.scene().route = &route;
  const RouteObjective objective;
  const Rollout beside = test::standing(6.0, -2.0, 0.0, 0.0, 1);
  expectGradient(objective, world.scene(), beside);
  // 1 m ahead and 2 m to the right of the kink: (sqrt(5) - 0.5)^2, downhill back and to the left.
  EXPECT_NEAR(test::valueOf(objective, world.scene(), beside), 5.25 - std::sqrt(5.0), 1e-12);
  const Rollout gradient = test::gradientOf(objective, world.scene(), beside);
  EXPECT_NEAR(gradient(0, traffic::kRolloutY), -2.0 * gradient(0, traffic::kRolloutX), 1e-12);
  EXPECT_GT(gradient(0, traffic::kRolloutX), 0.0);
}

TEST(ObjectiveGradients, AddToWhatIsThere) {
  GuidanceWorld world;
  const Rollout rollout = test::wandering(7);
  for (const std::string& name : objectiveNames()) {
    const auto objective = makeObjective(name);
    objective->prepare(world.scene());
    Rollout gradient = Rollout::Constant(rollout.rows(), traffic::kRolloutColumns, 3.0);
    objective->evaluate(world.scene(), rollout, gradient);
    const Rollout alone = test::gradientOf(*objective, world.scene(), rollout);
    EXPECT_LT((gradient - alone).cwiseAbs().maxCoeff() - 3.0, 1e-12) << name;
    EXPECT_GT((gradient - alone).cwiseAbs().minCoeff() - 3.0, -1e-12) << name;
  }
}

TEST(ObjectiveGradients, TurningAndMovingTheWorldChangesNothingInTheBodyFrame) {
  GuidanceWorld here;
  GuidanceWorld there(kFrames[1]);
  const Rollout rollout = test::wandering(5);
  for (const std::string& name : objectiveNames()) {
    const auto objective = makeObjective(name);
    // Borders lie on a grid of 1 mm: each may differ by 1.5 mm. J: 2 x 4.2 m missing x 1.5 mm x 8
    // rows = 0.1; gradient: 2 x 1.5 mm, and its direction by 4 x 1.5 mm / 100 m of border.
    const bool area = name == "drivable_area";
    EXPECT_NEAR(test::valueOf(*objective, here.scene(), rollout),
                test::valueOf(*objective, there.scene(), rollout), area ? 0.1 : 1e-9)
        << name;
    EXPECT_LT((test::gradientOf(*objective, here.scene(), rollout) -
               test::gradientOf(*objective, there.scene(), rollout))
                  .cwiseAbs()
                  .maxCoeff(),
              area ? 4e-3 : 1e-9)
        << name;
  }
}

}  // namespace
}  // namespace cdiff::guidance
