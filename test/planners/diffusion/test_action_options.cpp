// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/throttle_response.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/model_course.h"
#include "planners/registry.h"

namespace cdiff::planners {
namespace {

using dynamics::PedalUse;
using planning::PlannedAction;

/// Plans of the random model, whose throttles are spread over the whole range.
class ActionOptions : public testing::ModelCourse {
 protected:
  /// Of the first decision.
  std::vector<PlannedAction> plansOf(const DiffusionOptions& options) {
    return plansOf(options, 1);
  }
  /// Of so many decisions about the same standing picture, one after the other.
  std::vector<PlannedAction> plansOf(const DiffusionOptions& options, std::uint64_t decisions) {
    const auto planner = makeDiffusion(options);
    std::vector<PlannedAction> plans;
    for (std::uint64_t decision = 0; decision < decisions; ++decision) {
      goTo(2 * decision);
      for (PlannedAction& planned : planner->plan(snapshot_, tasks()))
        plans.push_back(std::move(planned));
    }
    return plans;
  }
  const traffic::VehicleState& startOf(const PlannedAction& planned) const {
    return snapshot_.find(planned.vehicle_id)->state;
  }
};

bool sameActions(const PlannedAction& left, const PlannedAction& right) {
  if (left.rollout.size() != right.rollout.size() || !(left.action == right.action)) return false;
  for (std::size_t row = 0; row < left.rollout.size(); ++row) {
    if (!(left.rollout[row].action == right.rollout[row].action)) return false;
  }
  return true;
}

/// Rows of a plan whose throttle brakes at the speed that the dynamics has there.
std::size_t notches(const PlannedAction& planned, const traffic::VehicleState& start) {
  const dynamics::BicycleModel model;
  double speed = start.speed;
  std::size_t count = 0;
  for (const planning::RolloutPoint& point : planned.rollout) {
    if (pedalUse(model, speed, point.action) == PedalUse::kNotch) ++count;
    for (int tick = 0; tick < 2; ++tick) speed = model.nextSpeed(speed, point.action);
  }
  return count;
}

TEST_F(ActionOptions, TheMonotoneResponseCommandsNoThrottleThatBrakes) {
  // Notches of either branch: without any, nothing would be shown.
  std::size_t found = 0;
  for (const char* branch : {"learned", "exact"}) {
    DiffusionOptions options = optionsOf("real_time", branch);
    for (const PlannedAction& planned : plansOf(options, 20))
      found += notches(planned, startOf(planned));
    options.response = "monotone";
    for (const PlannedAction& planned : plansOf(options, 20)) {
      EXPECT_EQ(planned.fault, "");
      EXPECT_EQ(notches(planned, startOf(planned)), 0U) << branch;
      EXPECT_EQ(planned.action, planned.rollout.front().action);
      // Exact states are those of the commands, up to float32.
      const bool exact = branch == std::string("exact");
      EXPECT_EQ(planned.state_mismatch < 1e-5, exact);
    }
  }
  EXPECT_GT(found, 0U);
}

// The random model's first vehicle drives, the second starts from standstill.
TEST_F(ActionOptions, ExactStatesAreWhereTheirActionsLead) {
  snapshot_.vehicles[2].state.speed = 0.0;
  const dynamics::BicycleModel model;
  double slowest = 5.0;
  for (const PlannedAction& planned : plansOf(optionsOf("real_time", "exact"))) {
    traffic::VehicleState state = startOf(planned);
    for (const planning::RolloutPoint& point : planned.rollout) {
      state = model.step(state, point.action, 0.1);
      EXPECT_LT((point.state.position - state.position).norm(), 1e-4);
      EXPECT_NEAR(point.state.heading, state.heading, 1e-4);
      EXPECT_NEAR(point.state.speed, state.speed, 1e-4);
      slowest = std::min(slowest, state.speed);
    }
  }
  EXPECT_LT(slowest, 0.5);
}

/// With the learned head the response is a matter of execution: planned states and all commands
/// outside the notch stay as they are.
TEST_F(ActionOptions, TheResponseActsAtExecutionAlone) {
  DiffusionOptions options = optionsOf();
  const auto fitted = plansOf(options);
  options.response = "monotone";
  const auto monotone = plansOf(options);
  std::size_t changed = 0;
  for (std::size_t row = 0; row < fitted[0].rollout.size(); ++row) {
    const planning::RolloutPoint& before = fitted[0].rollout[row];
    const planning::RolloutPoint& after = monotone[0].rollout[row];
    EXPECT_EQ(before.state.position, after.state.position);
    EXPECT_EQ(before.state.speed, after.state.speed);
    if (before.action == after.action) continue;
    ++changed;
    EXPECT_GE(before.action.throttle, 0.3);
    EXPECT_EQ(after.action.throttle, 0.0);
    EXPECT_EQ(after.action.steer, before.action.steer);
  }
  EXPECT_GT(changed, 0U);
}

TEST_F(ActionOptions, RouteScaleGoesFromTheImageAloneToTheRoute) {
  DiffusionOptions options = optionsOf();
  options.conditioning = "image_route";
  const auto with_route = plansOf(options);
  options.route_scale = 0.0;
  const auto ignored = plansOf(options);
  options.route_scale = 0.5;
  const auto half = plansOf(options);
  options.route_scale = 1.0;
  options.conditioning = "image";
  const auto image = plansOf(options);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_FALSE(sameActions(with_route[i], image[i]));
    EXPECT_TRUE(sameActions(ignored[i], image[i]));
    EXPECT_FALSE(sameActions(half[i], image[i]));
    EXPECT_FALSE(sameActions(half[i], with_route[i]));
  }
}

TEST_F(ActionOptions, RouteScaleWithoutARouteIsRefused) {
  DiffusionOptions options = optionsOf();
  options.conditioning = "image";
  EXPECT_NO_THROW(options.validate());
  options.route_scale = 0.5;
  EXPECT_THROW(options.validate(), core::InputError);
  EXPECT_THROW(makeDiffusion(options), core::InputError);
}

TEST_F(ActionOptions, AModelOfTheImageAloneDrivesByTheImageAlone) {
  DiffusionOptions options = optionsOf();
  const std::filesystem::path folder = std::filesystem::path(options.model) / "image_alone";
  options.model = cdiff::testing::writeRandomModel(folder, diffusion::Architecture().imageAlone());
  options.conditioning = "image";
  for (const PlannedAction& planned : plansOf(options)) EXPECT_EQ(planned.fault, "");
  for (const char* conditioning : {"image_route", "by_guidance"}) {
    options.conditioning = conditioning;
    try {
      makeDiffusion(options);
      FAIL() << conditioning;
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("takes no route; expected 'image'"),
                std::string::npos)
          << error.what();
    }
  }
  options.conditioning = "image";
  options.motion = "none";
  EXPECT_THROW(makeDiffusion(options), core::InputError);
}

// Weights that were trained with the current state before the trajectory, and those that were not,
// are each refused in the other's place.
TEST_F(ActionOptions, AModelDrivesWithTheCurrentStateThatItWasTrainedWith) {
  DiffusionOptions options = optionsOf();
  const std::filesystem::path folder(options.model);
  const diffusion::Architecture sizes;
  options.conditioning = "image";
  for (const bool pinned : {true, false}) {
    options.model = cdiff::testing::writeRandomModel(folder / (pinned ? "pinned" : "image_alone"),
                                                     pinned ? sizes.pinned() : sizes.imageAlone());
    options.current_state = pinned ? "pinned" : "none";
    for (const PlannedAction& planned : plansOf(options)) EXPECT_EQ(planned.fault, "");
    options.current_state = pinned ? "none" : "pinned";
    try {
      makeDiffusion(options);
      FAIL() << pinned;
    } catch (const core::InputError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("'diffusion.current_state'"), std::string::npos) << text;
      EXPECT_NE(text.find(pinned ? "expected 'pinned'" : "expected 'none'"), std::string::npos)
          << text;
    }
  }
}

// The image of 0.4 s before and the target speed reach a network that takes them, and only where it
// is given its route.
TEST_F(ActionOptions, AModelThatSeesMotionRemembersItsImages) {
  DiffusionOptions options = optionsOf();
  const std::filesystem::path folder = std::filesystem::path(options.model) / "motion";
  options.model = cdiff::testing::writeRandomModel(folder, diffusion::Architecture().withMotion());
  options.sampler.warm_start = false;
  guidance_.candidates = 1;
  /// The plan at tick 8, after decisions from tick `first` on.
  const auto planFrom = [&](std::uint64_t first, double target_speed) {
    const auto planner = makeDiffusion(options);
    std::optional<PlannedAction> last;
    for (std::uint64_t tick = first; tick <= 8; tick += 2) {
      goTo(tick);
      auto asked = tasks();
      asked[0].target_speed = target_speed;
      last = planner->plan(snapshot_, asked)[0];
      EXPECT_EQ(last->fault, "");
    }
    return *last;
  };
  options.sampler.mode = "unguided";  // no objective about the target speed
  options.conditioning = "image_route";
  EXPECT_FALSE(sameActions(planFrom(0, 8.0), planFrom(8, 8.0)));
  EXPECT_TRUE(sameActions(planFrom(2, 8.0), planFrom(8, 8.0))) << "0.3 s is too short";
  EXPECT_FALSE(sameActions(planFrom(8, 8.0), planFrom(8, 5.0)));
  options.motion = "previous_image";
  EXPECT_FALSE(sameActions(planFrom(0, 8.0), planFrom(8, 8.0)));
  EXPECT_TRUE(sameActions(planFrom(8, 8.0), planFrom(8, 5.0)));
  options.motion = "target_speed";
  EXPECT_TRUE(sameActions(planFrom(0, 8.0), planFrom(8, 8.0)));
  EXPECT_FALSE(sameActions(planFrom(8, 8.0), planFrom(8, 5.0)));
  options.motion = "none";
  EXPECT_TRUE(sameActions(planFrom(0, 8.0), planFrom(8, 5.0)));
  options.motion = "all";
  options.conditioning = "image";
  EXPECT_TRUE(sameActions(planFrom(0, 8.0), planFrom(8, 5.0)));
}

TEST_F(ActionOptions, SolverAndLastStepReachThePlan) {
  DiffusionOptions options = optionsOf();
  options.sampler.solver = "ddim";
  options.sampler.clean_up_steps = 0;
  std::vector<PlannedAction> seen = {plansOf(options)[0]};
  options.sampler.solver = "dpmpp_2m";
  seen.push_back(plansOf(options)[0]);
  options.sampler.clean_up_steps = 2;
  seen.push_back(plansOf(options)[0]);
  guidance_.last_step = 8;
  seen.push_back(plansOf(options)[0]);
  EXPECT_TRUE(sameActions(seen.back(), plansOf(options)[0]));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].fault, "");
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(sameActions(seen[i], seen[j])) << i << j;
  }
}

TEST_F(ActionOptions, LastingNoiseMakesPlansOfOnePictureAlike) {
  const DiffusionOptions options = optionsOf();
  guidance_.noise_correlation = 0.0;
  const auto anew = plansOf(options, 2);
  const std::size_t vehicles = anew.size() / 2;
  EXPECT_FALSE(sameActions(anew[0], anew[vehicles]));
  guidance_.noise_correlation = 1.0;
  const auto lasting = plansOf(options, 2);
  EXPECT_TRUE(sameActions(lasting[0], lasting[vehicles]));
  EXPECT_FALSE(sameActions(lasting[0], anew[0]));
}

TEST_F(ActionOptions, RecordsSaySamplerResponseAndRouteScale) {
  planning::PlannerOptionsTable table = defaultOptions();
  const auto facts = [&] { return findPlanner("diffusion")->network(table, guidance_); };
  EXPECT_EQ(facts().sampling,
            "DPM-Solver++(2M) over 12 steps, proximal guidance, 1 sample, one noise a vehicle");
  guidance_.noise_correlation = 0.5;
  EXPECT_EQ(facts().sampling,
            "DPM-Solver++(2M) over 12 steps, proximal guidance, 1 sample, noise correlated by 0.5");
  guidance_.noise_correlation = 0.0;
  EXPECT_EQ(facts().conditioning, "image_route");
  auto& options = table.of<DiffusionOptions>();
  options.sampler.solver = "ddim";
  options.sampler.clean_up_steps = 0;
  options.response = "monotone";
  options.route_scale = 0.5;
  EXPECT_EQ(facts().sampling, "DDIM over 10 steps, proximal guidance, 1 sample, monotone response");
  EXPECT_EQ(facts().conditioning, "image_route, route scale 0.5");
  options.motion = "target_speed";
  EXPECT_EQ(facts().conditioning, "image_route, motion target_speed, route scale 0.5");
}

}  // namespace
}  // namespace cdiff::planners
