// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What a session takes from an OpenSCENARIO file: changes of the shipped example.
#include <gtest/gtest.h>

#include "core/file.h"
#include "session/session_setup.h"
#include "session/storyboard_scenario.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOvertaker =
    "<ScenarioObject name=\"overtaker\">\n      <CatalogReference catalogName=\"vehicles\" "
    "entryName=\"car\"/>";
constexpr const char* kStop = "<StopTrigger>\n      <ConditionGroup>";

class StoryboardScenario : public testing::Test {
 protected:
  StoryboardScenario() {
    fs::copy(core::shareFolder() / "config/openscenario", folder_.path() / "files",
             fs::copy_options::recursive);
  }
  std::string file() const { return (folder_.path() / "files/cut_in.xosc").string(); }
  void change(const std::string& from, const std::string& to) const {
    std::string text = core::readFile(file(), "example");
    const std::size_t place = text.find(from);
    ASSERT_NE(place, std::string::npos) << from;
    core::writeFileAtomically(file(), text.replace(place, from.size(), to));
  }
  ScenarioOptions options() const { return openScenarioOptions(file(), {}, true); }
  std::string error() const {
    return test::errorOf([&] { options(); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(StoryboardScenario, TheFileGivesNetworkSpeedAndNoCbv) {
  const ScenarioOptions options = this->options();
  EXPECT_EQ(options.name, "cut_in");
  EXPECT_EQ(fs::path(options.network).filename(), "straight_road.xodr");
  EXPECT_EQ(options.demand, "none");
  EXPECT_EQ(options.route.start_speed, 10.0);
  EXPECT_EQ(options.target_speed, 10.0);
  EXPECT_EQ(options.max_cbv, 0);
  EXPECT_EQ(options.verdict.maximum_contacts_at_fault, 0.0);
}

TEST_F(StoryboardScenario, TheEgosRouteStartsWithItsBoxAndFollowsItsLane) {
  ScenarioOptions options = this->options();
  const SessionSetup setup(options);
  // The reference point is at s = 50 m on lane -2, the box's center 1.4 m ahead of it.
  const Eigen::Vector3d start = setup.egoRoute().path().pointAt(0.0);
  EXPECT_NEAR(start.x(), 51.4, 0.1);
  EXPECT_NEAR(start.y(), -5.25, 0.05);
  EXPECT_NEAR(setup.egoRoute().length(), 600.0 - 51.4, 2.0);
}

TEST_F(StoryboardScenario, ControllersNamedLikePlannersMakeCbvs) {
  change(kOvertaker, std::string(kOvertaker) +
                         "<ObjectController><Controller name=\"diffusion\"/></ObjectController>");
  const ScenarioOptions options = this->options();
  EXPECT_EQ(options.cbv_planner, "diffusion");
  EXPECT_EQ(options.cbv.only, std::vector<std::string>{"overtaker"});
  EXPECT_EQ(options.max_cbv, 1);
}

TEST_F(StoryboardScenario, OnlyMotorVehiclesAreCbvs) {
  std::string bicycle = kOvertaker;
  bicycle.replace(bicycle.find("\"car\""), 5, "\"bicycle\"");
  change(kOvertaker,
         bicycle + "<ObjectController><Controller name=\"pdm_lite\"/></ObjectController>");
  EXPECT_NE(error().find("'overtaker' has the controller 'pdm_lite'; expected a car"),
            std::string::npos)
      << error();
}

TEST_F(StoryboardScenario, AStartSpeedThatNoPlannerDrivesIsRefused) {
  change("parameterType=\"double\" value=\"10\"", "parameterType=\"double\" value=\"410\"");
  EXPECT_NE(error().find("m/s; expected 0 to 40 m/s"), std::string::npos) << error();
}

TEST_F(StoryboardScenario, TwoEgosAreRefused) {
  change(kOvertaker, std::string(kOvertaker) +
                         "<ObjectController><Controller name=\"external\"/></ObjectController>");
  EXPECT_NE(error().find("cut_in.xosc:26: 'Ego' and 'overtaker' have external controllers"),
            std::string::npos)
      << error();
}

TEST_F(StoryboardScenario, AllCbvsHaveOnePlanner) {
  const std::string controller = "<ObjectController><Controller name=\"";
  change(kOvertaker, std::string(kOvertaker) + controller +
                         "diffusion\"/></ObjectController></ScenarioObject>\n<ScenarioObject "
                         "name=\"third\"><CatalogReference catalogName=\"vehicles\" "
                         "entryName=\"car\"/>" +
                         controller + "pdm_lite\"/></ObjectController>");
  EXPECT_NE(error().find("cut_in.xosc:28: the controller is 'pdm_lite'"), std::string::npos)
      << error();
}

TEST_F(StoryboardScenario, AnEntityWithActionsAndNoPlaceIsRefused) {
  change("<RelativeLanePosition entityRef=\"Ego\" dLane=\"1\" ds=\"-20\"/>", "PLACE");
  std::string text = core::readFile(file(), "example");
  const std::size_t place = text.find("PLACE");
  const std::size_t begin = text.rfind("<TeleportAction>", place);
  const std::size_t end = text.find("</TeleportAction>", place) + 17;
  text.replace(
      begin, end - begin,
      "<RoutingAction><AcquirePositionAction><Position><LanePosition "
      "roadId=\"1\" laneId=\"-2\" s=\"50\"/></Position></AcquirePositionAction></RoutingAction>");
  core::writeFileAtomically(file(), text);
  EXPECT_NE(error().find("'overtaker' has no place in <Init>"), std::string::npos) << error();
}

TEST_F(StoryboardScenario, WithoutAnExternalControllerTheEgoIsFoundByItsName) {
  change("external_control", "some_controller");
  EXPECT_EQ(options().route.start_speed, 10.0);
  change("<ScenarioObject name=\"Ego\">", "<ScenarioObject name=\"target\">");
  change("<Private entityRef=\"Ego\">", "<Private entityRef=\"target\">");
  std::string text = core::readFile(file(), "example");
  for (std::size_t at = text.find("entityRef=\"Ego\""); at != std::string::npos;
       at = text.find("entityRef=\"Ego\""))
    text.replace(at, 15, "entityRef=\"target\"");
  core::writeFileAtomically(file(), text);
  EXPECT_NE(error().find("cut_in.xosc:18: no entity is the ego"), std::string::npos) << error();
}

std::string criterion(const std::string& name, const std::string& parameter,
                      const std::string& value) {
  return kStop + ("<Condition name=\"" + name) +
         "\" delay=\"0\" conditionEdge=\"rising\"><ByValueCondition><ParameterCondition "
         "parameterRef=\"" +
         parameter + "\" value=\"" + value +
         "\" rule=\"lessThan\"/></ByValueCondition></Condition></ConditionGroup><ConditionGroup>";
}

TEST_F(StoryboardScenario, CriteriaOfTheStopTriggerBecomeRules) {
  EXPECT_GT(options().verdict.maximum_ego_collisions, 0.0);
  change(kStop, criterion("c", "criteria_CollisionTest", ""));
  EXPECT_EQ(options().verdict.maximum_ego_collisions, 0.0);
}

// The examples of scenario_runner give the condition the criterion's name, and no parameter.
TEST_F(StoryboardScenario, ACriterionMayBeTheNameOfTheCondition) {
  change(kStop, criterion("criteria_RunningRedLightTest", "", ""));
  EXPECT_EQ(options().verdict.maximum_red_lights, 0.0);
  EXPECT_GT(options().verdict.maximum_ego_collisions, 0.0);
}

TEST_F(StoryboardScenario, TheDistanceToDriveIsARule) {
  change(kStop, criterion("criteria_DrivenDistanceTest", "distance_success", "100"));
  EXPECT_EQ(options().verdict.minimum_ego_distance, 100.0);
}

TEST_F(StoryboardScenario, ADistanceToDriveThatIsNoneIsRefused) {
  change(kStop, criterion("criteria_DrivenDistanceTest", "distance_success", "far"));
  EXPECT_NE(error().find("'criteria_DrivenDistanceTest' has the value 'far'; expected a distance"),
            std::string::npos)
      << error();
}

TEST_F(StoryboardScenario, ThePropertyModuleNamesTheController) {
  change(kOvertaker, std::string(kOvertaker) +
                         "<ObjectController><Controller name=\"agent\"><Properties><Property "
                         "name=\"module\" value=\"pdm_lite\"/></Properties></Controller>"
                         "</ObjectController>");
  EXPECT_EQ(options().cbv_planner, "pdm_lite");
}

TEST_F(StoryboardScenario, NamesThatAreNoIdsOfVehiclesAreRefused) {
  change("<ScenarioObject name=\"overtaker\">", "<ScenarioObject name=\"an overtaker\">");
  std::string text = core::readFile(file(), "example");
  for (std::size_t at = text.find("\"overtaker\""); at != std::string::npos;
       at = text.find("\"overtaker\""))
    text.replace(at, 11, "\"an overtaker\"");
  core::writeFileAtomically(file(), text);
  EXPECT_NE(error().find("'an overtaker' cannot be the name of a vehicle"), std::string::npos)
      << error();
}

}  // namespace
}  // namespace cdiff::session
