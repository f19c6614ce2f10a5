// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/course.h"
#include "planners/planner_factory.h"

namespace cdiff::planners {
namespace {

class PlannerFactory : public ::testing::Test {
 protected:
  std::string errorOf(const std::string& name) const {
    try {
      makePlanner(name, {}, context_);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 50.0, 0.0)}});
  map::DrivableArea area_{network_};
  planning::PlanningContext context_{network_, area_};
};

TEST_F(PlannerFactory, MakesEveryPlannerThatItNames) {
  const std::vector<std::string> names = plannerNames();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_NE(std::find(names.begin(), names.end(), "pdm_lite"), names.end());
  for (const std::string& name : names) EXPECT_NE(makePlanner(name, {}, context_), nullptr) << name;
}

TEST_F(PlannerFactory, TwoStagePidIsGuidedAndSees) {
  EXPECT_TRUE(canBeGuided("two_stage_pid"));
  EXPECT_TRUE(seesImages("two_stage_pid"));
  EXPECT_TRUE(makePlanner("two_stage_pid", {}, context_)->needsImages());
  PlannerOptions options;
  options.two_stage_pid.look_ahead_maximum = 1.0;
  EXPECT_THROW(makePlanner("two_stage_pid", options, context_), core::InputError);
  options = {};
  options.camera.width = 80;
  EXPECT_THROW(makePlanner("two_stage_pid", options, context_), core::InputError);
}

TEST_F(PlannerFactory, NamesTheNearestPlanner) {
  EXPECT_EQ(errorOf("pdmlite"),
            "unknown planner 'pdmlite'; the nearest known planner is 'pdm_lite'");
}

TEST_F(PlannerFactory, ExternalNeedsTheNodeGraph) {
  EXPECT_NE(errorOf("external").find("needs the node graph"), std::string::npos);
}

TEST_F(PlannerFactory, PassesTheOptionsOn) {
  PlannerOptions options;
  options.pdm_lite.forecast_horizon = -1.0;
  EXPECT_THROW(makePlanner("pdm_lite", options, context_), core::InputError);
}

TEST(PdmLiteOptions, ReadBackFromTheirOwnText) {
  PdmLiteOptions options;
  options.lateral_kp = 3.118;
  options.obey_lights = false;
  PdmLiteOptions read;
  core::loadOptions({"text", core::dumpOptions(options, true)}, read);
  EXPECT_EQ(read.lateral_kp, 3.118);
  EXPECT_FALSE(read.obey_lights);
  EXPECT_EQ(core::dumpOptions(read), core::dumpOptions(options));
}

TEST(PdmLiteOptions, UnknownKeysAndValuesOutOfRangeAreErrors) {
  PdmLiteOptions options;
  EXPECT_THROW(core::loadOptions({"text", "lateral_pk: 2.0"}, options), core::InputError);
  EXPECT_THROW(core::loadOptions({"text", "lateral_window: 0"}, options), core::InputError);
}

}  // namespace
}  // namespace cdiff::planners
