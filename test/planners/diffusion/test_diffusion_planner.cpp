// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/model_course.h"

namespace cdiff::planners {
namespace {

class DiffusionPlannerTest : public testing::ModelCourse {
 protected:
  DiffusionPlanner makePlanner() const { return {optionsOf(), guidance_, {}, context_}; }
  static map::RoadNetwork makeTurn() {
    return testing::makeNetwork(
        {{"turn", {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {10.0, 100.0, 0.0}}}});
  }
};

TEST_F(DiffusionPlannerTest, PlansAWholeRolloutForEveryVehicle) {
  DiffusionPlanner planner = makePlanner();
  const auto actions = planner.plan(snapshot_, tasks());
  ASSERT_EQ(actions.size(), 2U);
  for (const planning::PlannedAction& planned : actions) {
    EXPECT_EQ(planned.fault, "");
    EXPECT_TRUE(planned.action.valid());
    ASSERT_EQ(planned.rollout.size(), 32U);
    EXPECT_EQ(planned.rollout.front().action, planned.action);
    ASSERT_EQ(planned.guidance.objectives.size(), 6U);
    // The random state head knows nothing of the dynamics: its places are meters off.
    EXPECT_GT(planned.state_mismatch, 0.1);
  }
  EXPECT_FALSE(actions[0].action == actions[1].action);
}

TEST_F(DiffusionPlannerTest, SameCallsSameActionsAndEachVehicleAlone) {
  DiffusionPlanner first = makePlanner();
  DiffusionPlanner second = makePlanner();
  DiffusionPlanner alone = makePlanner();
  for (const std::uint64_t tick : {0U, 2U, 4U}) {
    goTo(tick);
    const auto one = first.plan(snapshot_, tasks());
    const auto two = second.plan(snapshot_, tasks());
    const auto single = alone.plan(snapshot_, {tasks()[1]});
    EXPECT_EQ(one[0].action, two[0].action);
    EXPECT_EQ(one[1].action, two[1].action);
    EXPECT_EQ(one[1].action, single[0].action);
  }
}

TEST_F(DiffusionPlannerTest, ManyVehiclesPlanAsEachAloneOnAnyNumberOfThreads) {
  constexpr int kMany = 20;  // more than the planner samples together
  for (int slot = 2; slot < kMany; ++slot) {
    const double x = 50.0 + 10.0 * slot;
    snapshot_.vehicles.push_back(
        testing::vehicleAt("cbv" + std::to_string(slot), x, 0.0, 0.0, 5.0));
    snapshot_.vehicles.back().role = traffic::VehicleRole::kCbv;
    snapshot_.vehicles.back().cbv_slot = slot;
  }
  goTo(2);
  std::vector<planning::PlanningTask> many;
  for (int slot = 0; slot < kMany; ++slot) {
    const auto index = static_cast<std::size_t>(slot);
    many.push_back({slot, &snapshot_.vehicles[index + 1], &route_, 8.0,
                    test::frontViews(&images_[index % 2])});
  }
  DiffusionOptions three_threads = optionsOf();
  three_threads.threads = 3;
  const auto one = makePlanner().plan(snapshot_, many);
  const auto three = makeDiffusion(three_threads)->plan(snapshot_, many);
  DiffusionPlanner alone = makePlanner();  // forgets whoever is not in the call
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(one[i].action, three[i].action) << "slot " << i;
    EXPECT_EQ(one[i].action, alone.plan(snapshot_, {many[i]})[0].action) << "slot " << i;
  }
}

TEST_F(DiffusionPlannerTest, FollowsOtherGuidanceAsIfMadeWithIt) {
  DiffusionPlanner steered = makePlanner();
  const auto unsteered = makePlanner().plan(snapshot_, tasks());
  guidance_ = guidance::loadProfile("safety_critical");
  const auto expected = makePlanner().plan(snapshot_, tasks());
  steered.setGuidance(guidance_);
  const auto actions = steered.plan(snapshot_, tasks());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(actions[i].action, expected[i].action);
    EXPECT_FALSE(actions[i].action == unsteered[i].action);
    EXPECT_EQ(actions[i].guidance.candidates, guidance_.candidates);
  }
}

TEST_F(DiffusionPlannerTest, KeepsItsGuidanceWhereItCannotFollow) {
  DiffusionPlanner planner = makePlanner();
  DiffusionPlanner untouched = makePlanner();
  guidance::GuidanceOptions bad = guidance_;
  bad.find("speed").weight = 1.0;
  bad.find("speed").first_step = 9999;
  EXPECT_THROW(planner.setGuidance(bad), core::InputError);
  EXPECT_EQ(planner.plan(snapshot_, tasks())[0].action,
            untouched.plan(snapshot_, tasks())[0].action);
}

TEST_F(DiffusionPlannerTest, AnotherSeedAnotherPlan) {
  DiffusionPlanner first = makePlanner();
  context_.seed = 2;
  DiffusionPlanner second = makePlanner();
  EXPECT_FALSE(first.plan(snapshot_, tasks())[0].action ==
               second.plan(snapshot_, tasks())[0].action);
}

TEST_F(DiffusionPlannerTest, BadInputBrakesThatVehicleAlone) {
  struct Case {
    std::string text;
    std::function<void(std::vector<planning::PlanningTask>&)> spoil;
  };
  traffic::CameraImage wrong_size = images_[0];
  wrong_size.width = 80;
  traffic::CameraImage short_bytes = images_[0];
  short_bytes.rgb.pop_back();
  traffic::CameraImage old = images_[0];
  old.tick = 9;
  traffic::Vehicle lost = snapshot_.vehicles[1];
  lost.state.speed = std::numeric_limits<double>::quiet_NaN();
  const map::Route no_route;
  const std::vector<Case> cases = {
      {"no image came", [](auto& tasks) { tasks[0].views = test::frontViews(nullptr); }},
      {"the image is 80 x 96",
       [&](auto& tasks) { tasks[0].views = test::frontViews(&wrong_size); }},
      {"46079 bytes", [&](auto& tasks) { tasks[0].views = test::frontViews(&short_bytes); }},
      {"of tick 9; expected tick 0", [&](auto& tasks) { tasks[0].views = test::frontViews(&old); }},
      {"state is not finite", [&](auto& tasks) { tasks[0].vehicle = &lost; }},
      {"no route", [&](auto& tasks) { tasks[0].route = &no_route; }},
      {"no route", [](auto& tasks) { tasks[0].route = nullptr; }},
  };
  DiffusionPlanner good = makePlanner();
  const auto expected = good.plan(snapshot_, tasks())[1].action;
  for (const Case& bad : cases) {
    DiffusionPlanner planner = makePlanner();
    std::vector<planning::PlanningTask> spoilt = tasks();
    bad.spoil(spoilt);
    const auto actions = planner.plan(snapshot_, spoilt);
    EXPECT_EQ(actions[0].action, traffic::ControlAction::failSafe());
    EXPECT_NE(actions[0].fault.find(bad.text), std::string::npos) << actions[0].fault;
    EXPECT_EQ(actions[1].action, expected) << bad.text;
  }
}

TEST_F(DiffusionPlannerTest, FrozenImageIsAFaultOnlyWhileMoving) {
  DiffusionPlanner planner = makePlanner();
  for (std::uint64_t tick = 0; tick <= 20; tick += 2) {
    goTo(tick);
    for (traffic::Vehicle& vehicle : snapshot_.vehicles) {
      if (vehicle.cbv_slot == 0) vehicle.state.position.x() += 0.5;
    }
    const auto actions = planner.plan(snapshot_, tasks());
    // 1 s is 20 ticks; slot 0 has then moved 5 m with one and the same image, slot 1 stands.
    EXPECT_EQ(actions[0].fault.find("has not changed") != std::string::npos, tick >= 20) << tick;
    EXPECT_EQ(actions[1].fault, "");
  }
}

TEST_F(DiffusionPlannerTest, SkyAndGroundAloneMayStayAsTheyAreButOneColorMayNot) {
  for (const bool horizon : {true, false}) {
    std::vector<std::uint8_t>& rgb = images_[0].rgb;
    std::fill(rgb.begin(), rgb.end(), std::uint8_t{90});
    if (horizon) std::fill_n(rgb.begin(), rgb.size() / 2, std::uint8_t{200});
    DiffusionPlanner planner = makePlanner();
    std::string fault;
    for (std::uint64_t tick = 0; tick <= 20; tick += 2) {
      goTo(tick);
      for (traffic::Vehicle& vehicle : snapshot_.vehicles) vehicle.state.position.x() += 0.5;
      fault = planner.plan(snapshot_, tasks())[0].fault;
    }
    EXPECT_EQ(fault.empty(), horizon) << fault;
  }
}

TEST_F(DiffusionPlannerTest, ImageConditioningNeedsNoRoute) {
  DiffusionOptions options = optionsOf();
  options.conditioning = "image";
  DiffusionPlanner planner(options, guidance_, {}, context_);
  std::vector<planning::PlanningTask> without = tasks();
  without[0].route = nullptr;
  EXPECT_EQ(planner.plan(snapshot_, without)[0].fault, "");
}

double reported(const planning::PlannedAction& planned, const std::string& objective) {
  for (const guidance::ObjectiveReport& report : planned.guidance.objectives) {
    if (report.name == objective) return report.value;
  }
  ADD_FAILURE() << "no objective " << objective;
  return 0.0;
}

// The ego's route goes east for 10 m, then north; the CBV's goes on eastward. At 5 m/s the ego is
// 0.5 m farther along its own route at each row of the plan.
TEST_F(DiffusionPlannerTest, ExpectsTheEgoOnTheEgosRouteNotOnTheCbvs) {
  const map::RoadNetwork turning = makeTurn();
  const map::Route ego_route = testing::routeAlong(turning, {"turn"});
  context_.ego_route = &ego_route;
  DiffusionPlanner planner = makePlanner();
  const planning::PlannedAction planned = planner.plan(snapshot_, tasks())[0];
  ASSERT_EQ(planned.fault, "");
  const traffic::Vehicle& cbv = snapshot_.vehicles[1];
  guidance::OtherMotion ego{
      snapshot_.vehicles[0].state, snapshot_.vehicles[0].dimensions, {}, false};
  traffic::Rollout places = traffic::Rollout::Zero(32, traffic::kRolloutColumns);
  for (Eigen::Index row = 0; row < 32; ++row) {
    const double s = 0.5 * static_cast<double>(row + 1);
    ego.predicted.push_back(ego.now);
    ego.predicted.back().position =
        s < 10.0 ? Eigen::Vector2d(s, 0.0) : Eigen::Vector2d(10.0, s - 10.0);
    const auto& state = planned.rollout[static_cast<std::size_t>(row)].state;
    places.row(row).head<2>() = cbv.state.pose().toBody(state.position).transpose();
  }
  guidance::GuidanceScene scene;
  scene.state = cbv.state;
  scene.dimensions = cbv.dimensions;
  scene.other = &ego;
  for (const guidance::WeightedObjective& entry : guidance_.objectives) {
    if (entry.name != "collision_avoidance") continue;
    traffic::Rollout unused = places;
    EXPECT_NEAR(reported(planned, entry.name), entry.objective->evaluate(scene, places, unused),
                1e-6);
  }
}

// The second CBV, 12 m ahead, brakes fully and has not slowed yet: by its pedals it would stand
// after a second, along its route it goes on. Only with its own task does this planner drive it.
TEST_F(DiffusionPlannerTest, ForecastsTheVehiclesThatItDrivesAlongTheirRoutes) {
  guidance_ = guidance::loadProfile("none");
  guidance_.find("yielding").weight = 10.0;
  traffic::Vehicle& second = snapshot_.vehicles[2];
  second.state.position.x() = snapshot_.vehicles[1].state.position.x() + 12.0;
  second.applied_action = traffic::ControlAction{0.0, 0.0, 1.0};
  const auto firstOf = [&](const std::vector<planning::PlanningTask>& driven) {
    return makePlanner().plan(snapshot_, driven)[0].rollout.back().state.position;
  };
  const Eigen::Vector2d together = firstOf(tasks());
  const Eigen::Vector2d alone = firstOf({tasks()[0]});
  EXPECT_GT((together - alone).norm(), 1e-3);
  second.applied_action.reset();
  EXPECT_LT((firstOf(tasks()) - firstOf({tasks()[0]})).norm(), 1e-3);
}

// v* = 8 m/s on a lane with a limit of 5 m/s: J_speed = sum over the rows of (v - 5)^2.
TEST_F(DiffusionPlannerTest, AimsAtTheLanesLimitWhereItIsLowerThanTheTarget) {
  const map::RoadNetwork slow =
      testing::makeNetwork({{"road", testing::straight(-50, 0, 250, 0), 5.0}});
  const map::Route route = testing::routeAlong(slow, {"road"});
  DiffusionPlanner planner(optionsOf("real_time", "exact"), guidance_, {}, context_);
  std::vector<planning::PlanningTask> limited = tasks();
  limited[0].route = &route;
  const auto planned = planner.plan(snapshot_, limited);
  const double limits[] = {5.0, 8.0};  // the other CBV's lane allows 13.89 m/s
  for (std::size_t i = 0; i < 2; ++i) {
    double sum = 0.0;
    for (const planning::RolloutPoint& point : planned[i].rollout)
      sum += std::pow(point.state.speed - limits[i], 2);
    EXPECT_NEAR(reported(planned[i], "speed"), sum, 1e-4 * sum) << i;
  }
}

TEST_F(DiffusionPlannerTest, UnknownModelNamesWhatIsThere) {
  DiffusionOptions options;
  options.model = "no_such_model";
  EXPECT_THROW(DiffusionPlanner(options, guidance_, {}, context_), core::InputError);
}

}  // namespace
}  // namespace cdiff::planners
