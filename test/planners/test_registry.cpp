// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/course.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planners/planner_by_slot.h"
#include "planners/registry.h"
#include "planners/two_stage_pid/two_stage_pid.h"

namespace cdiff::planners {
namespace {

class PlannerRegistry : public ::testing::Test {
 protected:
  std::unique_ptr<planning::Planner> make(const std::string& name) const {
    return makePlanner(name, {{network_, area_}, options_, vehicle_, camera_, guidance_});
  }
  std::string errorOf(const std::string& name) const {
    return messageOf([&] { make(name); });
  }
  template <class Call>
  static std::string messageOf(const Call& call) {
    try {
      call();
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  }
  /// Whether the weights of a planner are there: those of one that was never trained are not.
  bool hasWeights(const std::string& name) const {
    const auto& hash = findPlanner(name)->weights_sha256;
    return !hash || messageOf([&] { hash(options_); }) == "no error";
  }
  /// A descriptor that could be registered.
  static planning::PlannerDescriptor descriptor(const std::string& name) {
    planning::PlannerDescriptor made = *findPlanner("pdm_lite");
    made.name = name;
    return made;
  }
  static std::string refusal(const planning::PlannerDescriptor& descriptor) {
    return messageOf([&] { registerPlanner(descriptor, "library mine.so"); });
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 50.0, 0.0)}});
  map::DrivableArea area_{network_};
  planning::PlannerOptionsTable options_ = defaultOptions();
  dynamics::BicycleModelOptions vehicle_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
};

TEST_F(PlannerRegistry, MakesEveryPlannerThatItNames) {
  const std::vector<std::string> names = plannerNames();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_NE(std::find(names.begin(), names.end(), "pdm_lite"), names.end());
  for (const std::string& name : names) {
    EXPECT_FALSE(findPlanner(name)->help.empty()) << name;
    EXPECT_FALSE(findPlanner(name)->title.empty()) << name;
    if (!hasWeights(name)) {
      EXPECT_NE(errorOf(name), "no error") << name;
      continue;
    }
    ASSERT_NE(make(name), nullptr) << name;
  }
}

TEST(PlannersPage, HasARowOfEveryPlannerWithTitleAndRoles) {
  const std::string page = core::readFile(E2E_CDIFF_DOCS "/planners.md", "documentation");
  for (const planning::PlannerDescriptor& planner : packagePlanners()) {
    const char* roles = !planner.drives_ego ? "CBVs" : !planner.drives_cbv ? "ego" : "ego, CBVs";
    const std::string row = "\n| `" + planner.name + "` | " + planner.title + " | " + roles + " | ";
    EXPECT_NE(page.find(row), std::string::npos) << "docs/planners.md must hold" << row;
  }
}

TEST_F(PlannerRegistry, DefaultPlannersAreRegisteredWithTheirWeights) {
  EXPECT_TRUE(findPlanner(kDefaultEgoPlanner)->drives_ego);
  EXPECT_TRUE(findPlanner(kDefaultCbvPlanner)->drives_cbv);
  for (const char* name : {kDefaultEgoPlanner, kDefaultCbvPlanner})
    EXPECT_TRUE(hasWeights(name)) << name;
}

TEST_F(PlannerRegistry, TwoStagePidIsGuidedAndSees) {
  EXPECT_TRUE(canBeGuided("two_stage_pid"));
  EXPECT_TRUE(seesImages("two_stage_pid"));
  EXPECT_FALSE(canBeGuided("pdm_lite"));
  options_.of<TwoStagePidOptions>().look_ahead_maximum = 1.0;
  EXPECT_THROW(make("two_stage_pid"), core::InputError);
  EXPECT_THROW(options_.validate(), core::InputError);
  options_ = defaultOptions();
  camera_.width = 80;
  EXPECT_THROW(make("two_stage_pid"), core::InputError);
}

TEST_F(PlannerRegistry, NamesTheNearestPlanner) {
  EXPECT_EQ(errorOf("pdmlite"),
            "unknown planner 'pdmlite'; the nearest known planner is 'pdm_lite'");
}

TEST_F(PlannerRegistry, ExternalNeedsTheNodeGraph) {
  EXPECT_NE(errorOf("external").find("needs the node graph"), std::string::npos);
}

TEST_F(PlannerRegistry, PassesTheOptionsOn) {
  options_.of<PdmLiteOptions>().forecast_horizon = -1.0;
  EXPECT_THROW(make("pdm_lite"), core::InputError);
}

TEST_F(PlannerRegistry, CopiesOfOptionsAreDeep) {
  planning::PlannerOptionsTable copy = options_;
  copy.of<PdmLiteOptions>().lateral.kp = 3.118;
  EXPECT_NE(options_.of<PdmLiteOptions>().lateral.kp, 3.118);
  options_ = copy;
  EXPECT_EQ(options_.of<PdmLiteOptions>().lateral.kp, 3.118);
}

TEST_F(PlannerRegistry, RefusesWhatCannotWork) {
  EXPECT_EQ(refusal(descriptor("pdm_lite")),
            "library mine.so: planner 'pdm_lite' is already registered by package e2e_cdiff; one "
            "of the two needs another name");
  for (const char* name : {"", "external", "My planner", "_x"})
    EXPECT_NE(refusal(descriptor(name)).find("must be snake_case"), std::string::npos) << name;
  planning::PlannerDescriptor broken = descriptor("broken");
  broken.options = nullptr;
  EXPECT_NE(refusal(broken).find("its descriptor has no options"), std::string::npos);
  broken = descriptor("broken");
  broken.options = [] { return std::unique_ptr<planning::PlannerOptions>(); };
  EXPECT_NE(refusal(broken).find("its descriptor has no options"), std::string::npos);
  broken = descriptor("broken");
  broken.make = nullptr;
  EXPECT_NE(refusal(broken).find("no constructor"), std::string::npos);
  broken = descriptor("broken");
  broken.drives_ego = broken.drives_cbv = false;
  EXPECT_NE(refusal(broken).find("neither the ego nor CBVs"), std::string::npos);
  broken = descriptor("broken");
  broken.cameras = {"rear"};
  EXPECT_NE(refusal(broken).find("camera 'rear'"), std::string::npos);
  EXPECT_EQ(findPlanner("broken"), nullptr);
}

TEST_F(PlannerRegistry, AConstructorThatGivesNoPlannerIsNamed) {
  planning::PlannerDescriptor none = descriptor("registry_test_none");
  none.make = [](const planning::PlannerParts&) { return std::unique_ptr<planning::Planner>(); };
  registerPlanner(none, "library none.so");
  EXPECT_EQ(errorOf("registry_test_none"),
            "planner 'registry_test_none' of library none.so: its constructor gives none; its "
            "author must mend it");
}

TEST_F(PlannerRegistry, WhatIsRegisteredIsKnownEverywhere) {
  planning::PlannerDescriptor mine = descriptor("registry_test_planner");
  mine.guided = true;
  registerPlanner(mine, "library mine.so");
  EXPECT_EQ(sourceOf("registry_test_planner"), "library mine.so");
  EXPECT_NE(make("registry_test_planner"), nullptr);
  EXPECT_TRUE(canBeGuided("registry_test_planner"));
  const std::vector<std::string> guided = guidedPlannerNames();
  EXPECT_NE(std::find(guided.begin(), guided.end(), "registry_test_planner"), guided.end());
}

TEST(PdmLiteOptions, ReadBackFromTheirOwnText) {
  PdmLiteOptions options;
  options.lateral.kp = 3.118;
  options.obey_lights = false;
  PdmLiteOptions read;
  core::loadOptions({"text", core::dumpOptions(options, true)}, read);
  EXPECT_EQ(read.lateral.kp, 3.118);
  EXPECT_FALSE(read.obey_lights);
  EXPECT_EQ(core::dumpOptions(read), core::dumpOptions(options));
}

TEST(PdmLiteOptions, UnknownKeysAndValuesOutOfRangeAreErrors) {
  PdmLiteOptions options;
  EXPECT_THROW(core::loadOptions({"text", "lateral_pk: 2.0"}, options), core::InputError);
  EXPECT_THROW(core::loadOptions({"text", "lateral_window: -1"}, options), core::InputError);
  EXPECT_THROW(core::loadOptions({"text", "configuration: rfit"}, options), core::InputError);
  options.configuration = "rfit";
  EXPECT_THROW(options.validate(), core::InputError);
}

TEST(PdmLiteOptions, AConfigurationLiesBelowItsKeys) {
  PdmLiteOptions options;
  EXPECT_EQ(options.resolved().lateral_kp, 2.0);
  EXPECT_EQ(options.resolved().lateral_window, 20);
  EXPECT_EQ(options.resolved().top_speed, 0.0);
  core::loadOptions({"text", "configuration: original\nlateral_window: 12"}, options);
  EXPECT_EQ(options.resolved().lateral_kp, 3.118357247806046);
  EXPECT_EQ(options.resolved().lateral_window, 12);
  EXPECT_EQ(options.resolved().top_speed, 20.0);
}

/// Plans throttle `throttle` for all its vehicles, or throws; notes the slots of each batch.
class BatchPlanner final : public planning::Planner {
 public:
  BatchPlanner(double throttle, std::vector<std::vector<int>>& batches)
      : throttle_(throttle), batches_(batches) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot&, const std::vector<planning::PlanningTask>& tasks) override {
    std::vector<planning::PlannedAction> actions;
    batches_.emplace_back();
    for (const planning::PlanningTask& task : tasks) {
      batches_.back().push_back(task.slot);
      actions.push_back({task.slot, task.vehicle->id, {throttle_, 0.0, 0.0}, {}});
    }
    if (throttle_ < 0.0) throw std::runtime_error("no plan today");
    return actions;
  }

 private:
  double throttle_;
  std::vector<std::vector<int>>& batches_;
};

class PlannersBySlot : public PlannerRegistry {
 protected:
  /// The actions for slots 0, 1, 2 of two planners with these throttles.
  std::vector<planning::PlannedAction> plan(double first, double second) {
    std::vector<PlannerBySlot::Member> members;
    members.push_back({"first", std::make_unique<BatchPlanner>(first, first_batches_)});
    members.push_back({"second", std::make_unique<BatchPlanner>(second, second_batches_)});
    PlannerBySlot planner(std::move(members));
    traffic::TrafficSnapshot snapshot;
    snapshot.vehicles.resize(3);
    std::vector<planning::PlanningTask> tasks;
    for (int slot = 0; slot < 3; ++slot) {
      traffic::Vehicle& vehicle = snapshot.vehicles[static_cast<std::size_t>(slot)];
      vehicle.id = "cbv" + std::to_string(slot);
      tasks.push_back({slot, &vehicle});
    }
    return planner.plan(snapshot, tasks);
  }
  std::vector<std::vector<int>> first_batches_;
  std::vector<std::vector<int>> second_batches_;
};

TEST_F(PlannersBySlot, EachPlansItsSlotsInOneBatch) {
  const auto actions = plan(0.25, 0.5);
  ASSERT_EQ(actions.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(actions[i].slot, static_cast<int>(i));
    EXPECT_EQ(actions[i].action.throttle, i == 1 ? 0.5 : 0.25);
  }
  EXPECT_EQ(first_batches_, (std::vector<std::vector<int>>{{0, 2}}));
  EXPECT_EQ(second_batches_, (std::vector<std::vector<int>>{{1}}));
}

TEST_F(PlannersBySlot, OneThatFailsLeavesTheOthersDriving) {
  const auto actions = plan(-1.0, 0.5);
  ASSERT_EQ(actions.size(), 3U);
  EXPECT_EQ(actions[0].fault, "first: no plan today");
  EXPECT_EQ(actions[0].action.brake, 1.0);
  EXPECT_EQ(actions[2].fault, "first: no plan today");
  EXPECT_EQ(actions[1].fault, "");
  EXPECT_EQ(actions[1].action.throttle, 0.5);
}

TEST_F(PlannersBySlot, AreKnownByTheirJoinedNames) {
  const planning::PlannerDescriptor* joined = findPlanner("pdm_lite+diffusion");
  ASSERT_NE(joined, nullptr);
  EXPECT_FALSE(joined->drives_ego);
  EXPECT_TRUE(joined->drives_cbv);
  EXPECT_TRUE(joined->guided);
  EXPECT_TRUE(joined->sees());
  EXPECT_EQ(joined->title,
            findPlanner("pdm_lite")->title + " + " + findPlanner("diffusion")->title);
  EXPECT_EQ(joined->weights_sha256(options_), findPlanner("diffusion")->weights_sha256(options_));
  EXPECT_TRUE(seesImages("pdm_lite+diffusion"));
  EXPECT_FALSE(seesImages("pdm_lite+pdm_lite"));
  EXPECT_FALSE(findPlanner("pdm_lite+pdm_lite")->network);
  EXPECT_EQ(plannerOfSlot("pdm_lite+diffusion", 1), "diffusion");
  EXPECT_EQ(plannerOfSlot("pdm_lite+diffusion", 2), "pdm_lite");
  for (const char* wrong : {"pdm_lite+", "+", "pdm_lite++diffusion", "pdm_lite+none"})
    EXPECT_EQ(findPlanner(wrong), nullptr) << wrong;
}

}  // namespace
}  // namespace cdiff::planners
