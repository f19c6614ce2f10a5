// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/model_course.h"
#include "planners/two_stage_pid/two_stage_pid.h"

namespace cdiff::planners {
namespace {

class TwoStagePidTest : public testing::ModelCourse {
 protected:
  std::unique_ptr<DiffusionPlanner> makeDiffusion() const {
    return ModelCourse::makeDiffusion(optionsOf());
  }
  TwoStagePid makePlanner() const { return {makeDiffusion(), {}}; }

  /// What a tracker of its own answers to a plan.
  template <class Tracker>
  static traffic::ControlAction tracked(Tracker& tracker, const traffic::Vehicle& vehicle,
                                        const planning::PlannedAction& plan) {
    Eigen::MatrixX2d places(static_cast<Eigen::Index>(plan.rollout.size()), 2);
    for (Eigen::Index row = 0; row < places.rows(); ++row) {
      const auto i = static_cast<std::size_t>(row);
      places.row(row) = vehicle.state.pose().toBody(plan.rollout[i].state.position).transpose();
    }
    return tracker.track(vehicle.state.speed, places);
  }
};

TEST_F(TwoStagePidTest, TracksThePlanOfTheDiffusionPlannerVehicleByVehicle) {
  TwoStagePid planner = makePlanner();
  const auto diffusion = makeDiffusion();
  planning::PlanTracker trackers[2];
  for (const std::uint64_t tick : {0U, 2U, 4U}) {
    goTo(tick);
    const auto actions = planner.plan(snapshot_, tasks());
    const auto plans = diffusion->plan(snapshot_, tasks());
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(actions[i].fault, "");
      EXPECT_TRUE(actions[i].action.valid());
      EXPECT_EQ(actions[i].action, tracked(trackers[i], snapshot_.vehicles[i + 1], plans[i]));
      EXPECT_EQ(actions[i].state_mismatch, plans[i].state_mismatch);
      EXPECT_GT(actions[i].state_mismatch, 0.0);
      EXPECT_EQ(actions[i].guidance.objectives.size(), 6U);
      ASSERT_EQ(actions[i].rollout.size(), 32U);
      for (std::size_t k = 0; k < 32; ++k) {
        EXPECT_EQ(actions[i].rollout[k].state.position, plans[i].rollout[k].state.position);
        EXPECT_EQ(actions[i].rollout[k].action, plans[i].rollout[k].action);
      }
    }
  }
}

TEST_F(TwoStagePidTest, FollowsTheGuidanceThatItIsGiven) {
  goTo(0);
  TwoStagePid steered = makePlanner();
  const auto unsteered = makePlanner().plan(snapshot_, tasks());
  guidance_ = guidance::loadProfile("safety_critical");
  const auto expected = makePlanner().plan(snapshot_, tasks());
  steered.setGuidance(guidance_);
  const auto actions = steered.plan(snapshot_, tasks());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(actions[i].action, expected[i].action);
    EXPECT_EQ(actions[i].rollout[9].state.position, expected[i].rollout[9].state.position);
    EXPECT_FALSE(actions[i].rollout[9].state.position == unsteered[i].rollout[9].state.position);
  }
}

/// Plans of 5.1 m/s and slightly to the left for vehicles of 5 m/s: the normalizer's mean, from
/// which the random model moves by millimeters. So the tracker's pedals stay within their range,
/// and what it remembers shows.
std::string writeSmoothModel(const std::filesystem::path& folder) {
  diffusion::Model model = cdiff::testing::randomModel();
  model.normalizer.scale.setConstant(0.001);
  for (Eigen::Index row = 0; row < model.normalizer.mean.rows(); ++row) {
    const double x = 0.51 * static_cast<double>(row + 1);
    model.normalizer.mean.row(row) << x, 0.05 * x, 0.0, 5.1, 0.5, 0.0, 0.0;
  }
  diffusion::saveModel(model, folder, inference::TensorType::kF16, {});
  return folder.string();
}

// An error e of the speed gives 5 e + 0.5 e / 20 + 1 e at first, and 5 e + 0.5 (2 e) / 20 when it
// is the same again: 0.6025 and 0.505 for 0.1 m/s.
TEST_F(TwoStagePidTest, RemembersTheErrorsOfEveryVehicle) {
  const test::TemporaryFolder folder;
  DiffusionOptions options = optionsOf();
  options.model = writeSmoothModel(folder.path());
  TwoStagePid planner(ModelCourse::makeDiffusion(options), {});
  const auto diffusion = ModelCourse::makeDiffusion(options);
  planning::PlanTracker trackers[2];
  for (const std::uint64_t tick : {0U, 2U, 4U}) {
    goTo(tick);
    const auto actions = planner.plan(snapshot_, tasks());
    const auto plans = diffusion->plan(snapshot_, tasks());
    for (std::size_t i = 0; i < 2; ++i) {
      const traffic::Vehicle& vehicle = snapshot_.vehicles[i + 1];
      EXPECT_EQ(actions[i].action, tracked(trackers[i], vehicle, plans[i]));
      EXPECT_NEAR(actions[i].action.throttle, tick == 0 ? 0.6025 : 0.505, 0.1);
      planning::PlanTracker fresh;
      const traffic::ControlAction without = tracked(fresh, vehicle, plans[i]);
      EXPECT_EQ(actions[i].action == without, tick == 0) << tick;
    }
  }
}

TEST_F(TwoStagePidTest, SameCallsSameActionsAndEachVehicleAlone) {
  TwoStagePid first = makePlanner();
  TwoStagePid second = makePlanner();
  TwoStagePid alone = makePlanner();
  for (const std::uint64_t tick : {0U, 2U, 4U}) {
    goTo(tick);
    const auto one = first.plan(snapshot_, tasks());
    const auto two = second.plan(snapshot_, tasks());
    EXPECT_EQ(one[0].action, two[0].action);
    EXPECT_EQ(one[1].action, two[1].action);
    EXPECT_EQ(one[1].action, alone.plan(snapshot_, {tasks()[1]})[0].action);
  }
}

TEST_F(TwoStagePidTest, PdmLiteTracksIfAsked) {
  TwoStagePidOptions options;
  core::overrideOption("tracker=pdm_lite", "test", options);
  TwoStagePid planner(makeDiffusion(), options);
  const auto diffusion = makeDiffusion();
  goTo(0);
  const auto actions = planner.plan(snapshot_, tasks());
  const auto plans = diffusion->plan(snapshot_, tasks());
  for (std::size_t i = 0; i < 2; ++i) {
    PdmLiteTracker tracker(options.speed_horizon);
    EXPECT_EQ(actions[i].action, tracked(tracker, snapshot_.vehicles[i + 1], plans[i]));
  }
}

// Its constants are PDM-Lite's own; the speed horizon alone is a key of both.
TEST_F(TwoStagePidTest, KeysThatPdmLiteDoesNotHaveAreAnError) {
  TwoStagePidOptions options;
  core::loadOptions({"s.yaml", "tracker: pdm_lite\nspeed_horizon: 2\n"}, options);
  EXPECT_NO_THROW(options.validate());
  core::overrideOption("turn_kp=9", "test", options);
  try {
    options.validate();
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no key turn_kp;"), std::string::npos) << error.what();
  }
  core::overrideOption("tracker=published", "test", options);
  EXPECT_NO_THROW(options.validate());
  EXPECT_EQ(options.pids.turn.kp, 1.25);
}

TEST_F(TwoStagePidTest, FaultBrakesThatVehicleAloneAndItsTrackerStartsAnew) {
  TwoStagePid planner = makePlanner();
  const auto diffusion = makeDiffusion();
  planning::PlanTracker tracker;
  for (const std::uint64_t tick : {0U, 2U, 4U}) {
    goTo(tick);
    std::vector<planning::PlanningTask> asked = tasks();
    traffic::CameraImage wrong_size = images_[0];
    wrong_size.width = 80;
    if (tick == 2) asked[0].views = test::frontViews(&wrong_size);
    const auto actions = planner.plan(snapshot_, asked);
    const auto plans = diffusion->plan(snapshot_, asked);
    EXPECT_EQ(actions[1].action, tracked(tracker, snapshot_.vehicles[2], plans[1]));
    if (tick == 2) {
      EXPECT_EQ(actions[0].action, traffic::ControlAction::failSafe());
      EXPECT_NE(actions[0].fault.find("the image is 80 x 96"), std::string::npos);
    } else {
      planning::PlanTracker fresh;
      EXPECT_EQ(actions[0].action, tracked(fresh, snapshot_.vehicles[1], plans[0])) << tick;
    }
  }
}

}  // namespace
}  // namespace cdiff::planners
