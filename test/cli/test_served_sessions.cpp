// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Sessions that one server runs, as `cdiff evaluate` lets it, beside those of programs of their
/// own.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/evaluate_command.h"
#include "cli/wall_clock.h"
#include "core/fork_server.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

/// Two networks, and all that is kept: the networks of two planners in a session, and of two
/// threads.
constexpr const char* kMatrix =
    "scenarios: [roundabout_entry, crossing_straight]\n"
    "combinations:\n"
    "  - ego_planner=pdm_lite cbv_planner=diffusion mode=safety_critical\n"
    "  - ego_planner=diffusion cbv_planner=diffusion mode=naturalistic variant=threads\n"
    "variants: ['threads: diffusion.threads=2']\n"
    "seeds: [2]\n"
    "repetitions: 2\n"
    "set: [protocol.time_limit=3, verdict.judge=false]\n";

class ServedSessions : public test::EvaluateCommand {
 protected:
  /// Runs one session of a scenario in a child of the server; its files without wall-clock time.
  std::map<std::string, std::string> run(core::ForkServer& server, const std::string& scenario,
                                         const std::string& time_limit) const {
    const std::string results = folder("session");
    server.begin({"run", scenario, "--quiet", "--results", results, "--overwrite", "--set",
                  "protocol.time_limit=" + time_limit, "--set", "verdict.judge=false"},
                 folder("log.txt"));
    while (!server.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_EQ(server.exitCode(), 0) << core::readFile(folder("log.txt"), "log");
    return test::filesWithoutWallClock(results);
  }
  /// Memory that a process occupies [KiB].
  static long memoryOf(int process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    std::string line;
    while (std::getline(status, line)) {
      if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
    }
    return 0;
  }
  /// Each session has the bytes of the first on its scenario, and the server's memory stays.
  void expectSameForEver(int sessions, const std::string& time_limit) const {
    constexpr long kMemory = 16 * 1024;  // [KiB] that the heap's blocks may come and go
    const std::vector<std::string> scenarios = {"roundabout_entry", "crossing_straight"};
    core::ForkServer server(CDIFF_PROGRAM, {"serve"});
    std::map<std::string, std::map<std::string, std::string>> first;
    long memory = 0;
    for (int i = 0; i < sessions; ++i) {
      const std::string& scenario = scenarios[static_cast<std::size_t>(i) % scenarios.size()];
      const auto files = run(server, scenario, time_limit);
      if (i < 2) first[scenario] = files;
      if (i == 3) memory = memoryOf(server.id());
      ASSERT_EQ(files, first[scenario]) << "session " << i;
    }
    EXPECT_TRUE(server.serves());
    EXPECT_GT(memory, 0);
    EXPECT_LT(memoryOf(server.id()), memory + kMemory);
  }
};

TEST_F(ServedSessions, HaveTheBytesOfSessionsOfTheirOwnProgram) {
  const std::string matrix = write("matrix.yaml", kMatrix);
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", folder("served")}), 0) << output();
  expectOutput("start-up");
  ASSERT_EQ(cdiff({"evaluate", matrix, "--results", folder("fresh"), "--fresh"}), 0) << output();
  const auto served = test::filesWithoutWallClock(folder("served"));
  const auto fresh = test::filesWithoutWallClock(folder("fresh"));
  EXPECT_EQ(std::count_if(served.begin(), served.end(),
                          [](const auto& file) {
                            return file.first.find("/trace.csv") != std::string::npos;
                          }),
            8);
  ASSERT_EQ(served.size(), fresh.size());
  for (const auto& [file, text] : fresh)
    EXPECT_TRUE(served.count(file) == 1 && served.at(file) == text) << file;
}

TEST_F(ServedSessions, SayWhatIsWrongAsTheirOwnProgramWould) {
  core::ForkServer server(CDIFF_PROGRAM, {"serve"});
  server.begin({"run", "roundabout_entri", "--results", folder("none")}, folder("log.txt"));
  while (!server.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_EQ(server.exitCode(), 3);
  const std::string served = core::readFile(folder("log.txt"), "log");
  EXPECT_EQ(cdiff({"run", "roundabout_entri", "--results", folder("none")}), 3);
  EXPECT_EQ(served, output());
  EXPECT_TRUE(server.serves());
}

TEST_F(ServedSessions, AreTheSameOneAfterAnother) { expectSameForEver(6, "1"); }

TEST_F(ServedSessions, AreTheSameTwoHundredTimes) { expectSameForEver(200, "2"); }

}  // namespace
}  // namespace cdiff::evaluation
