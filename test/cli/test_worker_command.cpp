// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// `cdiff worker` on a plan that was printed for other engines.
#include <signal.h>

#include "cli/evaluate_command.h"
#include "cli/wall_clock.h"
#include "core/output_folder.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

class WorkerCommand : public test::EvaluateCommand {
 protected:
  /// Plans sessions of 2 simulated seconds and runs none.
  void plan(const std::string& seeds, const std::string& set = "") {
    matrix_ = write("matrix.yaml",
                    "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nseeds: [" + seeds +
                        "]\nset: [protocol.time_limit=2, verdict.judge=false" + set + "]\n");
    ASSERT_EQ(cdiff({"evaluate", matrix_, "--results", results_, "--engine", "print"}), 0)
        << output();
  }
  /// A file of the run with this seed, the only one where it is empty.
  fs::path file(const std::string& seed, const std::string& name) const {
    const std::string id = "arterial_exit" + (seed.empty() ? "" : "__seed" + seed);
    return fs::path(results_) / "runs" / id / name;
  }
  std::string statusOf(const std::string& seed) const {
    return readRecord(file(seed, "record.json"))->status;
  }
  std::string results_ = folder("results");
  std::string matrix_;
};

TEST_F(WorkerCommand, TwoGiveTheBytesOfOneBatch) {
  plan("1, 2, 3, 4");
  test::ProgramRun first(CDIFF_PROGRAM, {"worker", results_}, folder("first"));
  test::ProgramRun second(CDIFF_PROGRAM, {"worker", results_, "--wait"}, folder("second"));
  EXPECT_EQ(first.wait(), 0) << core::readFile(folder("first"), "output");
  EXPECT_EQ(second.wait(), 0) << core::readFile(folder("second"), "output");
  ASSERT_EQ(cdiff({"evaluate", matrix_, "--results", results_, "--resume"}), 0) << output();
  expectOutput("4 runs were complete already");
  const std::string local = folder("local");
  ASSERT_EQ(cdiff({"evaluate", matrix_, "--results", local}), 0) << output();
  EXPECT_EQ(test::differences(test::filesOfAnyEngine(results_), test::filesOfAnyEngine(local)),
            std::vector<std::string>());
}

TEST_F(WorkerCommand, RunsItsPart) {
  plan("1, 2, 3");
  ASSERT_EQ(cdiff({"worker", results_, "--part", "2/3"}), 0) << output();
  int done = 0;
  for (const char* seed : {"1", "2", "3"}) done += statusOf(seed) == "timed_out";
  EXPECT_EQ(done, 1);
  for (const char* part : {"3/3", "1", "a/b", "1/", "/3"}) {
    EXPECT_EQ(cdiff({"worker", results_, "--part", part}), 3) << part;
    expectOutput("expected I/N");
  }
}

TEST_F(WorkerCommand, ReturnsItsRunWhenItIsStopped) {
  plan("1", ", at_most=0.1");
  for (const int signal : {SIGTERM, SIGINT}) {
    test::ProgramRun worker(CDIFF_PROGRAM, {"worker", results_}, folder("output"));
    const fs::path begun = file("", "session.yaml");
    while (!fs::exists(begun)) {
      ASSERT_FALSE(worker.ended()) << output();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    worker.signal(signal);
    EXPECT_EQ(worker.wait(), 75) << output();
    EXPECT_EQ(statusOf(""), "interrupted");
    EXPECT_TRUE(fs::is_empty(fs::path(results_) / ".leases"));
    fs::remove(begun);
  }
}

TEST_F(WorkerCommand, RefusesAnotherBuildOtherFilesAndAFolderWithoutPlan) {
  EXPECT_EQ(cdiff({"worker", folder("nothing")}), 3);
  expectOutput("has no plan.json");
  plan("1");
  const fs::path scenario = file("", "scenario.yaml");
  core::writeOwnFile(scenario, core::readFile(scenario, "scenario") + "# changed\n");
  EXPECT_EQ(cdiff({"worker", results_}), 3);
  expectOutput("is not what was planned");
  EXPECT_EQ(statusOf(""), "error");
  ASSERT_EQ(cdiff({"evaluate", matrix_, "--results", results_, "--resume", "--engine", "print"}), 0)
      << output();
  const fs::path plan_file = fs::path(results_) / "plan.json";
  std::string text = core::readFile(plan_file, "plan");
  const std::size_t place = text.find("\"program_sha256\": \"") + 19;
  text[place] = text[place] == '0' ? '1' : '0';
  core::writeOwnFile(plan_file, text);
  EXPECT_EQ(cdiff({"worker", results_}), 3);
  expectOutput("is another build (SHA-256 ");
  EXPECT_EQ(statusOf(""), "not_run");
}

TEST_F(WorkerCommand, DrivesSessionsOfACollection) {
  const auto collect = [&](const std::string& data, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"collect",   "--scenarios", "arterial_exit,roundabout_entry",
                                      "--results", data,          "--duration",
                                      "6"};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  };
  ASSERT_EQ(collect(results_, {"--engine", "print"}), 0) << output();
  EXPECT_FALSE(fs::exists(fs::path(results_) / "shards"));
  ASSERT_EQ(cdiff({"worker", results_}), 0) << output();
  ASSERT_EQ(collect(results_, {}), 0) << output();
  expectOutput("2 sessions, 2 of them already there");
  const std::string local = folder("local");
  ASSERT_EQ(collect(local, {"--jobs", "2"}), 0) << output();
  for (const char* name : {"shards/arterial_exit_seed1.shard",
                           "shards/roundabout_entry_seed1.shard", "statistics.json"})
    EXPECT_EQ(core::readFile(fs::path(results_) / name, name),
              core::readFile(fs::path(local) / name, name))
        << name;
  EXPECT_EQ(cdiff({"report", results_}), 3) << "its records are of no sessions of an evaluation";
}

TEST_F(WorkerCommand, ScoresDriversOfARealismMatrix) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nset: "
                                   "[protocol.time_limit=30, pdm_lite.cbv_speed_spread=0.1]\n");
  const auto matched = [&](const std::string& results, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"realism",    "matched", matrix,      "--results", results,
                                      "--rollouts", "2",       "--seconds", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  };
  ASSERT_EQ(matched(results_, {"--engine", "print"}), 0) << output();
  EXPECT_FALSE(fs::exists(fs::path(results_) / "realism.json"));
  ASSERT_EQ(cdiff({"worker", results_, "--jobs", "2"}), 0) << output();
  ASSERT_EQ(matched(results_, {"--resume"}), 0) << output();
  expectOutput("2 runs were complete already");
  const std::string local = folder("local");
  ASSERT_EQ(matched(local, {}), 0) << output();
  EXPECT_EQ(core::readFile(fs::path(results_) / "realism.json", "result"),
            core::readFile(fs::path(local) / "realism.json", "result"));
}

}  // namespace
}  // namespace cdiff::evaluation
