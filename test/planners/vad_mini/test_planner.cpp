// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/camera_course.h"
#include "planners/vad_mini/vad_mini.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

/// A small network; the cameras are the real ones.
VadMiniArchitecture smallSizes() {
  VadMiniArchitecture architecture;
  architecture.ego.width = 32;
  architecture.ego.heads = 2;
  architecture.ego.hidden = 32;
  architecture.ego.bev_layers = 1;
  architecture.ego.bev.rows = 20;
  architecture.ego.bev.columns = 10;
  architecture.ego.bev.cell = 3.0;
  architecture.decoder_layers = 1;
  return architecture;
}

class VadMiniCourse : public testing::CameraCourse {
 protected:
  static VadMiniModel model() {
    return {smallSizes(), cdiff::testing::randomTensors(vadMiniTensors(smallSizes()))};
  }
  VadMiniPlanner planner() const { return {VadMiniOptions{}, model(), parts()}; }
  std::string refusal(const std::string& assignment, const rendering::RigOptions& rig = {}) const {
    return refusalOf("vad_mini", assignment, rig);
  }
  std::string weights(const char* format) const {
    return weightsOf(kVadMini, networkMetadata(kVadMini, smallSizes()), model().weights, format);
  }
};

TEST_F(VadMiniCourse, PlansThreeSecondsAndSaysWhatItSees) {
  VadMiniOptions options;
  options.least_score = 0.0;
  VadMiniPlanner planner(options, model(), parts());
  const planning::PlannedAction planned = planOf(planner, task());
  EXPECT_EQ(planned.fault, "");
  EXPECT_TRUE(planned.action.valid());
  EXPECT_EQ(planned.rollout.size(), 30U);
  ASSERT_EQ(planned.perception.vehicles.size(), 24U);
  EXPECT_EQ(planned.perception.lines.size(), 16U);
  EXPECT_EQ(planned.perception.vehicles[0].forecasts.size(), 6U);
  EXPECT_EQ(planned.perception.vehicles[0].forecasts[0].places.size(), 6U);
  const Eigen::Vector2d place =
      snapshot_.vehicles[0].state.pose().toBody(planned.perception.vehicles[0].state.position);
  EXPECT_TRUE(smallSizes().ego.bev.contains(place)) << "in the map frame";
}

TEST_F(VadMiniCourse, TheSameDecisionsGiveTheSameActions) {
  VadMiniPlanner first = planner(), second = planner();
  for (std::uint64_t tick = 0; tick < 20; tick += 2) {
    goTo(tick);
    const auto one = planOf(first, task()), other = planOf(second, task());
    EXPECT_EQ(one.action, other.action) << tick;
    EXPECT_EQ(one.fault, "") << tick;
  }
}

// At tick 22 both look back to tick 12, when one of them had looked back to tick 2.
TEST_F(VadMiniCourse, WhatItLooksBackToKnowsNoPastOfItsOwn) {
  VadMiniOptions options;
  options.least_score = 0.0;
  VadMiniPlanner early(options, model(), parts()), late(options, model(), parts());
  planning::PlannedAction one, other;
  for (std::uint64_t tick = 0; tick <= 22; tick += 2) {
    goTo(tick);
    one = planOf(early, task());
    if (tick >= 10) other = planOf(late, task());
    if (tick == 16) {
      EXPECT_NE(one.perception.vehicles[0].state.position,
                other.perception.vehicles[0].state.position)
          << "the late one has no past yet";
    }
  }
  ASSERT_EQ(one.fault + other.fault, "");
  for (std::size_t i = 0; i < one.perception.vehicles.size(); ++i)
    EXPECT_EQ(one.perception.vehicles[i].state.position,
              other.perception.vehicles[i].state.position);
}

TEST_F(VadMiniCourse, BadImagesAreFaultsThatNameTheCamera) {
  VadMiniPlanner vad = planner();
  const auto faultOf = [&](const planning::PlanningTask& bad) {
    const planning::PlannedAction planned = planOf(vad, bad);
    EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
    return planned.fault;
  };
  planning::PlanningTask missing = task();
  missing.views.images[1] = nullptr;
  EXPECT_NE(faultOf(missing).find("camera 'front_left': no image came for tick 0"),
            std::string::npos);
  traffic::CameraImage small = image(2);
  small.width = 80;
  planning::PlanningTask other_size = task();
  other_size.views.images[2] = &small;
  EXPECT_NE(faultOf(other_size).find("camera 'front_right': the image is 80 x 96"),
            std::string::npos);
  planning::PlanningTask late = task();
  traffic::CameraImage old = image(0);
  old.tick = 7;
  late.views.images[0] = &old;
  EXPECT_NE(faultOf(late).find("camera 'front': the image is of tick 7; expected tick 0"),
            std::string::npos);
  planning::PlanningTask lost = task();
  lost.route = nullptr;
  EXPECT_NE(faultOf(lost).find("it has no route"), std::string::npos);
  EXPECT_EQ(planOf(vad, task()).fault, "") << "it goes on when images come again";
}

// At 6 m/s for 1.2 s: beside a straight edge of the road a camera may see the same
// all along, but not all of them may.
TEST_F(VadMiniCourse, OneCameraMaySeeTheSameWhileItMovesButNotAll) {
  for (const std::size_t same : {2U, 3U}) {
    VadMiniPlanner vad = planner();
    std::string fault;
    for (std::uint64_t tick = 0; tick <= 24; tick += 2) {
      const std::vector<traffic::CameraImage> before = images_;
      goTo(tick);
      for (std::size_t i = 0; i < same; ++i) images_[i].rgb = before[i].rgb;
      fault = planOf(vad, task()).fault;
    }
    EXPECT_EQ(fault.empty(), same < 3) << fault;
    if (same == 3) {
      EXPECT_NE(
          fault.find("cameras 'front', 'front_left', 'front_right': the image has not changed"),
          std::string::npos)
          << fault;
    }
  }
}

TEST_F(VadMiniCourse, ARigWithoutItsCamerasIsRefused) {
  rendering::RigOptions front;
  front.preset = rendering::kFrontRig;
  const std::string text = refusal(weights(kVadMini.format), front);
  EXPECT_NE(text.find("front_left"), std::string::npos) << text;
  EXPECT_NE(text.find("ego_rig"), std::string::npos) << text;
}

TEST_F(VadMiniCourse, OtherSizesAndExtrinsicsAreRefused) {
  rendering::RigOptions large;
  large.width = 320;
  std::string text = refusal(weights(kVadMini.format), large);
  EXPECT_NE(text.find("320"), std::string::npos) << text;
  rendering::RigOptions moved;
  moved.preset = rendering::kOwnRig;
  moved.cameras = rig_.cameras;
  moved.cameras[2].yaw = -45.0;
  text = refusal(weights(kVadMini.format), moved);
  EXPECT_NE(text.find("front_right"), std::string::npos) << text;
  EXPECT_NE(text.find("yaw"), std::string::npos) << text;
}

TEST_F(VadMiniCourse, WeightsOfAnotherPlannerAreRefused) {
  EXPECT_EQ(refusal(weights(kVadMini.format)), "made");
  const std::string text = refusal(weights("e2e_cdiff.uniad_mini.1"));
  EXPECT_NE(text.find("its format is 'e2e_cdiff.uniad_mini.1', not 'e2e_cdiff.vad_mini.1'"),
            std::string::npos)
      << text;
  EXPECT_NE(refusal("vad_mini.weights=uniad_mini")
                .find("weights/uniad_mini/vad_mini.safetensors', only weights of others: "
                      "'uniad_mini.safetensors'"),
            std::string::npos);
  EXPECT_NE(refusal("vad_mini.weights=" + (folder_.path() / "none").string())
                .find("cdiff train --task vad_mini --data FOLDER"),
            std::string::npos);
}

TEST_F(VadMiniCourse, AnotherDecisionPeriodIsRefused) {
  planning::PlannerParts slow = parts();
  slow.context.decision_period = 0.2;
  EXPECT_THROW(VadMiniPlanner({}, model(), slow), core::InputError);
}

}  // namespace
}  // namespace cdiff::planners
