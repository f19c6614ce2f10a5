// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "core/file.h"
#include "core/output_folder.h"
#include "support/program_run.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

class ReplayCommand : public testing::Test {
 protected:
  fs::path live() const { return scratch_.path() / "live"; }
  fs::path bag() const { return live() / "session.bag"; }
  fs::path replayed() const { return scratch_.path() / "replayed"; }
  std::string output() const {
    return core::readFile(scratch_.path() / "output", "output of cdiff");
  }

  /// Exit code of a program.
  int run(const std::string& program, const std::vector<std::string>& arguments) const {
    return test::ProgramRun(program, arguments, scratch_.path() / "output").wait();
  }
  int replay() const {
    return run(CDIFF_PROGRAM, {"replay", bag().string(), "--results", replayed().string()});
  }
  void record(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--record", "--quiet", "--results", live().string()});
    ASSERT_EQ(run(CDIFF_PROGRAM, arguments), 0) << output();
  }
  void expectSameFile(
      const char* name,
      const std::vector<std::pair<std::string, std::string>>& wall_clock_and_origin) const {
    std::string texts[2] = {core::readFile(live() / name, name),
                            core::readFile(replayed() / name, name)};
    for (std::string& text : texts) {
      for (const auto& [pattern, replacement] : wall_clock_and_origin)
        text = std::regex_replace(text, std::regex(pattern), replacement);
    }
    EXPECT_TRUE(texts[0] == texts[1]) << name << " differs";
  }
  void expectSameResult() const {
    expectSameFile("trace.csv", {});
    expectSameFile("summary.json", {{"\n  \"(wall_seconds|real_time_factor)\": [^\n]*", ""}});
    expectSameFile("junit.xml", {{" time=\"[0-9.]+\"", ""}});
    expectSameFile("report.html", {{"[0-9.]+ times real time", ""},
                                   {"cdiff (run|replay), deterministic", "deterministic"}});
    expectSameFile(
        "session.yaml",
        {{"deployment: \"cdiff run\"\n", ""},
         {"deployment: \"cdiff replay\"\nrecorded_by: \"cdiff run of e2e_cdiff .*\"\n", ""},
         {"  (ego|cbv)_(model_files_sha256|(encoder|denoiser)_(instruction_set|precision)): .*\n",
          ""}});
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(core::readFile(replayed() / "summary.json", "summary"));
  }
  test::TemporaryFolder scratch_;
};

TEST_F(ReplayCommand, HasTheResultOfARuleDrivenSessionWithoutItsNetworkFile) {
  const fs::path network = scratch_.path() / "mine.net.xml";
  fs::copy_file(
      core::shareFolder() / "networks" / "crossing_district" / "crossing_district.net.xml",
      network);
  record({"crossing_left_turn", "--network", network.string(), "--seed", "2", "--cbv-planner",
          "pdm_lite", "--set", "protocol.time_limit=15", "--set", "verdict.judge=false"});
  fs::remove(network);
  EXPECT_EQ(replay(), 0) << output();
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the session shows no CBV; choose one that does";
  expectSameResult();
}

TEST_F(ReplayCommand, HasTheResultOfASafetyCriticalSessionOfTheDiffusionPlanner) {
  record({"roundabout_cross", "--mode", "safety_critical", "--seed", "1", "--cbv-planner",
          "diffusion", "--set", "protocol.time_limit=10", "--set", "verdict.judge=false"});
  EXPECT_EQ(replay(), 0) << output();
  EXPECT_GT(summary()["planner_latency_ms"]["cbv:diffusion"]["n"], 0);
  EXPECT_FALSE(summary()["guidance"].is_null());
  const std::string session = core::readFile(live() / "session.yaml", "session");
  EXPECT_NE(session.find("\n  cbv_conditioning: \"image\"\n"), std::string::npos) << session;
  expectSameResult();
}

TEST_F(ReplayCommand, SaysWhatIsWrongAndLeavesNothingHalfWritten) {
  record({"crossing_left_turn", "--seed", "2", "--cbv-planner", "pdm_lite", "--set",
          "protocol.time_limit=4", "--set", "verdict.judge=false"});
  EXPECT_EQ(run(CDIFF_PROGRAM, {"replay", bag().string()}), 3);
  EXPECT_NE(output().find("--results"), std::string::npos) << output();
  EXPECT_EQ(run(CDIFF_PROGRAM, {"replay", "none.bag", "--results", replayed().string()}), 3);
  EXPECT_NE(output().find("none.bag"), std::string::npos) << output();
  EXPECT_FALSE(fs::exists(replayed()));
  // A folder that cannot be: its parent is a file.
  EXPECT_EQ(run(CDIFF_PROGRAM, {"replay", bag().string(), "--results", bag().string() + "/in"}), 3);
  EXPECT_NE(output().find("cannot make the folder"), std::string::npos) << output();

  fs::resize_file(bag(), fs::file_size(bag()) - 100);
  EXPECT_EQ(replay(), 2) << output();
  EXPECT_NE(output().find("the recording is damaged"), std::string::npos) << output();
  EXPECT_EQ(summary()["status"], "timed_out");
}

TEST_F(ReplayCommand, AnInterruptedOneLeavesNothing) {
  record({"crossing_left_turn", "--seed", "2", "--cbv-planner", "pdm_lite", "--set",
          "protocol.time_limit=10", "--set", "verdict.judge=false"});
  int exit_code = 0;
  for (int left = 20; left > 0 && exit_code == 0; --left) {  // it may end before the signal comes
    fs::remove_all(replayed());
    test::ProgramRun replay(CDIFF_PROGRAM,
                            {"replay", bag().string(), "--results", replayed().string()},
                            scratch_.path() / "output");
    while (!replay.ended() && !fs::exists(replayed() / "session.yaml"))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    replay.signal(SIGINT);
    exit_code = replay.wait();
  }
  EXPECT_EQ(exit_code, 130) << output();
  EXPECT_FALSE(fs::exists(replayed()));
}

TEST_F(ReplayCommand, LeavesTheResultOfADrivenSessionAlone) {
  record({"crossing_left_turn", "--seed", "2", "--cbv-planner", "pdm_lite", "--set",
          "protocol.time_limit=2", "--set", "verdict.judge=false"});
  const std::string session = core::readFile(live() / "session.yaml", "session");
  EXPECT_EQ(run(CDIFF_PROGRAM, {"replay", bag().string(), "--results", live().string()}), 3);
  EXPECT_NE(output().find("holds the bag that is replayed"), std::string::npos) << output();
  EXPECT_EQ(
      run(CDIFF_PROGRAM, {"replay", bag().string(), "--results", live().string(), "--overwrite"}),
      3);
  EXPECT_NE(output().find("holds the bag that is replayed"), std::string::npos) << output();
  EXPECT_EQ(core::readFile(live() / "session.yaml", "session"), session);
  EXPECT_EQ(replay(), 0) << output();
  EXPECT_EQ(replay(), 3) << "an earlier replay is replaced only when asked";
  EXPECT_EQ(run(CDIFF_PROGRAM,
                {"replay", bag().string(), "--results", replayed().string(), "--overwrite"}),
            0)
      << output();
  // Nor does bad input take the recording away.
  for (const char* planner : {"--cbv-planner", "--ego-planner"}) {
    EXPECT_EQ(run(CDIFF_PROGRAM,
                  {"run", "crossing_left_turn", planner, "pdm_lit", "--results", live().string()}),
              3);
    EXPECT_NE(output().find("did you mean 'pdm_lite'"), std::string::npos) << output();
    EXPECT_TRUE(fs::exists(bag()));
  }
}

TEST_F(ReplayCommand, ABagThatCannotBeWrittenLeavesTheOtherResultsWhole) {
  // With images the bag is larger than the limit (in KiB), all other files are smaller.
  const std::string command =
      std::string("trap '' XFSZ; ulimit -f 800; exec '") + CDIFF_PROGRAM +
      "' run roundabout_cross --seed 1 --set protocol.time_limit=12 --set report.front_view_rate=0 "
      "--record --quiet --results '" +
      live().string() + "'";
  EXPECT_EQ(run("/bin/bash", {"-c", command}), 2) << output();
  EXPECT_NE(output().find("cannot write the bag"), std::string::npos) << output();
  EXPECT_NE(output().find("the other results are not affected"), std::string::npos) << output();
  EXPECT_FALSE(fs::exists(bag()));
  for (const char* name : {"summary.json", "trace.csv", "junit.xml", "report.html"})
    EXPECT_TRUE(fs::exists(live() / name)) << name;
}

TEST_F(ReplayCommand, AFullDiskIsAClearErrorAndNoFileIsHalfWritten) {
  record({"crossing_left_turn", "--seed", "2", "--cbv-planner", "pdm_lite", "--set",
          "protocol.time_limit=4", "--set", "verdict.judge=false"});
  // No file may grow beyond the limit (in KiB): as a disk that is full.
  for (const char* limit : {"1", "20", "60"}) {
    fs::remove_all(replayed());
    const std::string command = std::string("trap '' XFSZ; ulimit -f ") + limit + "; exec '" +
                                CDIFF_PROGRAM + "' replay '" + bag().string() + "' --results '" +
                                replayed().string() + "'";
    const int exit_code = run("/bin/bash", {"-c", command});
    EXPECT_TRUE(exit_code == 2 || exit_code == 3) << exit_code;
    EXPECT_NE(output().find("cannot write"), std::string::npos) << limit << ": " << output();
    if (std::string(limit) == "1") {  // which even session.yaml exceeds
      EXPECT_FALSE(fs::exists(replayed())) << "an empty folder was left";
      continue;
    }
    for (const auto& entry : fs::directory_iterator(replayed())) {
      const std::string name = entry.path().filename();
      EXPECT_TRUE(name == "session.yaml" || name == "plans.csv" || name == "vehicles.csv" ||
                  name == "summary.json" || name == "junit.xml" ||
                  name == core::OutputFolder::kRecord)
          << name;
    }
    EXPECT_EQ(summary()["status"], "error");
  }
}

}  // namespace
}  // namespace cdiff::evaluation
