// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/diffusion/diffusion_situation.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

/// An ego at the origin, CBVs "near" and "far" 30 and 60 m ahead of it, all at 5 m/s along +x on a
/// road with a limit of 7 m/s.
class Situations : public ::testing::Test {
 protected:
  Situations() {
    snapshot_.vehicles = {testing::vehicleAt("ego", 0.0, 0.0, 0.0, 5.0),
                          testing::vehicleAt("near", 30.0, 0.0, 0.0, 5.0),
                          testing::vehicleAt("far", 60.0, 0.0, 0.0, 5.0)};
    snapshot_.vehicles[0].role = traffic::VehicleRole::kEgo;
    options_.conditioning = "image_route";
    context_.ego_route = &route_;
    for (int slot = -1; slot < 2; ++slot)
      tasks_.push_back(
          {slot, &snapshot_.vehicles[static_cast<std::size_t>(slot + 1)], &route_, 8.0});
    for (DiffusionMemory& memory : memories_) memory.features = {0.5F};
  }
  SituationMaker maker() const {
    return {options_, guidance_, dynamics::BicycleModelOptions(), context_, model_, exact_};
  }
  PlannedVehicle vehicle(int slot) {
    const auto index = static_cast<std::size_t>(slot + 1);
    return {&tasks_[index], &memories_[index]};
  }
  /// That of one of the vehicles that are planned at a decision.
  std::unique_ptr<DiffusionSituation> situationOf(int slot, const std::vector<int>& planned) {
    SituationMaker situations = maker();
    std::vector<PlannedVehicle> vehicles;
    for (const int other : planned) vehicles.push_back(vehicle(other));
    situations.startDecision(snapshot_, vehicles);
    return situations.make(snapshot_, vehicle(slot));
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(-50.0, 0.0, 250.0, 0.0), 7.0}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  planning::PlanningContext context_{network_, area_};
  DiffusionOptions options_;
  guidance::GuidanceOptions guidance_;
  diffusion::Model model_ = cdiff::testing::randomDenoiser();
  dynamics::ActionRollout exact_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<planning::PlanningTask> tasks_;
  std::vector<DiffusionMemory> memories_{3};
};

// At 5 m/s the ego is 0.5 m farther along its route at each row.
TEST_F(Situations, ACbvIsAboutTheEgoAndTheEgoAboutTheNearest) {
  const auto of_cbv = situationOf(1, {0, 1});
  ASSERT_EQ(of_cbv->scene.other, &of_cbv->other);
  EXPECT_EQ(of_cbv->other.now.position.x(), 0.0);
  ASSERT_EQ(of_cbv->other.predicted.size(), 32U);
  EXPECT_NEAR(of_cbv->other.predicted[9].position.x(), 5.0, 1e-9);
  const auto of_ego = situationOf(-1, {-1});
  ASSERT_NE(of_ego->scene.other, nullptr);
  EXPECT_EQ(of_ego->scene.other->now.position.x(), 30.0);
  snapshot_.vehicles[0].state.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(situationOf(1, {0, 1})->scene.other, nullptr) << "an ego that is nowhere";
}

TEST_F(Situations, OthersThatArePlannedTooGoAlongTheirRoutesByTheSameRules) {
  const auto together = situationOf(0, {0, 1});
  ASSERT_EQ(together->scene.traffic.size(), 1U) << "the other CBV; the ego is no further vehicle";
  EXPECT_TRUE(together->scene.traffic[0].by_same_rules);
  EXPECT_FALSE(situationOf(0, {0})->scene.traffic[0].by_same_rules);
  options_.conditioning = "image";
  EXPECT_FALSE(situationOf(0, {0, 1})->scene.traffic[0].by_same_rules);
}

TEST_F(Situations, ObjectivesKnowTheRouteWhereTheNetworkDoesNot) {
  const auto with = situationOf(0, {0});
  EXPECT_EQ(with->context.route.size(),
            static_cast<std::size_t>(2 * model_.architecture.route_points));
  options_.conditioning = "image";
  const auto without = situationOf(0, {0});
  EXPECT_TRUE(without->context.route.empty());
  for (const auto* situation : {with.get(), without.get()}) {
    EXPECT_EQ(situation->scene.route, &route_);
    EXPECT_NEAR(situation->scene.route_arc_length, 80.0, 1e-9);
    EXPECT_EQ(situation->scene.target_speed, 7.0) << "the lane's limit";
    EXPECT_EQ(situation->context.speed, 5.0);
    EXPECT_EQ(situation->context.image_features, std::vector<float>{0.5F});
  }
}

// The model takes the image of 0.4 s before, which is 8 ticks.
TEST_F(Situations, MotionIsGivenToAModelThatTakesItWithTheRoute) {
  const auto previousOf = [&] { return situationOf(0, {0})->context.previous; };
  model_.architecture = model_.architecture.withMotion();
  EXPECT_EQ(maker().ticksToPrevious(), 8U);
  memories_[1].keepFeatures(0, 8);
  snapshot_.tick = 8;
  EXPECT_EQ(previousOf(), std::vector<float>{0.5F});
  EXPECT_EQ(situationOf(0, {0})->context.target_speed, 8.0) << "as asked, whatever the limit";
  options_.motion = "target_speed";
  EXPECT_TRUE(previousOf().empty());
  options_.motion = "all";
  snapshot_.tick = 10;
  EXPECT_TRUE(previousOf().empty());
  snapshot_.tick = 8;
  options_.conditioning = "image";
  EXPECT_TRUE(previousOf().empty());
  EXPECT_EQ(situationOf(0, {0})->context.target_speed, std::nullopt);
}

TEST_F(Situations, TheLastPlanIsSeenFromHereOneDecisionLaterAndWarmWhereItHolds) {
  traffic::Rollout plan = traffic::Rollout::Zero(32, traffic::kRolloutColumns);
  exact_.rollOut(5.0, plan);
  traffic::VehicleState& now = snapshot_.vehicles[1].state;
  memories_[1].plan.emplace(plan, 2, now, &route_);
  now.position.x() += plan(0, traffic::kRolloutX);
  now.speed = plan(0, traffic::kRolloutSpeed);
  options_.sampler.warm_start = true;
  snapshot_.tick = 4;
  const auto next = situationOf(0, {0});
  ASSERT_TRUE(next->previous);
  EXPECT_NEAR((*next->previous)(0, traffic::kRolloutX),
              plan(1, traffic::kRolloutX) - plan(0, traffic::kRolloutX), 1e-9);
  EXPECT_TRUE(next->warm);
  now.position.y() += 0.6;  // beside the plan
  EXPECT_TRUE(situationOf(0, {0})->previous);
  EXPECT_FALSE(situationOf(0, {0})->warm);
  snapshot_.tick = 6;
  EXPECT_FALSE(situationOf(0, {0})->previous) << "two decisions later";
}

TEST_F(Situations, HasAnObjectivePerCandidate) {
  guidance_.candidates = 3;
  EXPECT_EQ(situationOf(0, {0})->objectives.size(), 3U);
}

}  // namespace
}  // namespace cdiff::planners
