// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions whose SUMO runs in their own process: the same bytes, and a result when SUMO crashes.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"
#include "record/result_folder.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class InProcessSumo : public test::CdiffCommand {
 protected:
  ~InProcessSumo() override {
    ::unsetenv("LD_PRELOAD");
    ::unsetenv("LD_LIBRARY_PATH");
  }
  /// The command for a session of so many seconds; its results replace those before.
  std::vector<std::string> session(const std::string& scenario, const std::string& mode,
                                   const std::string& link,
                                   const std::string& seconds = "4") const {
    return {"run",        scenario,
            "--mode",     mode,
            "--set",      "simulation.link=" + link,
            "--set",      "protocol.time_limit=" + seconds,
            "--set",      "verdict.judge=false",
            "--results",  results(),
            "--overwrite"};
  }
  std::string results() const { return path("results"); }
  nlohmann::json summary() const {
    return nlohmann::json::parse(core::readFile(results() + "/summary.json", "summary"));
  }
  /// Hash of the trace of a session that ends as it should.
  std::string traceOf(const std::string& scenario, const std::string& mode,
                      const std::string& link) const {
    EXPECT_EQ(cdiff(session(scenario, mode, link)), 0) << output();
    EXPECT_EQ(summary()["status"], "timed_out");
    return summary()["trace_sha256"];
  }
};

TEST_F(InProcessSumo, GivesTheSameBytesAsSumoInAProcess) {
  for (const char* scenario : {"roundabout_cross", "crossing_left_turn"}) {
    for (const char* mode : {"naturalistic", "safety_critical"}) {
      const std::string apart = traceOf(scenario, mode, "libtraci");
      EXPECT_EQ(traceOf(scenario, mode, "libsumo"), apart) << scenario << ", " << mode;
    }
  }
}

// The thread that keeps the ticks is at most 20 of them behind.
TEST_F(InProcessSumo, ACrashIsAnErrorOfTheSimulatorAndKeepsTheTicks) {
  ::setenv("LD_PRELOAD", CRASHING_SUMO, 1);
  EXPECT_EQ(cdiff(session("crossing_straight", "naturalistic", "libsumo", "30")), 2) << output();
  EXPECT_EQ(summary()["status"], "error");
  const auto fault = summary()["faults"].back();
  EXPECT_EQ(fault["source"], "simulator");
  const std::string text = fault["text"];
  EXPECT_NE(text.find("signal 11"), std::string::npos) << text;
  EXPECT_GT(record::readTrace(results() + "/trace.csv").size(), 1U);
  EXPECT_TRUE(fs::exists(results() + "/report.html"));
  EXPECT_FALSE(fs::exists(results() + "/.reserve"));
}

TEST_F(InProcessSumo, AMissingLibraryIsBadInputThatNamesThePackage) {
  fs::create_directory(path("libraries"));
  std::ofstream(path("libraries") + "/libsumocpp.so") << "no library";
  ::setenv("LD_LIBRARY_PATH", path("libraries").c_str(), 1);
  EXPECT_EQ(cdiff(session("crossing_straight", "naturalistic", "libsumo")), 3) << output();
  expectOutput("'simulation.link' is 'libsumo'");
  expectOutput("install the package sumo");
  EXPECT_FALSE(fs::exists(results()));
}

}  // namespace
}  // namespace cdiff::cli
