// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Plug-ins that crash, leave or stop the program in the middle of a session.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/cdiff_command.h"
#include "record/result_folder.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class CrashingPlugins : public test::CdiffCommand {
 protected:
  CrashingPlugins() { ::setenv("E2E_CDIFF_PLUGINS", CRASHING_PLUGIN, 1); }
  ~CrashingPlugins() override {
    ::unsetenv("E2E_CDIFF_PLUGINS");
    ::unsetenv("CRASHING_METRIC");
  }
  /// The command for a session of 2 s of an ego that ends the program so.
  std::vector<std::string> session(const std::string& end) const {
    return {"run",           "crossing_straight",
            "--results",     results(),
            "--ego-planner", "quitter",
            "--cbv-planner", "pdm_lite",
            "--set",         "protocol.time_limit=2",
            "--set",         "verdict.judge=false",
            "--set",         "quitter.end=" + end};
  }
  std::string results() const { return path("results"); }
  nlohmann::json summary() const {
    return nlohmann::json::parse(core::readFile(results() + "/summary.json", "summary"));
  }
  /// The result names the plug-in and holds ticks, where the session had begun.
  void expectResult(const std::string& status, const std::string& what, bool begun = true) const {
    EXPECT_EQ(summary()["status"], status) << output();
    const std::string fault = summary()["faults"].back()["text"];
    EXPECT_EQ(fault.rfind(what + " of plug-in '" CRASHING_PLUGIN "'", 0), 0U) << fault;
    EXPECT_EQ(record::readTrace(results() + "/trace.csv").size() > 1, begun);
    EXPECT_TRUE(fs::exists(results() + "/report.html"));
    for (const auto& entry : fs::directory_iterator(results())) {
      const std::string name = entry.path().filename();
      const bool hidden = name.front() == '.' && name != ".cdiff_files";
      EXPECT_FALSE(hidden || name.find(".tmp.") != std::string::npos ||
                   entry.path().extension() == ".part")
          << name;
    }
  }
  void expectFault(const std::string& part) const {
    const std::string fault = summary()["faults"].back()["text"];
    EXPECT_NE(fault.find(part), std::string::npos) << fault;
  }
};

TEST_F(CrashingPlugins, ASessionWithAHarmlessOneEndsAsWithoutIt) {
  std::vector<std::string> command = session("none");
  command[5] = "pdm_lite";
  EXPECT_EQ(cdiff(command), 0) << output();
  const std::string trace = summary()["trace_sha256"];
  EXPECT_EQ(summary()["metrics"]["crashing_calls"]["value"], 41.0);
  ::unsetenv("E2E_CDIFF_PLUGINS");
  command.resize(command.size() - 2);
  command.push_back("--overwrite");
  EXPECT_EQ(cdiff(command), 0) << output();
  EXPECT_EQ(summary()["trace_sha256"], trace);
}

TEST_F(CrashingPlugins, APlannerThatEndsTheProgramIsNamedByTheResult) {
  const std::vector<std::pair<std::string, std::string>> ends = {
      {"segmentation_fault", "signal 11"}, {"abort", "signal 6"}, {"exit", "exit code 0"}};
  for (const auto& [end, text] : ends) {
    fs::remove_all(results());
    EXPECT_EQ(cdiff(session(end)), 2) << output();
    expectResult("error", "planner 'quitter'");
    expectFault(text);
  }
}

TEST_F(CrashingPlugins, APlannerThatCrashesInItsConstructorIsNamedByTheResult) {
  EXPECT_EQ(cdiff(session("constructor_fault")), 2) << output();
  expectResult("error", "planner 'quitter'", false);
}

TEST_F(CrashingPlugins, APlannerThatThrowsANumberInItsConstructorIsBadInput) {
  EXPECT_EQ(cdiff(session("constructor_number")), 3) << output();
  expectOutput("planner 'quitter' of plug-in '");
  EXPECT_FALSE(fs::exists(results()));
}

TEST_F(CrashingPlugins, APlannerThatThrowsInItsConstructorIsNamed) {
  EXPECT_EQ(cdiff(session("constructor_exception")), 3) << output();
  expectOutput("planner 'quitter' of plug-in '");
  expectOutput("no license");
}

TEST_F(CrashingPlugins, AnObjectiveThatEndsTheProgramIsNamedByTheResult) {
  std::vector<std::string> command = session("none");
  command[5] = "diffusion";
  command.insert(command.end(), {"--set", "ego_guidance.quitting.weight=1", "--set",
                                 "ego_guidance.quitting.end=abort"});
  EXPECT_EQ(cdiff(command), 2) << output();
  expectResult("error", "guidance objective 'quitting'", false);
}

TEST_F(CrashingPlugins, OptionsThatEndTheProgramGiveAnError) {
  EXPECT_EQ(cdiff(session("validate_exit")), 2) << output();
  expectOutput(CRASHING_PLUGIN);
}

TEST_F(CrashingPlugins, AnEndlessConstructorEndsAtTheSecondSignal) {
  ::setenv("CRASHING_MARK", path("mark").c_str(), 1);
  test::ProgramRun run(CDIFF_PROGRAM, session("constructor_endless"), path("output"));
  while (!run.ended() && !fs::exists(path("mark")))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  while (!run.ended()) {
    run.signal(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  }
  EXPECT_EQ(run.wait(), 130) << output();
  expectOutput("planner 'quitter' of plug-in '");
}

// As a terminal's Ctrl-C, which reaches the process that waits and its copy.
TEST_F(CrashingPlugins, AnInterruptedCommandBlamesNobody) {
  int interrupted = 0;
  for (int delay = 150; delay < 450; delay += 30) {  // [ms]
    test::ProgramRun run(CDIFF_PROGRAM, {"validate", "crossing_straight"}, path("output"));
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));
    if (run.ended()) continue;
    run.signal(SIGINT);
    const int exit_code = run.wait();
    EXPECT_TRUE(exit_code == 0 || exit_code == 130) << exit_code;
    interrupted += exit_code == 130;
    EXPECT_EQ(output().find("mend"), std::string::npos) << output();
    EXPECT_EQ(output().find("check the program sumo"), std::string::npos) << output();
    EXPECT_EQ(output().find("had loaded"), std::string::npos) << output();
  }
  EXPECT_GT(interrupted, 0);
}

TEST_F(CrashingPlugins, AWhatIfThatAPlannerEndsGivesAnError) {
  std::vector<std::string> command = session("none");
  EXPECT_LE(cdiff(command), 1) << output();
  EXPECT_EQ(
      cdiff({"what_if", results(), "--at", "0.5", "--ego", "quitter", "--set", "quitter.end=exit"}),
      2)
      << output();
  expectOutput("planner 'quitter' of plug-in '");
}

TEST_F(CrashingPlugins, AReplayThatAMetricEndsGivesAnError) {
  std::vector<std::string> command = session("none");
  command.push_back("--record");
  EXPECT_LE(cdiff(command), 1) << output();
  ::setenv("CRASHING_METRIC", "exit", 1);
  EXPECT_EQ(cdiff({"replay", results() + "/session.bag", "--results", path("replayed")}), 2)
      << output();
  expectOutput("metric 'crashing_metric' of plug-in '");
}

TEST_F(CrashingPlugins, ASessionOfADataSetThatAPlannerEndsHasFailed) {
  EXPECT_EQ(cdiff({"collect", "--scenarios", "crossing_straight", "--seeds", "1", "--results",
                   path("data"), "--set", "protocol.time_limit=2", "--set", "ego_planner=quitter",
                   "--set", "quitter.end=exit"}),
            2)
      << output();
  expectOutput("planner 'quitter' of plug-in '");
}

TEST_F(CrashingPlugins, APlannerWithoutAnAnswerIsEnded) {
  std::vector<std::string> command = session("endless");
  command.insert(command.end(), {"--answer-timeout", "1"});
  EXPECT_EQ(cdiff(command), 2) << output();
  expectResult("error", "planner 'quitter'");
  expectFault("no answer for ");
}

TEST_F(CrashingPlugins, ASecondSignalEndsAPlannerWithoutAnAnswer) {
  test::ProgramRun run(CDIFF_PROGRAM, session("endless"), path("output"));
  const fs::path reserve = results() + "/.reserve/session.bag.active";
  std::error_code none;
  while (!run.ended() && (!fs::exists(reserve, none) || fs::file_size(reserve, none) < 20000))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  for (int i = 0; i < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    run.signal(SIGINT);
  }
  EXPECT_EQ(run.wait(), 130) << output();
  expectResult("interrupted", "planner 'quitter'");
}

TEST_F(CrashingPlugins, AMetricThatEndsTheProgramIsNamedAndLeftOut) {
  ::setenv("CRASHING_METRIC", "segmentation_fault", 1);
  EXPECT_EQ(cdiff(session("none")), 2) << output();
  expectResult("error", "metric 'crashing_metric'");
  EXPECT_TRUE(summary()["metrics"]["crashing_calls"]["value"].is_null());
}

TEST_F(CrashingPlugins, AMetricThatThrowsInItsConstructorIsLeftOut) {
  ::setenv("CRASHING_METRIC", "constructor_exception", 1);
  EXPECT_LE(cdiff(session("none")), 1) << output();
  EXPECT_TRUE(summary()["metrics"]["crashing_calls"]["value"].is_null());
  const std::string fault = summary()["faults"].back()["text"];
  EXPECT_LT(fault.size(), 1100U);
}

}  // namespace
}  // namespace cdiff::cli
