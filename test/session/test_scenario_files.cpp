// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/pluto/pluto.h"
#include "planners/two_stage_pid/two_stage_pid.h"
#include "session/session_request.h"
#include "session/session_setup.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

class ShippedScenario : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenario, LoadsWithNetworkRouteAndPlanners) {
  const ScenarioOptions options = loadScenario(GetParam());
  EXPECT_EQ(options.name, GetParam());
  const SessionSetup setup(options);
  EXPECT_GE(setup.egoRoute().length(), 80.0);
  EXPECT_LE(setup.egoRoute().length(), 250.0);
  EXPECT_NO_THROW(setup.makeEgoPlanner());
  EXPECT_NO_THROW(setup.makeCbvPlanner());
}

TEST_P(ShippedScenario, CarriesTheStandardRules) {
  EXPECT_EQ(core::dumpOptions(loadScenario(GetParam()).verdict),
            core::dumpOptions(VerdictOptions::standard()));
}

TEST_P(ShippedScenario, ResolvedFormReadsBackToTheSame) {
  const std::string text = core::dumpOptions(loadScenario(GetParam()));
  ScenarioOptions again;
  core::loadOptions({"dump", text}, again);
  EXPECT_EQ(core::dumpOptions(again), text);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, testing::ValuesIn(shippedScenarios()),
                         [](const auto& info) { return info.param; });

TEST(ScenarioFile, WithoutANameIsCalledAsItsFile) {
  const test::TemporaryFolder folder;
  core::writeFileAtomically(folder.path() / "my_scene.yaml", "network: crossing_district\n");
  EXPECT_EQ(loadScenario((folder.path() / "my_scene.yaml").string()).name, "my_scene");
}

/// The scenario of a request with these overrides.
ScenarioOptions withKeys(const std::vector<std::string>& set) {
  SessionRequest request;
  request.scenario = shippedScenarios().front();
  request.set = set;
  return resolveRequest(request);
}

TEST(Trackers, LieBelowSingleKeysInAnyOrder) {
  const ScenarioOptions after =
      withKeys({"two_stage_pid.tracker=published", "two_stage_pid.turn_kp=2"});
  const ScenarioOptions before =
      withKeys({"two_stage_pid.turn_kp=2", "two_stage_pid.tracker=published"});
  EXPECT_EQ(core::dumpOptions(after), core::dumpOptions(before));
  const auto& options = before.planner_options.of<planners::TwoStagePidOptions>();
  EXPECT_EQ(options.pids.turn.kp, 2.0);
  EXPECT_EQ(options.pids.turn.ki, 0.75);
  EXPECT_EQ(options.look_ahead_minimum, 5.0);
  // Of the other planners the tracker stays.
  EXPECT_EQ(before.planner_options.of<planners::PlutoOptions>().tracker.tracker, "tuned");
}

TEST(Trackers, KeysOfTheFormerGroupNameTheNewOnes) {
  try {
    withKeys({"pluto.tracker.turn_kp=2"});
    FAIL();
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("the nearest known key is 'pluto.turn_kp'"), std::string::npos) << text;
  }
}

TEST(ShippedScenarios, ThreeForEachOfFourNetworks) {
  std::map<std::string, int> counts;
  for (const std::string& name : shippedScenarios()) ++counts[loadScenario(name).network];
  EXPECT_EQ(counts.size(), 4u);
  for (const auto& [network, count] : counts) EXPECT_EQ(count, 3) << network;
}

TEST(ShippedScenarios, EveryFolderOfNetworksImportsUnchanged) {
  for (const auto& entry : fs::directory_iterator(core::shareFolder() / "networks")) {
    if (!entry.is_directory()) continue;
    const map::ImportedNetwork imported = map::importNetwork(entry.path().filename().string());
    EXPECT_TRUE(imported.changes.empty()) << entry.path();
  }
}

std::string errorOf(const SessionRequest& request) {
  try {
    const SessionSetup setup(resolveRequest(request));
    setup.makeEgoPlanner();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(SessionRequest, ABench2DriveRouteCarriesTheStandardRules) {
  SessionRequest request;
  request.bench2drive = "routes.xml";
  request.route = "28035";
  request.network = "roundabout";
  EXPECT_EQ(core::dumpOptions(resolveRequest(request).verdict),
            core::dumpOptions(VerdictOptions::standard()));
  request.set = {"verdict.minimum_route_completion=50"};
  EXPECT_EQ(resolveRequest(request).verdict.minimum_route_completion, 50.0);
}

TEST(SessionRequest, UnknownScenarioNamesTheNearest) {
  SessionRequest request;
  request.scenario = "crossing_left_turns";
  EXPECT_TRUE(mentions(errorOf(request), "nearest shipped one is 'crossing_left_turn'"))
      << errorOf(request);
}

TEST(SessionRequest, NothingToRun) { EXPECT_TRUE(mentions(errorOf({}), "nothing to run")); }

TEST(SessionRequest, BadKeysAndValuesNameTheSource) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.set = {"max_cbvs=1"};
  EXPECT_TRUE(mentions(errorOf(request),
                       "--set: unknown key 'max_cbvs'; the nearest known key is 'max_cbv'"));
  for (const char* beyond : {"max_cbv=-1", "max_cbv=65"}) {
    request.set = {beyond};
    EXPECT_TRUE(mentions(errorOf(request), "[0, 64]")) << errorOf(request);
  }
  request.set = {"max_cbv=64"};
  EXPECT_EQ(resolveRequest(request).max_cbv, 64);
  request.set = {"decision_period=0.12"};
  EXPECT_TRUE(mentions(errorOf(request), "multiple of simulation_step")) << errorOf(request);
  request.set = {"network=nowhere"};
  EXPECT_TRUE(mentions(errorOf(request), "nowhere")) << errorOf(request);
  request.set = {"demand=missing.rou.xml"};
  EXPECT_TRUE(mentions(errorOf(request), "missing.rou.xml")) << errorOf(request);
  request.set = {"route.edges=[nothere]"};
  EXPECT_TRUE(mentions(errorOf(request), "nothere")) << errorOf(request);
}

TEST(SessionRequest, TheModeIsAboutTheCbvsAlone) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.ego_planner = "diffusion";
  request.mode = "safety_critical";
  const ScenarioOptions attacked = resolveRequest(request);
  EXPECT_TRUE(attacked.guidance.isActive("collision_seeking"));
  EXPECT_FALSE(attacked.ego_guidance.isActive("collision_seeking"));
  EXPECT_TRUE(attacked.ego_guidance.isActive("collision_avoidance"));
  request.set = {"guidance_profile=none", "ego_guidance_profile=ablation_speed",
                 "ego_guidance.speed.weight=0.5"};
  ScenarioOptions named = resolveRequest(request);
  EXPECT_EQ(named.ego_guidance.find("speed").weight, 0.5);
  EXPECT_FALSE(named.guidance.isActive("speed"));
  EXPECT_TRUE(named.ego_guidance.isActive("speed"));
  EXPECT_FALSE(named.ego_guidance.isActive("collision_avoidance"));
}

TEST(SessionRequest, MethodPaperIsThePapersSamplingAndGuidance) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.set = {"method=paper"};
  ScenarioOptions paper = resolveRequest(request);
  const auto& diffusion = paper.planner_options.of<planners::DiffusionOptions>();
  EXPECT_EQ(diffusion.sampler.mode, "paper");
  EXPECT_EQ(diffusion.conditioning, "image");
  EXPECT_EQ(diffusion.current_state, "pinned");
  EXPECT_EQ(paper.guidance.candidates, 1);
  EXPECT_TRUE(paper.guidance.isActive("collision_avoidance"));
  for (const guidance::GuidanceOptions* guidance : {&paper.guidance, &paper.ego_guidance}) {
    EXPECT_FALSE(guidance->isActive("traffic_avoidance"));
    for (const guidance::WeightedObjective& entry : guidance->objectives)
      EXPECT_EQ(entry.gradient_cap, 0.0) << entry.name;
  }
  request.mode = "safety_critical";
  ScenarioOptions attack = resolveRequest(request);
  EXPECT_TRUE(attack.guidance.isActive("collision_seeking"));
  EXPECT_FALSE(attack.guidance.isActive("traffic_avoidance"));
  EXPECT_FALSE(attack.guidance.isActive("collision_avoidance"));
  EXPECT_TRUE(attack.ego_guidance.isActive("collision_avoidance"));
}

TEST(SessionRequest, KeysLieAboveTheMethod) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.set = {"diffusion.conditioning=image_route", "guidance.speed.weight=3", "method=paper",
                 "ego_guidance_profile=none"};
  ScenarioOptions options = resolveRequest(request);
  const auto& diffusion = options.planner_options.of<planners::DiffusionOptions>();
  EXPECT_EQ(diffusion.conditioning, "image_route");
  EXPECT_EQ(diffusion.sampler.mode, "paper");
  EXPECT_EQ(options.guidance.find("speed").weight, 3.0);
  EXPECT_FALSE(options.ego_guidance.isActive("speed"));
  request.set = {"method=paper", "guidance_profile=naturalistic"};
  EXPECT_TRUE(resolveRequest(request).guidance.isActive("traffic_avoidance"));
}

TEST(SessionRequest, AnUnknownMethodIsNamed) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.set = {"method=papr"};
  EXPECT_TRUE(mentions(errorOf(request), "key 'method' is 'papr'")) << errorOf(request);
  EXPECT_TRUE(mentions(errorOf(request), "the nearest one is 'paper'")) << errorOf(request);
}

TEST(SessionRequest, TheDefaultMethodIsWhatASessionWithoutOneDoes) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  const std::string without = core::dumpOptions(resolveRequest(request));
  request.set = {"method=default"};
  EXPECT_EQ(core::dumpOptions(resolveRequest(request)), without);
  EXPECT_EQ(shippedMethods(), (std::vector<std::string>{"default", "paper", "paper_literal"}));
}

TEST(SessionRequest, SaysWhichMethodItsPlannersFollowAndWhatWasChanged) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.cbv_planner = "diffusion";
  const auto textOf = [&](const std::vector<std::string>& set) {
    request.set = set;
    return methodText(methodOf(resolveRequest(request)));
  };
  EXPECT_EQ(textOf({}), "default");
  EXPECT_EQ(textOf({"method=paper"}), "paper");
  EXPECT_EQ(textOf({"method=paper", "diffusion.hysteresis=0.2"}),
            "custom (paper but for diffusion.hysteresis)");
  EXPECT_EQ(textOf({"guidance.speed.weight=3"}), "custom (default but for guidance.speed.weight)");
  EXPECT_EQ(textOf({"guidance_profile=none"}), "custom (default but for guidance_profile)");
  // What no planner of the session follows changes nothing.
  EXPECT_EQ(textOf({"pdm_lite.cbv_speed_spread=0.1", "ego_guidance_profile=none"}), "default");
  request.cbv_planner = "pdm_lite";
  EXPECT_EQ(textOf({"diffusion.hysteresis=0.2"}), "default");
  request.ego_planner = "diffusion";
  EXPECT_EQ(textOf({"ego_guidance_profile=none"}), "custom (default but for ego_guidance_profile)");
  ScenarioOptions recorded;
  recorded.method = "gone";
  EXPECT_EQ(methodText(methodOf(recorded)), "custom (gone but for method)");
}

TEST(SessionRequest, BadGuidanceOfTheEgoIsNamedSo) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.ego_planner = "diffusion";
  request.set = {"ego_guidance_profile=naturalistc"};
  EXPECT_TRUE(mentions(errorOf(request), "key 'ego_guidance_profile'")) << errorOf(request);
  EXPECT_TRUE(mentions(errorOf(request), "'naturalistic'")) << errorOf(request);
  request.set = {"ego_guidance.speed.first_step=5", "ego_guidance.speed.last_step=20"};
  EXPECT_TRUE(mentions(errorOf(request), "'ego_guidance.speed.first_step'")) << errorOf(request);
  request.set = {"ego_guidance.speed.first_step=1"};
  EXPECT_TRUE(mentions(errorOf(request), "'ego_guidance.speed.last_step'")) << errorOf(request);
}

TEST(SessionRequest, ScenarioFileErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "broken.yaml";
  std::ofstream(file) << "network: roundabout\nroute:\n  edgess: [a]\n";
  SessionRequest request;
  request.scenario = file.string();
  const std::string error = errorOf(request);
  EXPECT_TRUE(mentions(error, file.string() + ":3")) << error;
  EXPECT_TRUE(mentions(error, "'edges'")) << error;
}

TEST(SessionRequest, ANumberOfADemandFileThatIsNoneIsNamed) {
  const test::TemporaryFolder folder;
  const fs::path demand = folder.path() / "a.rou.xml";
  SessionRequest request;
  request.scenario = shippedScenarios().front();
  request.set = {"demand=" + demand.string()};
  for (const char* number : {"nan", "inf", "-inf", "+Infinity", "-NaN"}) {
    std::ofstream(demand) << "<routes><trip id=\"a\" depart=\"" << number << "\"/></routes>";
    const std::string error = errorOf(request);
    EXPECT_TRUE(mentions(error, "attribute 'depart' is '" + std::string(number))) << error;
  }
}

}  // namespace
}  // namespace cdiff::session
