// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/camera_course.h"
#include "planners/uniad_mini/uniad_mini.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

/// A small network; the cameras are the real ones.
UniadMiniArchitecture smallUniad() {
  UniadMiniArchitecture architecture;
  architecture.ego.width = 32;
  architecture.ego.heads = 2;
  architecture.ego.hidden = 32;
  architecture.ego.bev_layers = 1;
  architecture.ego.bev = {16, 16, 4.0, 16.0};
  architecture.decoder_layers = 1;
  architecture.motion_layers = 1;
  architecture.plan_layers = 1;
  return architecture;
}

class UniadMiniCourse : public testing::CameraCourse {
 protected:
  static UniadMiniModel model() {
    return {smallUniad(), cdiff::testing::randomTensors(uniadMiniTensors(smallUniad()))};
  }
  UniadMiniPlanner planner(const UniadMiniOptions& options = {}) const {
    return {options, model(), parts()};
  }
  std::string refusal(const std::string& assignment, const rendering::RigOptions& rig = {}) const {
    return refusalOf("uniad_mini", assignment, rig);
  }
  std::string weights(const char* format) const {
    return weightsOf(kUniadMini, networkMetadata(kUniadMini, smallUniad()), model().weights,
                     format);
  }
};

TEST_F(UniadMiniCourse, PlansThreeSecondsAndSaysWhatItSees) {
  UniadMiniOptions options;
  options.least_score = 0.0;
  UniadMiniPlanner uniad = planner(options);
  const planning::PlannedAction planned = planOf(uniad, task());
  EXPECT_EQ(planned.fault, "");
  EXPECT_TRUE(planned.action.valid());
  EXPECT_EQ(planned.rollout.size(), 30U);
  ASSERT_EQ(planned.perception.vehicles.size(), 24U);
  EXPECT_EQ(planned.perception.lines.size(), 12U);
  ASSERT_EQ(planned.perception.vehicles[0].forecasts.size(), 6U);
  double sum = 0.0;
  for (const auto& forecast : planned.perception.vehicles[0].forecasts) sum += forecast.probability;
  EXPECT_NEAR(sum, 1.0, 1e-5) << "shares of the modes";
  ASSERT_EQ(planned.perception.occupancy.size(), 5U);
  EXPECT_EQ(planned.perception.occupancy[4].probability.size(), 256U);
  EXPECT_EQ(planned.perception.occupancy[4].time, 2.0);
}

TEST_F(UniadMiniCourse, TheSameDecisionsGiveTheSameActions) {
  UniadMiniPlanner first = planner(), second = planner();
  for (std::uint64_t tick = 0; tick < 20; tick += 2) {
    goTo(tick);
    const auto one = planOf(first, task()), other = planOf(second, task());
    EXPECT_EQ(one.action, other.action) << tick;
    EXPECT_EQ(one.rollout.back().state.position, other.rollout.back().state.position) << tick;
    EXPECT_EQ(one.fault, "") << tick;
  }
}

/// Whether anything of the plans differs.
bool differ(const planning::PlannedAction& one, const planning::PlannedAction& other) {
  return one.rollout.back().state.position != other.rollout.back().state.position;
}

// From the sixth decision on it reads what it saw half a second before; one that starts there does
// not know that.
TEST_F(UniadMiniCourse, RemembersHalfASecond) {
  UniadMiniPlanner old = planner();
  for (std::uint64_t tick = 0; tick <= 10; tick += 2) {
    UniadMiniPlanner fresh = planner();
    goTo(tick);
    const auto one = planOf(old, task()), other = planOf(fresh, task());
    EXPECT_EQ(differ(one, other), tick >= 10) << tick;
  }
}

TEST_F(UniadMiniCourse, AFaultForgetsWhatWasSeen) {
  UniadMiniPlanner old = planner(), fresh = planner();
  for (std::uint64_t tick = 0; tick < 10; tick += 2) {
    goTo(tick);
    planOf(old, task());
  }
  goTo(10);
  planning::PlanningTask missing = task();
  missing.views.images[1] = nullptr;
  const auto fault = planOf(old, missing), same = planOf(fresh, missing);
  EXPECT_EQ(fault.action, traffic::ControlAction::failSafe());
  EXPECT_NE(fault.fault.find("camera 'front_left': no image came for tick 10"), std::string::npos)
      << fault.fault;
  EXPECT_EQ(fault.fault, same.fault);
  goTo(12);
  EXPECT_FALSE(differ(planOf(old, task()), planOf(fresh, task())));
}

// A plan of 2 x 3 m every 0.5 s: 12 m/s are desired, and the ego drives 6 m/s.
TEST_F(UniadMiniCourse, LimitsTheThrottleOnlyWhereTheQuirkIsAskedFor) {
  UniadMiniModel fast = model();
  for (float& value : fast.weights.at("plan.way.out.weight").values) value = 0.0F;
  std::vector<float>& bias = fast.weights.at("plan.way.out.bias").values;
  for (std::size_t i = 0; i < bias.size(); ++i) bias[i] = i % 2 == 0 ? 2.0F : 0.0F;
  UniadMiniOptions options;
  options.adjustment.adjust = false;
  UniadMiniPlanner free(options, fast, parts());
  options.no_throttle_above = 5.0;
  UniadMiniPlanner capped(options, fast, parts());
  const planning::PlannedAction planned = planOf(free, task());
  EXPECT_NEAR(planned.rollout.back().state.position.x(), 5.0 + 36.0, 1e-4);
  EXPECT_EQ(planned.action.throttle, 0.75);
  EXPECT_EQ(planOf(capped, task()).action.throttle, 0.0);
  snapshot_.vehicles[0].state.speed = 5.0;
  goTo(2);
  EXPECT_GT(planOf(capped, task()).action.throttle, 0.0) << "5 m/s are not above 5 m/s";
}

TEST_F(UniadMiniCourse, OtherRigsAreRefused) {
  rendering::RigOptions front;
  front.preset = rendering::kFrontRig;
  std::string text = refusal(weights(kUniadMini.format), front);
  EXPECT_NE(text.find("front_left"), std::string::npos) << text;
  EXPECT_NE(text.find("ego_rig"), std::string::npos) << text;
  rendering::RigOptions large;
  large.width = 320;
  large.height = 192;
  text = refusal(weights(kUniadMini.format), large);
  EXPECT_NE(text.find("height 192"), std::string::npos) << text;
}

TEST_F(UniadMiniCourse, WeightsOfOthersAreRefused) {
  EXPECT_EQ(refusal(weights(kUniadMini.format)), "made");
  std::string text = refusal(weights("e2e_cdiff.vad_mini.1"));
  EXPECT_NE(text.find("its format is 'e2e_cdiff.vad_mini.1', not 'e2e_cdiff.uniad_mini.1'"),
            std::string::npos)
      << text;
  UniadMiniArchitecture other = smallUniad();
  other.motion_layers = 2;
  text = refusal(weightsOf(kUniadMini, networkMetadata(kUniadMini, other), model().weights,
                           kUniadMini.format));
  EXPECT_NE(text.find("motion.1"), std::string::npos) << text;
  EXPECT_NE(refusal("uniad_mini.weights=" + (folder_.path() / "none").string())
                .find("cdiff train --task uniad_mini --data FOLDER"),
            std::string::npos);
}

TEST_F(UniadMiniCourse, AnotherDecisionPeriodIsRefused) {
  planning::PlannerParts slow = parts();
  slow.context.decision_period = 0.2;
  EXPECT_THROW(UniadMiniPlanner({}, model(), slow), core::InputError);
}

TEST(UniadMiniArchitecture, SizesThatDoNotFitAreRefused) {
  UniadMiniArchitecture odd;
  odd.ego.bev.columns = 31;
  EXPECT_THROW(odd.validate(), core::InputError);
  EXPECT_NO_THROW(UniadMiniArchitecture{}.validate());
}

TEST(UniadMiniDescriptor, DrivesEgosByThreeCameras) {
  const planning::PlannerDescriptor* known = findPlanner("uniad_mini");
  ASSERT_NE(known, nullptr);
  EXPECT_TRUE(known->drives_ego);
  EXPECT_FALSE(known->drives_cbv);
  EXPECT_EQ(known->cameras.size(), 3U);
  EXPECT_EQ(rigOfPlanner("uniad_mini"), rendering::kFrontThreeRig);
}

}  // namespace
}  // namespace cdiff::planners
