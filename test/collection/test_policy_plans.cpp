// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "collection/policy_plans.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/scenario_options.h"
#include "support/snapshot_builder.h"

namespace cdiff::collection {
namespace {

constexpr Eigen::Index kRows = 32;

/// The ego of a shipped scenario at the start of its route, among others that stand still.
struct Scene {
  Scene() {
    snapshot.vehicles.front().state.position = setup.egoRoute().path().positionAt(5.0);
    snapshot.vehicles.front().state.heading = setup.egoRoute().path().headingAt(5.0);
  }
  const traffic::Vehicle& ego() const { return snapshot.vehicles.front(); }
  void add(double ahead) {
    traffic::Vehicle other = test::vehicle("other", {});
    other.state.position = setup.egoRoute().path().positionAt(5.0 + ahead);
    other.state.heading = setup.egoRoute().path().headingAt(5.0 + ahead);
    snapshot.vehicles.push_back(other);
  }
  SampleSurroundings around() const { return {setup, snapshot, setup.egoRoute(), 5.0}; }
  double returnOf(const traffic::Rollout& rollout) const {
    return rolloutReturn(rollout, ego(), around(),
                         std::vector<const traffic::TrafficSnapshot*>(kRows, &snapshot));
  }

  session::SessionSetup setup{session::loadScenario("crossing_left_turn")};
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(0, {0.0, 0.0, 0.0, 8.0});
};

/// Straight on at a speed [m/s], `aside` of the own line [m].
traffic::Rollout straight(double speed, double aside = 0.0) {
  traffic::Rollout rollout = traffic::Rollout::Zero(kRows, traffic::kRolloutColumns);
  for (Eigen::Index t = 0; t < kRows; ++t) {
    rollout(t, traffic::kRolloutX) = 0.1 * speed * static_cast<double>(t + 1);
    rollout(t, traffic::kRolloutY) = aside;
    rollout(t, traffic::kRolloutSpeed) = speed;
  }
  return rollout;
}

TEST(RolloutReturn, DrivingOnIsBetterThanCreepingAndTheRoadThanTheGrass) {
  const Scene scene;
  EXPECT_GT(scene.returnOf(straight(8.0)), scene.returnOf(straight(1.0)));
  EXPECT_GT(scene.returnOf(straight(8.0)), scene.returnOf(straight(8.0, 0.8)));
  EXPECT_GT(scene.returnOf(straight(8.0, 0.8)), scene.returnOf(straight(8.0, -40.0)) + 50.0);
}

TEST(RolloutReturn, ACollisionCostsItsSpeedAndEndsTheSum) {
  Scene scene;
  const double free = scene.returnOf(straight(8.0));
  scene.add(15.0);
  const double struck = scene.returnOf(straight(8.0));
  // 20 + |v| = 28, discounted over the 10.5 m until the boxes meet, and what was earned by then.
  EXPECT_LT(struck, -28.0 * std::pow(0.98, 14) + free);
  EXPECT_GT(struck, -28.0);
  EXPECT_LT(scene.returnOf(straight(7.9)), scene.returnOf(straight(1.0)));
}

TEST(ReturnWeights, GrowWithTheReturnUpToThree) {
  const std::vector<double> weights = returnWeights({-10.0, 0.0, 0.0, 1.0});
  EXPECT_LT(weights[0], 0.05);
  EXPECT_EQ(weights[1], weights[2]);
  EXPECT_GT(weights[3], weights[1]);
  const std::vector<double> capped = returnWeights({0.0, 0.0, 0.0, 0.0, 0.0, 5.0});
  EXPECT_EQ(capped[5], 3.0);
  // Only the order and the distances count.
  const std::vector<double> moved = returnWeights({-1000.0, 0.0, 0.0, 100.0});
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(moved[i], weights[i], 1e-4);
}

TEST(ReturnWeights, EqualReturnsWeighTheSame) {
  EXPECT_EQ(returnWeights({2.0, 2.0, 2.0}), (std::vector<double>{1.0, 1.0, 1.0}));
}

/// A sample of the scene with a gray image, as the expert would drive on.
learning::DrivingSample sampleOf(const Scene& scene) {
  learning::DrivingSample sample;
  const diffusion::Architecture sizes;
  sample.vehicle = scene.ego().id;
  sample.speed = 8.0;
  sample.image.width = static_cast<int>(sizes.image_width);
  sample.image.height = static_cast<int>(sizes.image_height);
  sample.image.rgb.assign(static_cast<std::size_t>(sizes.image_width * sizes.image_height * 3),
                          128);
  sample.route =
      diffusion::routeTokens(sizes, scene.setup.egoRoute().path(), 5.0, scene.ego().state.pose());
  sample.rollout = straight(8.0);
  return sample;
}

TEST(PolicyPlans, KeepAnExecutablePlanOfTheModelAndNothingElseChanges) {
  const Scene scene;
  const learning::DrivingSample sample = sampleOf(scene);
  const std::vector<const traffic::TrafficSnapshot*> future(kRows, &scene.snapshot);
  PolicyPlans plans("default", 4, scene.setup);
  const auto improved = plans.improved(sample, scene.around(), future);
  ASSERT_TRUE(improved);
  EXPECT_NE(improved->rollout, sample.rollout);
  EXPECT_EQ(improved->image.rgb, sample.image.rgb);
  EXPECT_EQ(improved->route, sample.route);
  traffic::Rollout driven = improved->rollout;
  dynamics::makeExecutable(driven);
  dynamics::ActionRollout(scene.setup.options().vehicle).rollOut(sample.speed, driven);
  EXPECT_EQ(driven, improved->rollout) << "states are those of its actions";
  PolicyPlans again("default", 4, scene.setup);
  EXPECT_EQ(again.improved(sample, scene.around(), future)->rollout, improved->rollout);
}

/// Of many draws, plans that run into what stands ahead come seldom.
TEST(PolicyPlans, PlansWithALargerReturnAreKeptMoreOften) {
  Scene scene;
  scene.add(22.0);
  learning::DrivingSample sample = sampleOf(scene);
  const std::vector<const traffic::TrafficSnapshot*> future(kRows, &scene.snapshot);
  PolicyPlans chosen("default", 16, scene.setup);
  PolicyPlans any("default", 2, scene.setup);
  double of_chosen = 0.0, of_any = 0.0;
  for (std::uint64_t tick = 0; tick < 20; ++tick) {
    sample.tick = tick;
    const auto best = chosen.improved(sample, scene.around(), future);
    const auto rather = any.improved(sample, scene.around(), future);
    if (!best || !rather) continue;
    of_chosen += scene.returnOf(best->rollout);
    of_any += scene.returnOf(rather->rollout);
  }
  EXPECT_GT(of_chosen, of_any);
}

TEST(PolicyPlans, AModelWithoutARouteIsRefused) {
  const Scene scene;
  EXPECT_THROW(PolicyPlans("paper", 4, scene.setup), core::InputError);
}

}  // namespace
}  // namespace cdiff::collection
