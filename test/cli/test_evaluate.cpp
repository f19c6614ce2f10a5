// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <signal.h>

#include <set>

#include "cli/evaluate_command.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "evaluation/run_record.h"
#include "session/scenario_options.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using test::EvaluateCommand;

/// A session of 3 simulated seconds.
constexpr const char* kShort = "set: [protocol.time_limit=3, verdict.judge=false]\n";

TEST_F(EvaluateCommand, RunsAMatrixResumesItAndComparesIt) {
  const std::string matrix =
      write("matrix.yaml", std::string("scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n") +
                               kShort +
                               "variants: ['slow: target_speed=3', 'fast: "
                               "target_speed=9']\nseeds: [1, 2]\n");
  const std::string results = folder("results");
  const std::vector<std::string> evaluate = {"evaluate", matrix, "--results", results,
                                             "--jobs",   "2",    "--resume"};
  ASSERT_EQ(cdiff(evaluate), 0) << output();
  expectOutput("4/4 done, 0 broken");
  expectOutput("| scenario | variant | runs |");
  EXPECT_EQ(lines(fs::path(results) / "runs.csv"), 5U);
  for (const char* name : {"matrix.yaml", "summary.json", "summary.md", "junit.xml"})
    EXPECT_TRUE(fs::exists(fs::path(results) / name)) << name;
  const fs::path run = fs::path(results) / "runs" / "arterial_exit__slow__seed2";
  EXPECT_TRUE(fs::exists(run / "trace.csv"));
  EXPECT_EQ(readRecord(run / "record.json")->status, "timed_out");  // the protocol's limit of 3 s
  EXPECT_GT(readRecord(run / "record.json")->measures.at("ego_completion_percent"), 0.0);

  fs::remove(run / "record.json");  // as if the batch had been cut off
  std::vector<std::string> part = evaluate;
  part.insert(part.end(), {"--only", "variant=slow,fast", "--only", "seed=1"});
  ASSERT_EQ(cdiff(part), 0) << output();
  EXPECT_EQ(readRecord(run / "record.json")->status, "not_run");
  part.back() = "seed=3";
  EXPECT_EQ(cdiff(part), 3);
  expectOutput("--only seed=3: no run of the matrix has it; levels are 1, 2");
  part.back() = "seed=";
  EXPECT_EQ(cdiff(part), 3);
  part.back() = "planner=plant";
  EXPECT_EQ(cdiff(part), 3);
  expectOutput(
      "--only 'planner=plant': expected FACTOR=LEVEL[,LEVEL...] with a factor of scenario,");
  ASSERT_EQ(cdiff(evaluate), 0) << output();
  expectOutput("3 runs were complete already");
  EXPECT_TRUE(fs::exists(run / "record.json"));

  ASSERT_EQ(cdiff({"report", "--compare", results, "--factor", "variant", "--baseline", "slow",
                   "--figure", "ego_completion_percent"}),
            0);
  expectOutput("## A = variant slow, B = variant fast");
  expectOutput("| ego_completion_percent | 2 |");
  expectOutput("A and B differ in: variant (A slow, B fast); key target_speed (A 3, B 9).\n");
  EXPECT_EQ(lines(fs::path(results) / "compare.csv"), 2U);
  ASSERT_EQ(cdiff({"report", "--compare", results, results}), 0);
  expectOutput("4 pairs of 4 runs of A and 4 of B: 1 route x 2 seeds;");
  expectOutput("A and B differ in: no factor, key or file.\n");
  expectOutput("Conditions: protocol rift_dev10, time limit 3 s.");
  expectOutput("Warning: only 2 seeds;");
  expectOutput("Multiplicity: of ");
  EXPECT_EQ(
      cdiff({"report", "--compare", results, "--factor", "cbv_planner", "--baseline", "pdm_lite"}),
      3);
  expectOutput("no complete runs to pair");

  // The same results as if driven with a longer time limit.
  const std::string other = folder("other");
  fs::copy(results, other, fs::copy_options::recursive);
  for (const auto& entry : fs::directory_iterator(fs::path(other) / "runs")) {
    if (!entry.is_directory()) continue;
    std::string text = core::readFile(entry.path() / "scenario.yaml", "scenario");
    const std::string limit = "\n  time_limit: 3\n";
    const std::size_t place = text.find(limit);
    ASSERT_NE(place, std::string::npos);
    core::writeFileAtomically(entry.path() / "scenario.yaml",
                              text.replace(place, limit.size(), "\n  time_limit: 4\n"));
  }
  EXPECT_EQ(cdiff({"report", "--compare", results, other}), 3);
  expectOutput("were driven by different protocols: scenario 'arterial_exit'");
  expectOutput("time_limit 3 in A and 4 in B");
  EXPECT_EQ(cdiff({"report", "--compare", run.string(), results}), 3);
  expectOutput("is the result of a single session; --compare pairs the runs of two batches");
}

// Of two planners and two modes one combination does not exist.
TEST_F(EvaluateCommand, LeavesOutWhatDoesNotFitTogetherOrRefusesIt) {
  const std::string matrix =
      write("matrix.yaml", std::string("scenarios: [arterial_exit]\nego_planners: [constant]\n") +
                               "cbv_planners: [two_stage_pid, pdm_lite]\nmodes: [naturalistic, "
                               "safety_critical]\n" +
                               kShort);
  const fs::path results = folder("results");
  EXPECT_EQ(cdiff({"evaluate", matrix, "--results", results.string(), "--strict"}), 3);
  expectOutput("cbv_planner 'pdm_lite' drives naturalistically only");
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", results.string()}), 0) << output();
  expectOutput("left out: 1 run of ");
  expectOutput("(--strict refuses it)");
  expectOutput("3/3 done, 0 broken");
  const std::string page = core::readFile(results / "index.html", "page");
  EXPECT_NE(page.find("Left out: 1 run of "), std::string::npos);
  EXPECT_EQ(page.find("Table 1"), std::string::npos);  // the paper's
  ASSERT_EQ(cdiff({"report", "--compare", results.string(), "--factor", "cbv_planner", "--baseline",
                   "pdm_lite"}),
            0);
  expectOutput("| ego_driving_score | 1 |");
  expectOutput("--all shows them");
  EXPECT_EQ(output().find("| ego_distance_m |"), std::string::npos);
  ASSERT_EQ(cdiff({"evaluate", "--help"}), 0);
  expectOutput("Planners that can attack (mode safety_critical): diffusion, two_stage_pid");
}

TEST_F(EvaluateCommand, TriesAgainWhenSumoDiesAndSaysSo) {
  const std::string sumo = write("sumo", "#!/bin/sh\nexit 1\n");
  fs::permissions(sumo, fs::perms::owner_all);
  const std::string matrix =
      write("matrix.yaml",
            "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nretries: 1\nset: [sumo.binary=" +
                sumo + "]\n");
  EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results")}), 2);
  const auto records = readRecords(folder("results"));
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records.front().status, "error");
  EXPECT_EQ(records.front().attempts, 2);
  EXPECT_NE(records.front().cause.find("SUMO"), std::string::npos) << records.front().cause;
}

TEST_F(EvaluateCommand, EndsCleanlyWhenInterrupted) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nseeds: "
                                   "[1, 2]\nset: [at_most=1]\n");
  const fs::path results = folder("results");
  test::ProgramRun process(CDIFF_PROGRAM, {"evaluate", matrix, "--results", results.string()},
                           scratch_.path() / "output");
  // The first by the hash of its id.
  while (!fs::exists(results / "runs" / "arterial_exit__seed2" / "session.yaml")) {
    ASSERT_FALSE(process.ended()) << output();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  process.signal(SIGINT);
  EXPECT_EQ(process.wait(), 130) << output();
  EXPECT_EQ(lines(results / "runs.csv"), 3U);
  const std::string csv = core::readFile(results / "runs.csv", "runs");
  EXPECT_NE(csv.find(",interrupted,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",not_run,"), std::string::npos) << csv;
}

TEST_F(EvaluateCommand, KillsARunThatTakesTooLong) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\ntimeout: "
                                   "2\nset: [at_most=0.05]\n");
  EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results")}), 2);
  const auto records = readRecords(folder("results"));
  EXPECT_EQ(records.front().cause, "timed out: killed after 2 s");
  EXPECT_EQ(records.front().attempts, 1);
}

TEST_F(EvaluateCommand, RefusesWrongInput) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"scenarios: [arterial_exi]\n", "the nearest shipped one is 'arterial_exit'"},
      {"seeds: [1]\n", "the matrix is empty"},
      {"scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nseed: [1]\n",
       "matrix.yaml:3: unknown key 'seed'"},
      {"scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nseeds: [one]\n",
       "key 'seeds' holds 'one'"},
      {"scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nset: [target_sped=3]\n",
       "'target_speed'"},
      {"scenarios: [arterial_exit]\nset: [protocol=leaderboard_2_1]\n",
       "key 'protocol' is a group of keys and cannot be 'leaderboard_2_1'; set one of its keys: "
       "protocol.preset (one of {any_length, bench2drive, leaderboard_2_0, leaderboard_2_1, "
       "rift_dev10}), "
       "protocol.time_limit"},
      {"scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nset: [real_time_factor=1]\n",
       "needs the node graph"}};
  for (const auto& [text, expected] : cases) {
    const std::string matrix = write("matrix.yaml", text);
    EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results")}), 3) << text;
    expectOutput(expected);
    EXPECT_FALSE(fs::exists(folder("results"))) << text;
  }
  EXPECT_EQ(cdiff({"evaluate", "smok", "--results", folder("results")}), 3);
  expectOutput("the nearest shipped one is 'smoke'");
  EXPECT_EQ(cdiff({"evaluate", "--results", folder("results")}), 3);
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--routes", "1", "--results", folder("results")}), 3);
  expectOutput("--bench2drive");
  EXPECT_FALSE(fs::exists(folder("results")));
  EXPECT_EQ(cdiff({"report", "--compare", folder("nothing"), folder("nothing")}), 3);
  expectOutput("holds no records");
}

TEST_F(EvaluateCommand, OneMoreEgoLeavesTheOthers) {
  const auto runsOf = [&](const std::string& egos, const std::string& ego) {
    const std::string matrix = write("matrix.yaml", "scenarios: [arterial_exit]\n" + egos + kShort);
    fs::remove_all(folder("results"));
    EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results"), "--engine", "print",
                     "--ego", ego}),
              0)
        << output();
    std::multiset<std::string> planners;
    for (const RunRecord& record : readRecords(folder("results")))
      planners.insert(record.factors.at("ego_planner"));
    return planners;
  };
  const std::multiset<std::string> both = {"constant", "pdm_lite"};
  EXPECT_EQ(runsOf("", "constant"), both) << "beside that of the scenario";
  EXPECT_EQ(runsOf("ego_planners: [pdm_lite]\n", "constant"), both);
  EXPECT_EQ(runsOf("ego_planners: [pdm_lite]\n", "constant constant.speed=5"), both);
  EXPECT_EQ(runsOf("ego_planners: [pdm_lite, constant]\n", "constant constant.speed=5").size(), 3U);
}

// A run whose scenario has changed, or has another name by now, counts nowhere.
TEST_F(EvaluateCommand, StaleResultsOfABatchDoNotCount) {
  const auto scenario = [&](const std::string& name, double speed) {
    session::ScenarioOptions options = session::loadScenario("arterial_exit");
    options.name = name;
    options.cbv_planner = "pdm_lite";
    options.target_speed = speed;
    options.protocol.time_limit = 1.0;
    return core::dumpOptions(options);
  };
  write("a.yaml", scenario("a", 5.0));
  write("b.yaml", scenario("b", 5.0));
  const std::string matrix = write("matrix.yaml", "scenarios: [a.yaml, b.yaml]\n");
  const std::vector<std::string> words = {"evaluate", matrix, "--results", folder("results")};
  ASSERT_LE(cdiff(words), 1) << output();
  write("b.yaml", scenario("b", 6.0));
  std::vector<std::string> part = words;
  part.insert(part.end(), {"--resume", "--only", "scenario=a"});
  ASSERT_LE(cdiff(part), 1) << output();
  for (const RunRecord& record : readRecords(folder("results")))
    EXPECT_EQ(record.complete(), record.id.front() == 'a') << record.id;
  write("b.yaml", scenario("c", 5.0));
  part = words;
  part.emplace_back("--resume");
  EXPECT_EQ(cdiff(part), 3);
  expectOutput("holds a run that the matrix does not have any more");
}

TEST_F(EvaluateCommand, ReplacesNoBatchThatItIsToFollowOrEnd) {
  for (const char* end : {"--attach", "--cancel"}) {
    for (const char* run : {"--overwrite", "--resume"})
      EXPECT_EQ(cdiff({"evaluate", "--results", folder("jobs"), end, run}), 3) << end << run;
  }
  EXPECT_FALSE(fs::exists(folder("jobs")));
}

TEST_F(EvaluateCommand, RefusesTheFolderOfASession) {
  fs::create_directories(folder("results"));
  write("results/session.yaml", "scenario: {}\n");
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results")}), 3);
  expectOutput("holds the result of a session");
  EXPECT_FALSE(fs::exists(fs::path(folder("results")) / "matrix.yaml"));
}

TEST_F(EvaluateCommand, RefusesTheFolderOfAnotherMatrix) {
  core::writeOwnFile(folder("results/matrix.yaml"), "name: other\nscenarios: [bends_oncoming]\n");
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results")}), 3);
  expectOutput("holds the results of a batch");
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results"), "--resume"}), 3);
  expectOutput("holds the results of another matrix ('other'");
}

}  // namespace
}  // namespace cdiff::evaluation
