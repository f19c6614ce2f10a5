// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Workers that share a plan: each run has one result, whatever happens to a worker.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <thread>

#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"
#include "evaluation/fake_runs.h"
#include "evaluation/plan_file.h"
#include "evaluation/worker.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

class WorkerTest : public testing::Test {
 protected:
  WorkerTest() {
    options_.program = scratch_.path() / "program.sh";
    options_.results = scratch_.path();
    options_.timeout = 60.0;
    test::writeFakeProgram(options_.program);
  }
  /// As `cdiff evaluate` plans it.
  void announce(const std::vector<std::string>& ways) {
    plan_ = test::fakePlan(ways);
    ExecutorOptions options;
    static_cast<WorkerOptions&>(options) = options_;
    Executor executor(plan_, options);
    executor.announce();
    ids_ = executor.queue();
  }
  void work() { runPlanned(ids_, options_, stop_); }
  fs::path file(const std::string& id, const std::string& name) const {
    return runFolder(options_.results, id) / name;
  }
  RunRecord record(const std::string& id) const { return *readRecord(file(id, "record.json")); }
  std::size_t starts(const std::string& id) const {
    return core::readFile(file(id, "attempts"), "attempts").size() / 8;  // "attempt\n"
  }
  /// A process that works on the plan until a session of the run `id` hangs, and is killed then.
  void workAndBeKilledIn(const std::string& id) {
    const pid_t child = ::fork();
    if (child == 0) {
      work();
      ::_exit(0);
    }
    while (!fs::exists(file(id, "child")))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  /// Lets the run end the next time it is started.
  void mend(const std::string& id) const { core::writeOwnFile(file(id, "scenario.yaml"), "good"); }
  test::TemporaryFolder scratch_;
  WorkerOptions options_;
  std::vector<PlannedRun> plan_;
  std::set<std::string> causes_;  ///< of repeated runs
  std::vector<std::string> ids_;
  std::atomic<bool> stop_{false};
};

TEST_F(WorkerTest, ManyOnOnePlanRunEachRunOnce) {
  announce(std::vector<std::string>(20, "good"));
  std::vector<std::thread> workers;
  for (int i = 0; i < 3; ++i) workers.emplace_back([this] { work(); });
  for (std::thread& worker : workers) worker.join();
  for (const std::string& id : ids_) {
    EXPECT_EQ(starts(id), 1U) << id;
    EXPECT_EQ(record(id).status, "completed") << id;
  }
  EXPECT_TRUE(fs::is_empty(leaseFolder(options_.results)));
}

TEST_F(WorkerTest, KilledBetweenClaimAndRecordLeavesTheRunToTheNext) {
  announce({"hang", "good"});
  workAndBeKilledIn("hang0");
  EXPECT_EQ(record("hang0").status, "not_run");
  mend("hang0");
  work();
  EXPECT_EQ(record("hang0").status, "completed");
  EXPECT_EQ(record("hang0").attempts, 1) << "as of a run that was never cut off";
  EXPECT_EQ(starts("good1"), 1U);
}

/// A lease of another host, which may be alive.
void writeForeignLease(const fs::path& results, const std::string& id) {
  fs::create_directories(leaseFolder(results));
  std::ofstream(leaseFolder(results) / (id + ".1"))
      << "host: other\nprocess: 1\nprogram: cdiff worker\nsince: 2099-01-01 00:00:00\nboot: other\n"
      << "beat: 000000000001\n";
}

// Another worker that takes a run over moves its folder, and may be killed meanwhile.
TEST_F(WorkerTest, AFolderThatIsBeingMovedIsAnothersOrPutInPlace) {
  announce({"good", "good"});
  writeForeignLease(options_.results, "good0");
  const fs::path next = options_.results / kLeftBehindFolder / ".next.good0";
  fs::create_directories(next.parent_path());
  fs::rename(runFolder(options_.results, "good0"), next);
  work();
  EXPECT_EQ(record("good1").status, "completed");
  EXPECT_FALSE(fs::exists(file("good0", ""))) << "another has it";
  fs::remove_all(leaseFolder(options_.results));
  work();
  EXPECT_EQ(record("good0").status, "completed");
  EXPECT_FALSE(fs::exists(next));
}

// The lease of a silent host is gone once another has claimed the run, also one that was killed
// then.
TEST_F(WorkerTest, ATakeOverThatWasCutOffIsBegunAnew) {
  announce({"good"});
  core::OutputFolder(runFolder(options_.results, "good0")).write("summary.json", "late");
  fs::create_directories(options_.results / kLeftBehindFolder / ".next.good0");
  work();
  EXPECT_EQ(record("good0").status, "completed");
  EXPECT_EQ(core::readFile(options_.results / kLeftBehindFolder / "good0" / "summary.json", "late"),
            "late");
}

TEST_F(WorkerTest, WaitsForWhatAnotherHostHasAndTakesItOverOnceItIsSilent) {
  announce({"good"});
  writeForeignLease(options_.results, "good0");
  std::ofstream(file("good0", ".lock"))
      << "host: other\nprocess: 1\nprogram: cdiff run\nsince: 2099-01-01 00:00:00\n";
  work();
  EXPECT_EQ(record("good0").status, "not_run") << "a worker that does not wait leaves it alone";
  options_.waits = true;
  options_.lease.expiry = 0.1;
  // The session of the host that fell silent writes by an object like this one.
  core::OutputFolder silent(file("good0", ""));
  work();
  EXPECT_EQ(record("good0").status, "completed");
  EXPECT_FALSE(fs::exists(file("good0", ".lock")));
  const std::string summary = core::readFile(file("good0", "summary.json"), "summary");
  silent.write("summary.json", "late");
  EXPECT_EQ(core::readFile(file("good0", "summary.json"), "summary"), summary);
  EXPECT_EQ(core::readFile(options_.results / kLeftBehindFolder / "good0" / "summary.json", "late"),
            "late");
}

TEST_F(WorkerTest, RunsWhatAKilledSessionOfAnotherHostHadLocked) {
  announce({"good"});
  std::ofstream(file("good0", ".lock"))
      << "host: other\nprocess: 1\nprogram: cdiff run\nsince: 2099-01-01 00:00:00\n";
  work();
  EXPECT_EQ(record("good0").status, "completed");
  EXPECT_FALSE(fs::exists(file("good0", ".lock")));
}

TEST_F(WorkerTest, ReturnsAnInterruptedRun) {
  announce({"polite"});
  std::thread stopper([this] {
    while (!fs::exists(file("polite0", "ready")))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_ = true;
  });
  work();
  stopper.join();
  EXPECT_EQ(record("polite0").status, "interrupted");
  EXPECT_TRUE(fs::is_empty(leaseFolder(options_.results)));
  stop_ = false;
  mend("polite0");
  work();
  EXPECT_EQ(record("polite0").status, "completed");
}

TEST_F(WorkerTest, WritesNoRecordOfARunThatWasTakenFromIt) {
  announce({"good"});
  const fs::path thief = scratch_.path() / "thief.sh";
  std::ofstream(thief) << "#!/bin/sh\nrm " << leaseFolder(options_.results).string() << "/*\n"
                       << options_.program.string() << " \"$@\"\n";
  fs::permissions(thief, fs::perms::owner_all);
  options_.program = thief;
  work();
  EXPECT_EQ(starts("good0"), 1U);
  EXPECT_EQ(record("good0").status, "not_run");
}

TEST_F(WorkerTest, RunsOtherCommandsAndAsksForTheirFileAlone) {
  options_.program = "/bin/sh";
  plan_ = test::fakePlan({"leaves", "leaves_none", "fails", "elsewhere", "ends_with_1"});
  const std::string scripts[] = {"echo 1 > $0/score.json", "true", "echo no >&2; exit 3",
                                 "echo 1 > $1/shard", "exit 1"};
  for (std::size_t i = 0; i < plan_.size(); ++i)
    plan_[i].command = {{"-c", scripts[i], "{run}", "{results}"}, i < 3 ? "score.json" : ""};
  ExecutorOptions options;
  static_cast<WorkerOptions&>(options) = options_;
  const auto records = executeRuns(plan_, options, stop_);
  EXPECT_EQ(records[0].status, "completed");
  EXPECT_EQ(records[0].verdict, record::Outcome::kNotJudged);
  EXPECT_EQ(records[1].cause, "the run left no score.json");
  EXPECT_EQ(records[2].exit_code, 3);
  EXPECT_EQ(records[2].cause, "exit code 3: no");
  EXPECT_EQ(records[3].status, "completed");
  EXPECT_EQ(records[4].status, "error") << "1 is a verdict of sessions alone";
  EXPECT_TRUE(fs::exists(options_.results / "shard"));
  EXPECT_TRUE(record("leaves0").command == plan_[0].command) << "as a worker elsewhere reads it";
  EXPECT_THROW(readRecords(options_.results), core::InputError) << "none is of a session";
  options.resume = true;
  plan_[0].command.words[1] += "; true";
  options.repeated = [&](const std::string& cause, const std::vector<std::string>&) {
    causes_.insert(cause);
  };
  executeRuns(plan_, options, stop_);
  EXPECT_EQ(causes_, (std::set<std::string>{"command changed", "status error"}));
}

TEST_F(WorkerTest, RefusesAPlanOfAnotherBuildOrMachine) {
  announce({"good"});
  PlanFile plan = readPlan(options_.results);
  EXPECT_NO_THROW(requireSameProgram(plan));
  EXPECT_EQ(plan.ids, ids_);
  plan.instruction_sets = "another";
  EXPECT_THROW(requireSameProgram(plan), core::InputError);
  plan = readPlan(options_.results);
  plan.program = std::string(64, '0');
  EXPECT_THROW(requireSameProgram(plan), core::InputError);
}

TEST_F(WorkerTest, RefusesAFolderWithoutPlanAndADamagedPlan) {
  EXPECT_THROW(readPlan(scratch_.path() / "nothing"), core::InputError);
  std::ofstream(scratch_.path() / PlanFile::kName) << R"({"schema_version": 1})";
  EXPECT_THROW(readPlan(scratch_.path()), core::InputError);
  fs::remove(scratch_.path() / PlanFile::kName);
  const auto reads = [&](const std::string& version, double timeout, int retries,
                         const std::string& id) {
    PlanFile plan;
    plan.timeout = timeout;
    plan.retries = retries;
    plan.ids = {id};
    writePlan(scratch_.path(), plan);
    const fs::path file = scratch_.path() / PlanFile::kName;
    std::string text = core::readFile(file, "plan");
    text.replace(text.find("1,"), 1, version);
    core::writeOwnFile(file, text);
    readPlan(scratch_.path());
  };
  EXPECT_NO_THROW(reads("1", 1.0, 0, "a"));
  EXPECT_THROW(reads("2", 1.0, 0, "a"), core::InputError);
  EXPECT_THROW(reads("1", -1.0, 0, "a"), core::InputError);
  EXPECT_THROW(reads("1", 1.0, -1, "a"), core::InputError);
  for (const char* id : {"../a", "..", ""})
    EXPECT_THROW(reads("1", 1.0, 0, id), core::InputError) << id;
}

TEST_F(WorkerTest, ARunWithoutAUsableRecordIsNamedAndTheOthersAreDone) {
  announce({"good", "good", "good", "good", "good"});
  fs::remove(file("good0", "record.json"));
  core::writeFileAtomically(file("good1", "record.json"), "{\"schema_vers");
  std::string text = core::readFile(file("good2", "record.json"), "record");
  text.replace(text.find("not_run"), 7, "bananas");
  core::writeFileAtomically(file("good2", "record.json"), text);
  core::writeFileAtomically(file("good3", "record.json"),
                            core::readFile(file("good4", "record.json"), "record"));
  std::map<std::string, std::string> causes;
  options_.ended = [&](const RunRecord& one) { causes[one.id] = one.cause; };
  work();
  EXPECT_EQ(causes.size(), 5U);
  EXPECT_NE(causes["good0"].find("is missing"), std::string::npos);
  EXPECT_NE(causes["good1"].find("is no record of a run"), std::string::npos);
  EXPECT_NE(causes["good2"].find("'bananas' is no status"), std::string::npos);
  EXPECT_NE(causes["good3"].find("is the record of run 'good4'"), std::string::npos);
  EXPECT_EQ(record("good4").status, "completed");
  EXPECT_TRUE(fs::is_empty(leaseFolder(options_.results)));
}

TEST_F(WorkerTest, EndsTheRunsWhoseScenarioIsNotWhatWasPlannedAndDoesTheOthers) {
  announce({"refuses", "good"});
  core::writeOwnFile(file("refuses0", "scenario.yaml"), "hang");
  const fs::path shipped = core::shareFolder() / "config" / "scenarios" / "arterial_exit.yaml";
  core::writeOwnFile(file("good1", "scenario.yaml"), core::readFile(shipped, "scenario"));
  RunRecord planned = record("good1");
  planned.scenario_sha256 = core::sha256(core::readFile(shipped, "scenario"));
  planned.inputs = InputHasher().hashes(session::loadScenario(shipped.string()));
  core::writeOwnFile(file("good1", "record.json"), recordJson(planned));
  options_.compares_inputs = true;
  std::vector<std::string> ended;
  options_.ended = [&](const RunRecord& one) { ended.push_back(one.id); };
  work();
  EXPECT_EQ(record("refuses0").status, "error");
  EXPECT_EQ(record("refuses0").exit_code, 3);
  EXPECT_EQ(record("refuses0").attempts, 0) << "it was never started";
  EXPECT_EQ(record("good1").attempts, 1);
  EXPECT_EQ(ended.size(), 2U) << "the caller hears of both";
  EXPECT_TRUE(fs::is_empty(leaseFolder(options_.results))) << "the run is free for others";
}

TEST_F(WorkerTest, SaysThatTheSharedFolderIsGone) {
  announce({"good"});
  fs::remove_all(scratch_.path() / "runs");
  EXPECT_THROW(work(), core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
