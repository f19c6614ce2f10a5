// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/matrix.h"
#include "evaluation/run_plan.h"
#include "planners/registry.h"
#include "session/scenario_options.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

std::string errorOf(const MatrixOptions& matrix) {
  try {
    planRuns(matrix, "matrix.yaml");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

MatrixOptions oneScenario() {
  MatrixOptions matrix;
  matrix.scenarios = {"arterial_exit"};
  return matrix;
}

void expectIn(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
}

class ShippedMatrix : public testing::TestWithParam<std::string> {};

TEST_P(ShippedMatrix, PlansRunsWithNamesOfTheirOwn) {
  const auto plan = planRuns(loadMatrix(GetParam()), GetParam());
  std::set<std::string> ids;
  std::set<std::string> scenarios;
  for (const PlannedRun& run : plan) {
    ids.insert(run.id);
    scenarios.insert(run.scenario_sha256);
  }
  EXPECT_EQ(ids.size(), plan.size());
  EXPECT_EQ(scenarios.size(), plan.size());
}

TEST(Matrix, CallsAScenarioByItsName) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "file.yaml").string();
  std::ofstream(file) << "name: my_left\nnetwork: roundabout\nroute: {edges: [a]}\n";
  MatrixOptions matrix;
  matrix.scenarios = {file, "arterial_exit"};
  const std::vector<PlannedRun> plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].factors.at("scenario"), "my_left");
  EXPECT_EQ(plan[1].factors.at("scenario"), "arterial_exit");
  fs::copy_file(file, folder.path() / "copy.yaml");
  matrix.scenarios = {file, (folder.path() / "copy.yaml").string()};
  expectIn("a name of its own", errorOf(matrix));
}

// The same text as when the scenario is resolved for each seed on its own.
TEST(Matrix, EachSeedIsResolvedAsIfAlone) {
  MatrixOptions matrix = oneScenario();
  matrix.seeds = {"3", "007", "12"};
  const std::vector<PlannedRun> together = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(together.size(), 3U);
  for (std::size_t i = 0; i < together.size(); ++i) {
    MatrixOptions alone = oneScenario();
    alone.seeds = {matrix.seeds[i]};
    EXPECT_EQ(planRuns(alone, "matrix.yaml")[0].scenario_text, together[i].scenario_text);
    EXPECT_EQ(planRuns(alone, "matrix.yaml")[0].factors, together[i].factors);
  }
  matrix.set = {"seed=3"};  // ranks above the seeds, so all three are the same run, as with 5
  EXPECT_NE(errorOf(matrix), "");
  matrix.set = {"seed=5"};
  EXPECT_NE(errorOf(matrix).find("a run is planned twice"), std::string::npos) << errorOf(matrix);
}

TEST(Matrix, TooManyRunsAreRefusedBeforeAnyIsResolved) {
  MatrixOptions matrix;
  matrix.scenarios = {"no_such_scenario"};
  matrix.repetitions = 1000;
  for (int seed = 0; seed < 101; ++seed) matrix.seeds.push_back(std::to_string(seed));
  expectIn(
      "101000 runs would be planned (1 scenarios x 1 combinations of planners, modes, "
      "methods and profiles x 1 variants x 101 seeds x 1000 repetitions); at most 100000",
      errorOf(matrix));
  matrix.ego_planners.assign(1000, "pdm_lite");
  matrix.cbv_planners.assign(1000, "pdm_lite");
  expectIn("give 1000000 combinations; at most 100000 runs were expected", errorOf(matrix));
}

INSTANTIATE_TEST_SUITE_P(All, ShippedMatrix, testing::ValuesIn(shippedMatrices()),
                         [](const auto& info) { return info.param; });

TEST(ShippedMatrices, HaveTheRunsThatTheyPromise) {
  EXPECT_EQ(planRuns(loadMatrix("smoke"), "smoke").size(), 2U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("guidance_effect"), "").size(), 10U * 3U * 7U);
  EXPECT_EQ(planRuns(loadMatrix("development"), "").size(), 10U * 3U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("ten_scenarios"), "").size(), 10U * 3U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("conditioning_effect"), "").size(), 10U * 3U * 9U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("image_effect"), "").size(), 10U * 3U * 4U);
  EXPECT_EQ(planRuns(loadMatrix("sampler_effect"), "").size(), 10U * 3U * 3U);
  EXPECT_EQ(planRuns(loadMatrix("paper_tables"), "").size(), 10U * 5U * 46U);
  EXPECT_EQ(planRuns(loadMatrix("cbv_baselines"), "").size(), 10U * 3U * 7U);
  EXPECT_EQ(planRuns(loadMatrix("ego_baselines"), "").size(), 10U * 3U * 8U);
  EXPECT_EQ(planRuns(loadMatrix("main_rows"), "").size(), 10U * 5U * 5U);
  EXPECT_EQ(planRuns(loadMatrix("default_choice"), "").size(), 10U * 3U * 4U);
  EXPECT_EQ(planRuns(loadMatrix("cbv_choice"), "").size(), 10U * 3U * 2U * 3U);
  EXPECT_EQ(planRuns(loadMatrix("attack_effect"), "").size(), 10U * 5U * 2U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("realism_matched"), "").size(), 10U * 4U * 2U);
  EXPECT_EQ(planRuns(loadMatrix("realism_steps"), "").size(), 10U * 6U * 2U);
}

TEST(ShippedMatrices, CbvPlannersHasEveryPlannerThatDrivesCbvs) {
  std::vector<std::string> names;
  for (const planning::PlannerDescriptor& planner : planners::packagePlanners()) {
    if (planner.drives_cbv) names.push_back(planner.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(loadMatrix("cbv_planners").cbv_planners, names);
}

/// What a matrix with this planner in a role is told, for planners of one role alone.
TEST(Plan, RefusesAPlannerInARoleThatItDoesNotHave) {
  std::size_t refused = 0;
  for (const planning::PlannerDescriptor& planner : planners::packagePlanners()) {
    MatrixOptions matrix = oneScenario();
    if (!planner.drives_ego) matrix.ego_planners = {"pdm_lite", planner.name};
    if (!planner.drives_cbv) matrix.cbv_planners = {"pdm_lite", planner.name};
    if (planner.drives_ego && planner.drives_cbv) continue;
    ++refused;
    const std::string role = planner.drives_cbv ? "the ego" : "CBVs";
    expectIn("matrix.yaml, scenario arterial_exit: ", errorOf(matrix));
    expectIn("'" + planner.name + "', a planner that does not drive " + role +
                 "; expected one of careful_driver, constant, diffusion, pdm_lite, ",
             errorOf(matrix));
  }
  EXPECT_GT(refused, 0U);
}

// The guidance profile follows the mode, and has its name.
TEST(Plan, NamesNothingTwice) {
  MatrixOptions matrix = oneScenario();
  matrix.modes = {"naturalistic", "safety_critical"};
  const auto plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].factors.at("guidance_profile"), "naturalistic");
  EXPECT_EQ(plan[0].id, "arterial_exit__naturalistic");
  EXPECT_EQ(plan[1].id, "arterial_exit__safety_critical");
  matrix.guidance_profiles = {"naturalistic", "none"};
  EXPECT_EQ(planRuns(matrix, "matrix.yaml")[0].id, "arterial_exit__naturalistic__naturalistic")
      << "the profile tells runs apart";
}

TEST(Plan, IsTheProductOfItsFactors) {
  MatrixOptions matrix = oneScenario();
  matrix.seeds = {"1", "2"};
  matrix.variants = {"slow: target_speed=4 protocol.time_limit=3", "fast: target_speed=9"};
  matrix.repetitions = 2;
  matrix.set = {"protocol.time_limit=5"};
  const auto plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 8U);
  EXPECT_EQ(plan[0].id, "arterial_exit__slow__seed1__repetition1");
  EXPECT_EQ(plan[7].id, "arterial_exit__fast__seed2__repetition2");
  EXPECT_EQ(plan[7].factors.at("cbv_planner"), session::ScenarioOptions().cbv_planner);
  expectIn("target_speed: 4\n", plan[0].scenario_text);
  expectIn("time_limit: 3\n", plan[0].scenario_text);  // a variant goes over set
  expectIn("time_limit: 5\n", plan[7].scenario_text);
  EXPECT_EQ(plan[0].scenario_sha256, plan[1].scenario_sha256);
  EXPECT_NE(plan[0].scenario_sha256, plan[2].scenario_sha256);
}

TEST(Plan, BaselinesAreTheConstantPlannerAtTwoSpeeds) {
  for (const std::string role : {"cbv", "ego"}) {
    MatrixOptions matrix = oneScenario();
    matrix.variants = loadMatrix(role + "_baselines").variants;
    matrix.variants.resize(2);
    const auto plan = planRuns(matrix, "matrix.yaml");
    ASSERT_EQ(plan.size(), 2U);
    EXPECT_EQ(plan[0].factors.at("variant"), "stands_still");
    expectIn("\nconstant:\n  speed: 0\n", plan[0].scenario_text);
    EXPECT_EQ(plan[1].factors.at("variant"), "constant_speed");
    expectIn("\nconstant:\n  speed: 8\n", plan[1].scenario_text);
    for (const PlannedRun& run : plan) EXPECT_EQ(run.factors.at(role + "_planner"), "constant");
  }
}

TEST(Plan, TakesCombinationsInsteadOfAProduct) {
  MatrixOptions matrix = oneScenario();
  matrix.combinations = {"cbv_planner=pdm_lite",
                         "ego_planner=diffusion cbv_planner=diffusion mode=safety_critical "
                         "method=paper guidance_profile=none"};
  matrix.seeds = {"1", "2"};
  const auto plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 4U);
  EXPECT_EQ(plan[0].factors.at("cbv_planner"), "pdm_lite");
  EXPECT_EQ(plan[0].factors.at("mode"), session::ScenarioOptions().mode);
  EXPECT_EQ(plan[3].factors.at("ego_planner"), "diffusion");
  EXPECT_EQ(plan[3].factors.at("mode"), "safety_critical");
  EXPECT_EQ(plan[0].factors.at("method"), "default");
  EXPECT_EQ(plan[3].factors.at("method"), "paper");
  EXPECT_EQ(plan[3].factors.at("guidance_profile"), "none");
  expectIn("conditioning: \"image\"\n", plan[3].scenario_text);
  matrix.set = {"method=paper"};  // ranks above the levels, as overrides of seeds and planners do
  EXPECT_EQ(planRuns(matrix, "matrix.yaml")[0].factors.at("method"), "paper");
  matrix.set = {};
  matrix.modes = {"naturalistic"};
  expectIn("key 'combinations' replaces ego_planners", errorOf(matrix));
  matrix.modes = {};
  matrix.combinations = {"cbv_planner=pdm_lite seed=4"};
  expectIn("where 'seed=4' is wrong", errorOf(matrix));
  matrix.combinations = {"cbv_planner=pdm_lit"};
  expectIn("did you mean 'pdm_lite'", errorOf(matrix));
}

TEST(Plan, AVariantThatACombinationNamesIsRunWithThatOneAlone) {
  MatrixOptions matrix = oneScenario();
  matrix.combinations = {"cbv_planner=pdm_lite", "cbv_planner=constant variant=slow"};
  matrix.variants = {"slow: target_speed=4"};
  auto plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].factors.at("variant"), "");
  EXPECT_EQ(plan[0].factors.at("cbv_planner"), "pdm_lite");
  expectIn("target_speed: 8\n", plan[0].scenario_text);
  EXPECT_EQ(plan[1].factors.at("variant"), "slow");
  EXPECT_EQ(plan[1].factors.at("cbv_planner"), "constant");
  expectIn("target_speed: 4\n", plan[1].scenario_text);
  // One that no combination names goes with all that name none.
  matrix.variants.emplace_back("fast: target_speed=9");
  plan = planRuns(matrix, "matrix.yaml");
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].factors.at("variant"), "fast");
  matrix.combinations.emplace_back("cbv_planner=diffusion variant=slov");
  expectIn("names variant 'slov', which key 'variants' does not hold", errorOf(matrix));
}

TEST(Plan, NamesWhatIsWrong) {
  expectIn("the matrix is empty", errorOf(MatrixOptions()));
  MatrixOptions matrix = oneScenario();
  matrix.scenarios.emplace_back("arterial_exits");
  expectIn("the nearest shipped one is 'arterial_exit'", errorOf(matrix));
  matrix = oneScenario();
  matrix.seeds = {"1", "two"};
  expectIn("matrix.yaml: key 'seeds' holds 'two'", errorOf(matrix));
  matrix.seeds = {"9999999999"};
  expectIn("2147483647", errorOf(matrix));
  matrix = oneScenario();
  matrix.cbv_planners = {"pdm_lit"};
  expectIn("did you mean 'pdm_lite'", errorOf(matrix));
  matrix = oneScenario();
  matrix.variants = {"target_speed=4"};
  expectIn("expected \"name: key=value key=value\"", errorOf(matrix));
  matrix.variants = {"slow: target_sped=4"};
  expectIn("the nearest known key is 'target_speed'", errorOf(matrix));
}

// Two planners x two modes x two seeds: PDM-Lite cannot attack.
TEST(Plan, LeavesOutWhatDoesNotFitTogether) {
  MatrixOptions matrix = oneScenario();
  matrix.cbv_planners = {"diffusion", "pdm_lite"};
  matrix.modes = {"naturalistic", "safety_critical"};
  matrix.seeds = {"1", "2"};
  std::vector<std::string> left_out;
  const auto plan = planFittingRuns(matrix, "matrix.yaml", left_out);
  EXPECT_EQ(plan.size(), 6U);
  ASSERT_EQ(left_out.size(), 1U);
  expectIn("2 runs of matrix.yaml: key 'mode' is 'safety_critical'", left_out[0]);
  expectIn("'pdm_lite'", left_out[0]);
  expectIn("scenario arterial_exit: key 'mode' is 'safety_critical'", errorOf(matrix));  // strict
  matrix.cbv_planners = {"pdm_lite"};
  matrix.modes = {"safety_critical"};
  EXPECT_THROW(planFittingRuns(matrix, "matrix.yaml", left_out), core::InputError);
  matrix.cbv_planners = {"pdm_lit"};  // wrong by itself
  EXPECT_THROW(planFittingRuns(matrix, "matrix.yaml", left_out), core::InputError);
}

TEST(Plan, ARunIsPlannedOnce) {
  MatrixOptions matrix = oneScenario();
  matrix.seeds = {"1", "2", "1"};
  expectIn("matrix.yaml: a run is planned twice: scenario arterial_exit", errorOf(matrix));
  expectIn("seed 1", errorOf(matrix));
  matrix = oneScenario();
  matrix.scenarios.push_back(matrix.scenarios.front());
  expectIn("planned twice", errorOf(matrix));
  matrix = oneScenario();
  matrix.combinations = {"mode=naturalistic", "mode=naturalistic guidance_profile=naturalistic"};
  expectIn("guidance_profile naturalistic", errorOf(matrix));
  matrix = oneScenario();
  matrix.variants = {"slow: target_speed=4", "slow: target_speed=5"};
  expectIn("variant slow", errorOf(matrix));
  matrix = oneScenario();
  matrix.repetitions = 2;
  EXPECT_EQ(planRuns(matrix, "matrix.yaml").size(), 2U);
}

TEST(Matrix, ResolvesFilesAgainstItsFolder) {
  const test::TemporaryFolder scratch;
  std::ofstream(scratch.path() / "mine.yaml") << "network: arterial_merge\n";
  std::ofstream(scratch.path() / "matrix.yaml") << "scenarios: [mine.yaml, arterial_exit]\n";
  const MatrixOptions matrix = loadMatrix((scratch.path() / "matrix.yaml").string());
  EXPECT_EQ(matrix.scenarios[0], fs::weakly_canonical(scratch.path() / "mine.yaml").string());
  EXPECT_EQ(matrix.scenarios[1], "arterial_exit");
}

TEST(Matrix, IdentityForgetsWhatAResumptionMayChange) {
  MatrixOptions matrix = oneScenario();
  const std::string identity = identityOf(matrix);
  matrix.timeout = 5.0;
  matrix.retries = 7;
  EXPECT_EQ(identityOf(matrix), identity);
  matrix.seeds = {"5"};
  EXPECT_NE(identityOf(matrix), identity);
}

}  // namespace
}  // namespace cdiff::evaluation
