// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <signal.h>

#include <nlohmann/json.hpp>

#include "cli/evaluate_command.h"
#include "cli/wall_clock.h"
#include "core/csv.h"
#include "core/text.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

/// CBVs drive from 2.6 s on.
constexpr const char* kMatrix =
    "scenarios: [roundabout_entry]\n"
    "combinations:\n"
    "  - cbv_planner=diffusion mode=naturalistic\n"
    "  - cbv_planner=diffusion mode=safety_critical\n"
    "  - cbv_planner=two_stage_pid mode=naturalistic\n"
    "seeds: [2, 3]\n"
    "set: [protocol.time_limit=4, verdict.judge=false]\n";

/// Processes that print into a file below a folder: the sessions of a batch.
std::vector<pid_t> processesIn(const std::string& folder) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code gone;
    const fs::path output = fs::read_symlink(entry.path() / "fd/1", gone);
    if (output.string().rfind(folder + "/", 0) == 0) found.push_back(std::stoi(name));
  }
  return found;
}

/// The SUMO that a process started; 0 when there is none.
pid_t sumoOf(pid_t parent) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "stat");
    std::string line;
    if (!std::getline(file, line) || line.find("(sumo") == std::string::npos) continue;
    const auto words = core::splitText(line.substr(line.rfind(')') + 1), ' ');
    if (std::stoi(words.at(1)) == parent) return std::stoi(line);
  }
  return 0;
}

class BatchRobustness : public test::EvaluateCommand {
 protected:
  std::size_t completeRuns(const std::string& results) const {
    std::size_t count = 0;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(fs::path(results) / "runs", none)) {
      const auto record = readRecord(entry.path() / "record.json");
      count += record && record->complete();
    }
    return count;
  }
  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }
  /// Runs a shell script with its own mounts; false where the machine does not allow them.
  bool inOwnMounts(const std::string& script, int& exit_code) const {
    const auto run = [&](const std::string& text) {
      test::ProgramRun process("/usr/bin/unshare", {"-rm", "/bin/sh", "-c", text},
                               scratch_.path() / "output");
      return process.wait();
    };
    const std::string mount = "mount -t tmpfs -o size=200k none " + folder("small") + " && ";
    fs::create_directories(folder("small"));
    if (!fs::exists("/usr/bin/unshare") || run(mount + "exit 0") != 0) return false;
    exit_code = run(mount + script);
    return true;
  }
};

TEST_F(BatchRobustness, KilledAndResumedItGivesTheSameFiles) {
  const std::string matrix = write("matrix.yaml", kMatrix);
  const std::string whole = folder("whole");
  const std::string resumed = folder("resumed");
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", whole, "--jobs", "2"}), 0) << output();
  {
    test::ProgramRun process(CDIFF_PROGRAM,
                             {"evaluate", matrix, "--results", resumed, "--jobs", "2"},
                             scratch_.path() / "output");
    while (completeRuns(resumed) < 2) {
      ASSERT_FALSE(process.ended()) << "the batch ended before it was killed\n" << output();
      pause();
    }
    process.signal(SIGKILL);  // its process alone: runs have groups of their own
    EXPECT_EQ(process.wait(), 128 + SIGKILL);
  }
  for (int i = 0; i < 500 && !processesIn(resumed).empty(); ++i) pause();
  EXPECT_TRUE(processesIn(resumed).empty()) << "runs outlive the batch";
  EXPECT_LT(completeRuns(resumed), 6U);
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", resumed, "--jobs", "2", "--resume"}), 0);
  expectOutput("runs were complete already");

  const auto first = test::filesWithoutWallClock(whole);
  const auto second = test::filesWithoutWallClock(resumed);
  EXPECT_EQ(first.size(), second.size());
  for (const auto& [name, text] : first) {
    ASSERT_EQ(second.count(name), 1U) << name;
    EXPECT_TRUE(second.at(name) == text) << name << " differs";
  }
}

TEST_F(BatchRobustness, TablesAndFiguresAreMadeAgainFromTheFolderAlone) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [roundabout_entry]\nseeds: [3]\n"
                                   "set: [protocol.time_limit=6, verdict.judge=false]\n");
  const fs::path results = folder("results");
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", results.string()}), 0) << output();
  const auto before = test::filesWithoutWallClock(results);
  fs::remove_all(results / "tables");
  fs::remove_all(results / "figures");
  fs::remove(results / "index.html");
  ASSERT_EQ(cdiff({"report", "--tables", results.string()}), 0) << output();
  EXPECT_EQ(test::filesWithoutWallClock(results), before);
  for (int i = 1; i <= 6; ++i)
    EXPECT_EQ(before.count("tables/table_" + std::to_string(i) + ".csv"), 1U);
  for (int i = 3; i <= 8; ++i)
    EXPECT_EQ(before.count("figures/figure_" + std::to_string(i) + ".svg"), 1U);
  // The pooled W of one run is that run's: the trace gives the same samples as the metrics saw.
  const auto summary = nlohmann::json::parse(
      core::readFile(results / "runs" / "roundabout_entry" / "summary.json", "summary"));
  for (const std::string quantity : {"speed", "acceleration"}) {
    const auto& w = summary["metrics"][quantity + "_shapiro_wilk"];
    ASSERT_TRUE(w["value"].is_number()) << w;
    bool found = false;
    for (const std::string& line : core::splitText(before.at("figures/figure_3.csv"), '\n')) {
      const auto cells = core::csvCells(line);
      if (cells[0] != "E2E-CDiff (method default)" || cells[1] != quantity) continue;
      found = true;
      EXPECT_EQ(cells[7], w["n"].dump());
      EXPECT_NEAR(std::stod(cells[10]), w["value"].get<double>(), 1e-9);
    }
    EXPECT_TRUE(found) << quantity;
  }
}

TEST_F(BatchRobustness, RepeatsARunWhoseSumoWasKilled) {
  const std::string matrix =
      write("matrix.yaml",
            "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nretries: 1\nset: "
            "[protocol.time_limit=2, at_most=1, verdict.judge=false]\n");
  const std::string results = folder("results");
  test::ProgramRun process(CDIFF_PROGRAM, {"evaluate", matrix, "--results", results},
                           scratch_.path() / "output");
  pid_t sumo = 0;
  while (sumo == 0 && !process.ended()) {
    for (const pid_t run : processesIn(results + "/runs/arterial_exit")) sumo = sumoOf(run);
    if (sumo == 0) pause();
  }
  ASSERT_NE(sumo, 0) << output();
  ASSERT_EQ(::kill(sumo, SIGKILL), 0);
  EXPECT_EQ(process.wait(), 0) << output();
  const auto records = readRecords(results);
  EXPECT_EQ(records.front().status, "timed_out");  // the protocol's 2 s
  EXPECT_EQ(records.front().attempts, 2);
  EXPECT_EQ(records.front().cause, "");
}

TEST_F(BatchRobustness, NamesADamagedRecordOnResume) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nset: "
                                   "[protocol.time_limit=1, verdict.judge=false]\n");
  const std::string results = folder("results");
  const std::vector<std::string> evaluate = {"evaluate", matrix, "--results", results, "--resume"};
  ASSERT_EQ(cdiff(evaluate), 0) << output();
  const fs::path record = fs::path(results) / "runs" / "arterial_exit" / "record.json";
  fs::resize_file(record, 40);
  EXPECT_EQ(cdiff(evaluate), 3);
  expectOutput("record.json' is no record of a run");
  EXPECT_EQ(cdiff({"report", "--tables", results}), 3);
  expectOutput("delete the file to have the run repeated");
  fs::remove(record);
  EXPECT_EQ(cdiff(evaluate), 0) << output();
}

TEST_F(BatchRobustness, RefusesAnUnknownPlannerAndWrongReportArguments) {
  const std::string matrix =
      write("matrix.yaml", "scenarios: [arterial_exit]\ncbv_planners: [difusion]\n");
  EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results")}), 3);
  expectOutput("key 'cbv_planner' is 'difusion', an unknown planner; did you mean 'diffusion'");
  EXPECT_FALSE(fs::exists(folder("results")));
  EXPECT_EQ(cdiff({"report"}), 3);
  expectOutput("give one of --compare A B, --doses DIR, ");
  EXPECT_EQ(cdiff({"report", "--tables", folder("nothing"), "--csv", "out.csv"}), 3);
  expectOutput("belong to --compare");
  EXPECT_EQ(cdiff({"report", "--tables", folder("nothing")}), 3);
  expectOutput("it has no matrix.yaml");
}

TEST_F(BatchRobustness, SaysThatTheDiskIsFullAndLeavesNothingHalfWritten) {
  const std::string matrix =
      write("matrix.yaml", "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n");
  const std::string results = folder("small") + "/results";
  int exit_code = -1;
  const bool mounted = inOwnMounts(std::string(CDIFF_PROGRAM) + " evaluate " + matrix +
                                       " --results " + results + "; code=$?; find " + results +
                                       " -name '*.part' -printf 'remains: %f\\n'; cat " + results +
                                       "/runs/*/record.json; ls " + results + "/runs/*; exit $code",
                                   exit_code);
  if (!mounted) GTEST_SKIP() << "no mounts of one's own on this machine";
  EXPECT_NE(exit_code, 0);
  expectOutput("No space left on device");
  expectOutput("summary.json");
  for (const char* part : {"remains: ", "trace.csv\n"})
    EXPECT_EQ(output().find(part), std::string::npos) << part << "\nin\n" << output();
}

TEST_F(BatchRobustness, SaysThatAFolderIsReadOnly) {
  const std::string matrix =
      write("matrix.yaml", "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n");
  int exit_code = -1;
  const bool mounted =
      inOwnMounts("mount -o remount,ro none " + folder("small") + " && " + CDIFF_PROGRAM +
                      " evaluate " + matrix + " --results " + folder("small"),
                  exit_code);
  if (!mounted) GTEST_SKIP() << "no mounts of one's own on this machine";
  EXPECT_EQ(exit_code, 3);
  expectOutput("Read-only file system");
}

}  // namespace
}  // namespace cdiff::evaluation
