// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "course.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/planning/diffusion_planner.h"
#include "support/random_model.h"

namespace cdiff::planning {
namespace {

/// A straight road with an ego at the origin and two CBVs ahead; the model is random.
class DiffusionPlannerTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() /
              ("cdiff_random_model_" + std::to_string(::getpid()));
    cdiff::testing::writeRandomModel(folder_);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  DiffusionPlannerTest() {
    for (const double x : {0.0, 30.0, 60.0}) {
      traffic::Vehicle vehicle;
      vehicle.id = x == 0.0 ? "ego" : "cbv" + std::to_string(static_cast<int>(x));
      vehicle.role = x == 0.0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
      vehicle.cbv_slot = x == 0.0 ? -1 : static_cast<int>(x / 30.0) - 1;
      vehicle.state.position = {x, 0.0};
      vehicle.state.speed = 5.0;
      snapshot_.vehicles.push_back(vehicle);
    }
    for (int i = 0; i < 2; ++i) images_.push_back(image(static_cast<std::uint8_t>(40 * i)));
  }

  traffic::CameraImage image(std::uint8_t shade) const {
    traffic::CameraImage image;
    image.width = 160;
    image.height = 96;
    for (int i = 0; i < 160 * 96 * 3; ++i)
      image.rgb.push_back(static_cast<std::uint8_t>(shade + i % 97));
    return image;
  }

  std::vector<PlanningTask> tasks() {
    std::vector<PlanningTask> tasks;
    for (int slot = 0; slot < 2; ++slot) {
      const auto i = static_cast<std::size_t>(slot);
      tasks.push_back({slot, &snapshot_.vehicles[i + 1], &route_, 8.0, &images_[i]});
    }
    return tasks;
  }

  DiffusionPlanner makePlanner(const std::string& mode = "real_time") const {
    DiffusionOptions options;
    options.model = folder_.string();
    options.sampler.mode = mode;
    return {options, guidance_, {}, context_};
  }

  void goTo(std::uint64_t tick) {
    snapshot_.tick = tick;
    for (traffic::CameraImage& image : images_) image.tick = tick;
  }

  inline static std::filesystem::path folder_;
  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(-50.0, 0.0, 250.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  PlanningContext context_{network_, area_};
  guidance::GuidanceOptions guidance_ = guidance::loadProfile("naturalistic");
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::CameraImage> images_;
};

TEST_F(DiffusionPlannerTest, PlansAWholeRolloutForEveryVehicle) {
  DiffusionPlanner planner = makePlanner();
  const auto actions = planner.plan(snapshot_, tasks());
  ASSERT_EQ(actions.size(), 2U);
  for (const PlannedAction& planned : actions) {
    EXPECT_EQ(planned.fault, "");
    EXPECT_TRUE(planned.action.valid());
    ASSERT_EQ(planned.rollout.size(), 32U);
    EXPECT_EQ(planned.rollout.front().action, planned.action);
    ASSERT_EQ(planned.guidance.objectives.size(), 4U);
    EXPECT_GE(planned.state_mismatch, 0.0);
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
    std::function<void(std::vector<PlanningTask>&)> spoil;
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
      {"no image came", [](auto& tasks) { tasks[0].image = nullptr; }},
      {"the image is 80 x 96", [&](auto& tasks) { tasks[0].image = &wrong_size; }},
      {"46079 bytes", [&](auto& tasks) { tasks[0].image = &short_bytes; }},
      {"of tick 9; expected tick 0", [&](auto& tasks) { tasks[0].image = &old; }},
      {"state is not finite", [&](auto& tasks) { tasks[0].vehicle = &lost; }},
      {"no route", [&](auto& tasks) { tasks[0].route = &no_route; }},
      {"no route", [](auto& tasks) { tasks[0].route = nullptr; }},
  };
  DiffusionPlanner good = makePlanner();
  const auto expected = good.plan(snapshot_, tasks())[1].action;
  for (const Case& bad : cases) {
    DiffusionPlanner planner = makePlanner();
    std::vector<PlanningTask> spoilt = tasks();
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

TEST_F(DiffusionPlannerTest, ImageConditioningNeedsNoRoute) {
  DiffusionOptions options;
  options.model = folder_.string();
  options.conditioning = "image";
  DiffusionPlanner planner(options, guidance_, {}, context_);
  std::vector<PlanningTask> without = tasks();
  without[0].route = nullptr;
  EXPECT_EQ(planner.plan(snapshot_, without)[0].fault, "");
}

TEST_F(DiffusionPlannerTest, UnknownModelNamesWhatIsThere) {
  DiffusionOptions options;
  options.model = "no_such_model";
  EXPECT_THROW(DiffusionPlanner(options, guidance_, {}, context_), core::InputError);
}

}  // namespace
}  // namespace cdiff::planning
