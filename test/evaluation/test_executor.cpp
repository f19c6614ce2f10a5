// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <thread>

#include "core/file.h"
#include "core/output_folder.h"
#include "diffusion/model.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"
#include "evaluation/fake_runs.h"
#include "planners/diffusion/diffusion_options.h"
#include "support/processes.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

class ExecutorTest : public testing::Test {
 protected:
  ExecutorTest() {
    options_.program = scratch_.path() / "program.sh";
    options_.results = scratch_.path();
    options_.timeout = 30.0;
    options_.jobs = 2;
    options_.ended = [this](const RunRecord& record) { ends_[record.id] = false; };
    options_.kept = [this](const RunRecord& record) { ends_[record.id] = true; };
    test::writeFakeProgram(options_.program);
  }
  std::vector<RunRecord> execute(const std::vector<PlannedRun>& runs) {
    return executeRuns(runs, options_, stop_);
  }
  fs::path file(const std::string& id, const std::string& name) const {
    return runFolder(options_.results, id) / name;
  }
  std::size_t attempts(const std::string& id) const {
    return core::readFile(file(id, "attempts"), "attempts").size() / 8;  // "attempt\n"
  }
  test::TemporaryFolder scratch_;
  ExecutorOptions options_;
  std::atomic<bool> stop_{false};
  std::map<std::string, bool> ends_;  ///< by id: whether it was complete before
};

TEST_F(ExecutorTest, RecordsEveryRunInTheOrderOfThePlan) {
  const auto records = execute(test::fakePlan({"good", "refuses", "half", "good"}));
  ASSERT_EQ(records.size(), 4U);
  EXPECT_EQ(records[0].status, "completed");
  EXPECT_TRUE(records[0].has(record::Outcome::kPassed));
  EXPECT_DOUBLE_EQ(records[0].measures.at("ego_driving_score"), 80.0);
  EXPECT_DOUBLE_EQ(records[0].simulated_seconds, 4.0);
  EXPECT_EQ(records[1].status, "error");
  EXPECT_EQ(records[1].cause, "exit code 3: cdiff: key 'x' is wrong");
  EXPECT_EQ(records[1].attempts, 1);  // wrong input stays wrong
  EXPECT_EQ(records[2].status, "error");
  EXPECT_NE(records[2].cause.find("is no summary of a session"), std::string::npos);
  EXPECT_EQ(readRecords(options_.results).size(), 4U);
  EXPECT_EQ(readRecord(file("good0", "record.json"))->measures, records[0].measures);
  EXPECT_EQ(ends_.size(), 4U);
}

// By a hash of the ids, since they are of one system and scenario.
TEST_F(ExecutorTest, RunsInTheOrderOfASample) {
  options_.jobs = 1;
  std::vector<std::string> ended;
  options_.ended = [&](const RunRecord& record) { ended.push_back(record.id); };
  execute(test::fakePlan(std::vector<std::string>(6, "good")));
  EXPECT_EQ(ended,
            (std::vector<std::string>{"good3", "good1", "good0", "good5", "good4", "good2"}));
}

TEST_F(ExecutorTest, RunsOnlyWhatIsChosenAndLeavesTheRestForLater) {
  const std::vector<PlannedRun> runs = test::fakePlan({"good", "good", "good"});
  options_.chosen = [](const PlannedRun& run) { return run.id == "good1"; };
  auto records = execute(runs);
  EXPECT_EQ(records[0].status, "not_run");
  EXPECT_EQ(records[1].status, "completed");
  EXPECT_EQ(readRecord(file("good2", "record.json"))->status, "not_run");
  EXPECT_EQ(ends_.size(), 1U);
  options_.resume = true;
  options_.chosen = [](const PlannedRun& run) { return run.id == "good2"; };
  records = execute(runs);
  EXPECT_EQ(records[1].status, "completed") << "what was run before counts";
  EXPECT_EQ(ends_.count("good1"), 1U);
  options_.chosen = {};
  records = execute(runs);
  for (const PlannedRun& run : runs) EXPECT_EQ(attempts(run.id), 1U) << run.id;
  EXPECT_EQ(records[0].status, "completed");
}

// A batch that was killed between giving a record its name and taking its part off the folder's
// list.
TEST_F(ExecutorTest, TakesAwayWhatAKilledBatchLeftBesideAResult) {
  const std::vector<PlannedRun> runs = test::fakePlan({"good"});
  execute(runs);
  core::OutputFolder(runFolder(options_.results, "good0")).claim("record.json.part");
  options_.resume = true;
  execute(runs);
  EXPECT_EQ(attempts("good0"), 1U);
  EXPECT_FALSE(core::OutputFolder::lists(runFolder(options_.results, "good0"), "record.json.part"));
}

TEST_F(ExecutorTest, RefusesToResumeARunThatHadAnotherName) {
  std::vector<PlannedRun> runs = test::fakePlan({"good"});
  execute(runs);
  runs[0].id = "renamed";
  options_.resume = true;
  EXPECT_THROW(execute(runs), core::InputError);
  EXPECT_EQ(readRecords(options_.results).size(), 1U);
  runs[0].factors["scenario"] = "y";  // another run
  EXPECT_EQ(execute(runs)[0].status, "completed");
}

TEST_F(ExecutorTest, RunsAgainWhatHasLostItsTrace) {
  const auto runs = test::fakePlan({"good"});
  execute(runs);
  fs::remove(file("good0", "trace.csv"));
  options_.resume = true;
  std::string cause;
  options_.repeated = [&](const std::string& why, const auto&) { cause = why; };
  EXPECT_EQ(execute(runs)[0].status, "completed");
  EXPECT_EQ(cause, "trace.csv missing");
  EXPECT_TRUE(fs::exists(file("good0", "trace.csv")));
}

TEST_F(ExecutorTest, WhatIsNotChosenCountsUnlessItsScenarioChanged) {
  std::vector<PlannedRun> runs = test::fakePlan({"good"});
  execute(runs);
  runs[0].inputs = {{"program", "later"}};
  options_.resume = true;
  options_.chosen = [](const PlannedRun&) { return false; };
  options_.repeated = [](const std::string& cause, const auto&) { ADD_FAILURE() << cause; };
  EXPECT_EQ(execute(runs)[0].status, "completed") << "by an earlier program";
  EXPECT_EQ(readRecord(file("good0", "record.json"))->status, "completed");
  runs[0].scenario_sha256 = core::sha256("changed");
  EXPECT_EQ(execute(runs)[0].status, "not_run");
  EXPECT_EQ(readRecord(file("good0", "record.json"))->status, "not_run");
}

TEST_F(ExecutorTest, TriesAgainWhenAProcessDied) {
  options_.retries = 2;
  const auto records = execute(test::fakePlan({"dies", "dies_once"}));
  EXPECT_EQ(records[0].status, "error");
  EXPECT_EQ(records[0].cause, "the process ended by signal 9");
  EXPECT_EQ(records[0].attempts, 3);
  EXPECT_EQ(attempts("dies0"), 3U);
  EXPECT_EQ(records[1].status, "completed");
  EXPECT_EQ(records[1].attempts, 2);
  EXPECT_EQ(records[1].cause, "");
}

TEST_F(ExecutorTest, RunsAgainWhatHasOtherInputsAndSaysWhy) {
  std::vector<PlannedRun> runs = test::fakePlan({"good", "good", "good", "good", "refuses"});
  for (PlannedRun& run : runs) run.inputs = {{"network", "n"}, {"weights", "w"}, {"program", "p"}};
  execute(runs);
  runs[0].inputs["weights"] = "other";
  runs[1].inputs["weights"] = "other";
  runs[2].inputs = {{"network", "n"}, {"weights", "w"}, {"program", "later"}, {"demand", "d"}};
  std::map<std::string, std::vector<std::string>> repeated;
  options_.resume = true;
  options_.repeated = [&](const std::string& cause, const std::vector<std::string>& ids) {
    repeated[cause] = ids;
  };
  const auto records = execute(runs);
  const std::map<std::string, std::vector<std::string>> expected = {
      {"weights changed", {"good0", "good1"}},
      {"demand, program changed", {"good2"}},
      {"status error", {"refuses4"}}};
  EXPECT_EQ(repeated, expected);
  EXPECT_EQ(attempts("good0"), 2U);
  EXPECT_EQ(attempts("good2"), 2U);
  EXPECT_EQ(attempts("good3"), 1U);
  EXPECT_EQ(records[0].inputs.at("weights"), "other");
  EXPECT_EQ(readRecord(file("good0", "record.json"))->inputs, records[0].inputs);
}

TEST_F(ExecutorTest, ARecordWithoutHashesIsRunAgain) {
  std::vector<PlannedRun> runs = test::fakePlan({"good"});
  execute(runs);
  runs[0].inputs = {{"program", "p"}};
  options_.resume = true;
  execute(runs);
  EXPECT_EQ(attempts("good0"), 2U);
}

TEST(RunInputs, HashTheContentOfTheFilesThatAScenarioNames) {
  const test::TemporaryFolder folder;
  const fs::path demand = folder.path() / "demand.rou.xml";
  std::ofstream(demand) << "<routes/>";
  session::ScenarioOptions options = session::loadScenario("arterial_exit");
  options.cbv_planner = "pdm_lite";
  options.demand = "generated";
  const InputHashes plain = InputHasher().hashes(options);
  EXPECT_EQ(
      plain.at("network"),
      core::sha256(core::readFile(
          core::shareFolder() / "networks/arterial_merge/arterial_merge.net.xml", "network")));
  EXPECT_EQ(plain.at("program").size(), 64U);
  EXPECT_EQ(plain.count("cbv_weights") + plain.count("demand"), 0U);
  options.demand = demand.string();
  options.cbv_planner = "diffusion";
  const InputHashes more = InputHasher().hashes(options);
  EXPECT_EQ(more.at("demand"), core::sha256("<routes/>"));
  EXPECT_EQ(
      more.at("cbv_weights"),
      diffusion::modelFilesSha256(options.planner_options.of<planners::DiffusionOptions>().model));
  EXPECT_EQ(changedInputs(plain, more), "cbv_weights, demand");
  EXPECT_EQ(changedInputs(more, more), "");
}

TEST(RunInputs, HashAStoryboardWithItsCatalogs) {
  const test::TemporaryFolder folder;
  const fs::path shipped = core::shareFolder() / "config/openscenario";
  fs::copy(shipped, folder.path() / "story", fs::copy_options::recursive);
  session::ScenarioOptions options = session::loadScenario("arterial_exit");
  options.storyboard.file = (folder.path() / "story/cut_in.xosc").string();
  const InputHashes before = InputHasher().hashes(options);
  std::ofstream(folder.path() / "story/catalogs/unused.xosc") << "<OpenSCENARIO/>";
  const InputHashes now = InputHasher().hashes(options);
  EXPECT_EQ(changedInputs(before, now), "storyboard");
}

TEST_F(ExecutorTest, KillsALateRunWithAllThatItStarted) {
  options_.timeout = 5.0;
  const auto records = execute(test::fakePlan({"hang", "good"}));
  EXPECT_EQ(records[0].status, "error");
  EXPECT_EQ(records[0].cause, "timed out: killed after 5 s");
  EXPECT_EQ(records[0].attempts, 1);
  EXPECT_EQ(records[1].status, "completed");
  const pid_t process = std::stoi(core::readFile(file("hang0", "child"), "child"));
  for (int i = 0; i < 100 && test::isAlive(process); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(test::isAlive(process)) << "process " << process << " still runs";
}

TEST_F(ExecutorTest, ResumesWhatIsNotComplete) {
  auto runs = test::fakePlan({"good", "good", "good", "refuses"});
  execute(runs);
  fs::remove(file("good1", "record.json"));  // cut off before its record
  runs[2].scenario_sha256 = core::sha256("changed");
  options_.resume = true;
  ends_.clear();
  const auto records = execute(runs);
  EXPECT_EQ(attempts("good0"), 1U);
  EXPECT_EQ(attempts("good1"), 2U);
  EXPECT_EQ(attempts("good2"), 2U);
  EXPECT_EQ(attempts("refuses3"), 2U);
  EXPECT_TRUE(ends_.at("good0"));
  EXPECT_FALSE(ends_.at("good1"));
  EXPECT_DOUBLE_EQ(records[0].measures.at("ego_driving_score"), 80.0);
  EXPECT_EQ(records[2].scenario_sha256, runs[2].scenario_sha256);
}

TEST_F(ExecutorTest, RefusesADamagedRecordBeforeAnythingRuns) {
  const auto runs = test::fakePlan({"good", "good"});
  execute(runs);
  fs::remove(file("good0", "record.json"));
  std::ofstream(file("good1", "record.json")) << R"({"id": "good1", "fact)";
  options_.resume = true;
  try {
    execute(runs);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("good1/record.json' is no record of a run"), std::string::npos) << text;
    EXPECT_NE(text.find("delete the file to have the run repeated"), std::string::npos) << text;
  }
  EXPECT_EQ(attempts("good0"), 1U);
  EXPECT_THROW(readRecords(options_.results), core::InputError);
}

TEST_F(ExecutorTest, ClearsAwayWhatACutOffRunLeft) {
  const auto runs = test::fakePlan({"good"});
  execute(runs);
  const fs::path half = file("good0", "trace.csv.part");
  const fs::path mine = file("good0", "notes.part");
  std::ofstream(core::OutputFolder(half.parent_path()).claim("trace.csv.part")) << "half";
  std::ofstream(mine) << "mine";
  execute(runs);
  EXPECT_FALSE(fs::exists(half));
  EXPECT_TRUE(fs::exists(mine));
}

TEST_F(ExecutorTest, StopsWithARecordOfWhatIsDone) {
  // The first run ends; the second is under way when the stop comes; the third never starts.
  options_.jobs = 1;
  std::thread stopper([this] {
    while (!fs::exists(file("polite1", "ready")))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_ = true;
  });
  const auto records = execute(test::fakePlan({"good", "polite", "good"}));
  stopper.join();
  EXPECT_EQ(records[0].status, "completed");
  EXPECT_EQ(records[1].status, "interrupted");
  EXPECT_EQ(records[2].status, "not_run");
  EXPECT_FALSE(fs::exists(file("good2", "attempts")));
  EXPECT_EQ(readRecord(file("polite1", "record.json"))->status, "interrupted");
  EXPECT_EQ(readRecord(file("good2", "record.json"))->status, "not_run");
  EXPECT_EQ(readRecords(options_.results).size(), 3U);  // every planned run
}

TEST_F(ExecutorTest, KillsWhatDoesNotEndInTheGraceAfterAStop) {
  options_.grace = 0.2;
  std::thread stopper([this] {
    while (!fs::exists(file("hang0", "child")))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_ = true;
  });
  const auto records = execute(test::fakePlan({"hang"}));
  stopper.join();
  EXPECT_EQ(records[0].status, "interrupted");
}

}  // namespace
}  // namespace cdiff::evaluation
