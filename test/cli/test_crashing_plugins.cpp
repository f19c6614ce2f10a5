// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Plug-ins that crash, leave or stop the program in the middle of a session.
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

}  // namespace
}  // namespace cdiff::cli
