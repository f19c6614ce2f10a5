// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/course.h"
#include "planners/ppo/ppo.h"
#include "planners/ppo/ppo_weights.h"
#include "planners/registry.h"
#include "support/snapshot_builder.h"
#include "support/temporary_folder.h"

namespace cdiff::planners {
namespace {

class PpoTest : public ::testing::Test {
 protected:
  PpoTest() { addCbv("a", {30.0, 10.0, -90.0, 5.0}); }

  void addCbv(const std::string& id, const test::Motion& motion) {
    snapshot_.vehicles.push_back(test::vehicle(id, motion, traffic::VehicleRole::kCbv));
  }
  std::unique_ptr<planning::Planner> make(const map::Route* ego_route,
                                          const std::string& after_goal = "route") const {
    planning::PlannerOptionsTable options = defaultOptions();
    core::overrideOption("ppo.weights=" + folder_.path().string(), "test", options);
    core::overrideOption("ppo.after_goal=" + after_goal, "test", options);
    planning::PlanningContext context{network_, area_};
    context.ego_route = ego_route;
    return makePlanner("ppo", {context, options, dynamics_, camera_, guidance_});
  }
  std::vector<planning::PlanningTask> tasks() const {
    std::vector<planning::PlanningTask> tasks;
    for (const traffic::Vehicle& vehicle : snapshot_.vehicles) {
      if (vehicle.id != "ego")
        tasks.push_back({static_cast<int>(tasks.size()), &vehicle, &cbv_route_});
    }
    return tasks;
  }
  std::string refusal() const {
    try {
      make(&route_);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "made";
  }

  test::TemporaryFolder folder_;
  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 200.0, 0.0)},
                            {"side", testing::straight(30.0, 60.0, 30.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  map::Route cbv_route_ = testing::routeAlong(network_, {"side"});
  traffic::TrafficSnapshot snapshot_ = test::snapshotWithEgo(0, {10.0, 0.0, 0.0, 8.0});
  dynamics::BicycleModelOptions dynamics_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
};

// The mean is (0.5, -0.25) whatever is seen: a = 3 tanh(0.5), steer = 0.3 tanh(-0.25).
TEST_F(PpoTest, DrivesByTanhOfTheMean) {
  test::writePpo(folder_.path(), test::constantPpo(0.5F, -0.25F));
  const auto planned = make(&route_)->plan(snapshot_, tasks());
  ASSERT_EQ(planned.size(), 1U);
  EXPECT_EQ(planned[0].fault, "");
  EXPECT_EQ(planned[0].vehicle_id, "a");
  EXPECT_NEAR(planned[0].action.throttle, std::tanh(0.5), 1e-6);
  EXPECT_NEAR(planned[0].action.steer, -0.3 * std::tanh(0.25), 1e-6);
  EXPECT_EQ(planned[0].action.brake, 0.0);
}

// Unit 0 of the first layer sees the goal's distance d alone, unit 3 of the second 2 x that + 1; a
// second unit that ReLU closes adds nothing. Mean acceleration = 0.01 (2 d + 1); the goal of an ego
// at 10 m is at (16.5, 0), so d = sqrt(13.5^2 + 10^2).
TEST_F(PpoTest, NetworkComputesItsLayers) {
  PpoActor::Weights weights = test::constantPpo(0.0F, 0.0F);
  weights.at("actor.first.weight").values[kPpoGoal * kPpoColumns + 5] = 1.0F;
  weights.at("actor.first.bias").values[1] = -3.0F;
  weights.at("actor.second.weight").values[3 * 256] = 2.0F;
  weights.at("actor.second.weight").values[3 * 256 + 1] = 50.0F;
  weights.at("actor.second.bias").values[3] = 1.0F;
  weights.at("actor.last.weight").values[3] = 0.01F;
  weights.at("actor.log_deviation").values = {0.0F, std::log(0.5F)};
  const PpoActor actor(weights);
  const PpoGoal goal = ppoGoal(route_, 10.0);
  const PpoAction mean =
      actor.mean(ppoObservation(snapshot_, *snapshot_.ego(), *snapshot_.find("a"), goal));
  EXPECT_NEAR(mean[0], 0.01 * (2.0 * std::hypot(13.5, 10.0) + 1.0), 1e-6);
  EXPECT_EQ(mean[1], 0.0F);
  EXPECT_NEAR(actor.deviation()[0], 1.0, 1e-7);
  EXPECT_NEAR(actor.deviation()[1], 0.5, 1e-7);
}

TEST_F(PpoTest, StatesThatAreNotFiniteBrakeWithAFault) {
  test::writePpo(folder_.path(), test::constantPpo(0.5F, 0.0F));
  const auto planner = make(&route_);
  addCbv("b", {30.0, std::numeric_limits<double>::quiet_NaN(), 0.0, 5.0});
  auto planned = planner->plan(snapshot_, tasks());
  EXPECT_EQ(planned[0].fault, "");
  EXPECT_EQ(planned[1].fault, "vehicle 'b': the x of the CBV is not finite; full braking instead");
  EXPECT_EQ(planned[1].action, traffic::ControlAction::failSafe());
  snapshot_.vehicles[0].state.speed = std::numeric_limits<double>::infinity();
  planned = planner->plan(snapshot_, tasks());
  EXPECT_EQ(planned[0].fault, "vehicle 'a': the ego's state is not finite; full braking instead");
  EXPECT_EQ(planned[0].action, traffic::ControlAction::failSafe());
}

TEST_F(PpoTest, WithoutAnEgoOrItsRouteItBrakesWithAFault) {
  test::writePpo(folder_.path(), test::constantPpo(0.5F, 0.0F));
  EXPECT_EQ(make(nullptr)->plan(snapshot_, tasks())[0].fault,
            "vehicle 'a': the ego's route is not known; full braking instead");
  snapshot_.vehicles.erase(snapshot_.vehicles.begin());
  EXPECT_EQ(make(&route_)->plan(snapshot_, tasks())[0].fault,
            "vehicle 'a': there is no ego; full braking instead");
}

// The goal is at (16.5, 0). A CBV 3 m before it has reached it: from then on PDM-Lite drives along
// the CBV's route, also where the goal has moved away; with after_goal "goal" the network goes on.
TEST_F(PpoTest, DrivesOnAlongItsRouteOnceTheGoalIsReached) {
  test::writePpo(folder_.path(), test::constantPpo(0.5F, 0.25F));
  snapshot_.vehicles[1].state.position = {16.5, 3.0};
  const auto on_route = make(&route_);
  const auto on_goal = make(&route_, "goal");
  const traffic::ControlAction network = ppoCommand({std::tanh(0.5F), std::tanh(0.25F)});
  EXPECT_FALSE(on_route->plan(snapshot_, tasks())[0].action == network);
  EXPECT_EQ(on_goal->plan(snapshot_, tasks())[0].action, network);
  snapshot_.vehicles[0].state.position.x() = 40.0;
  const planning::PlannedAction planned = on_route->plan(snapshot_, tasks())[0];
  EXPECT_FALSE(planned.action == network);
  EXPECT_EQ(planned.fault, "");
}

// Given back to the traffic for a decision and selected again, it is far from the goal: the network
// drives it.
TEST_F(PpoTest, WhoIsSelectedAgainHasAGoalAgain) {
  test::writePpo(folder_.path(), test::constantPpo(0.5F, 0.25F));
  addCbv("b", {30.0, 40.0, -90.0, 5.0});
  snapshot_.vehicles[1].state.position = {16.5, 3.0};
  const auto planner = make(&route_);
  const traffic::ControlAction network = ppoCommand({std::tanh(0.5F), std::tanh(0.25F)});
  EXPECT_FALSE(planner->plan(snapshot_, tasks())[0].action == network);
  planner->plan(snapshot_, {tasks()[1]});
  snapshot_.vehicles[1].state.position = {30.0, 20.0};
  EXPECT_EQ(planner->plan(snapshot_, tasks())[0].action, network);
}

TEST_F(PpoTest, SameSnapshotsSameActions) {
  PpoActor::Weights weights = test::constantPpo(0.1F, 0.2F);
  for (auto& [name, tensor] : weights) {
    const core::RandomStream random(7, name);
    for (std::size_t i = 0; i < tensor.values.size(); ++i)
      tensor.values[i] =
          static_cast<float>(random.uniform({}, static_cast<std::uint32_t>(i), -0.1, 0.1));
  }
  test::writePpo(folder_.path(), weights);
  const auto first = make(&route_);
  const auto second = make(&route_);
  for (int i = 0; i < 20; ++i) {
    snapshot_.tick += 2;
    snapshot_.vehicles[0].state.position.x() += 0.8;
    snapshot_.vehicles[1].state.position.y() -= 0.1;
    EXPECT_EQ(first->plan(snapshot_, tasks())[0].action,
              second->plan(snapshot_, tasks())[0].action);
  }
}

TEST_F(PpoTest, WeightsThatAreMissingOrOfAnotherPlannerAreRefused) {
  const std::string folder = folder_.path().string();
  EXPECT_EQ(refusal(), "planner 'ppo' has no weights: there is no file '" + folder +
                           "/ppo.safetensors'; train them with cdiff train --task ppo --suite "
                           "FOLDER --output " +
                           folder + ", or name a folder that holds them (ppo.weights)");
  test::writePpo(folder_.path(), test::constantPpo(0.0F, 0.0F), "e2e_cdiff.plant.1");
  EXPECT_EQ(refusal(),
            "weight file '" + folder +
                "/ppo.safetensors': its format is 'e2e_cdiff.plant.1', not 'e2e_cdiff.ppo.1': "
                "these are not weights of this version's planner 'ppo'; train them with cdiff "
                "train --task ppo --suite FOLDER");
  PpoActor::Weights weights = test::constantPpo(0.0F, 0.0F);
  weights.at("actor.last.bias") = {{3}, {0.0F, 0.0F, 0.0F}};
  test::writePpo(folder_.path(), weights);
  EXPECT_NE(refusal().find("tensor 'actor.last.bias' has shape"), std::string::npos) << refusal();
}

TEST(PpoDescriptor, DrivesCbvsOnlyAndSeesNoImages) {
  const planning::PlannerDescriptor* descriptor = findPlanner("ppo");
  ASSERT_NE(descriptor, nullptr);
  EXPECT_FALSE(descriptor->drives_ego);
  EXPECT_TRUE(descriptor->drives_cbv);
  EXPECT_FALSE(seesImages("ppo"));
  EXPECT_FALSE(canBeGuided("ppo"));
}

}  // namespace
}  // namespace cdiff::planners
