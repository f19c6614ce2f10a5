// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Steering as data: a scenario's list, requests, the record of a session, and back.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/scenario_options.h"
#include "session/session_request.h"
#include "session/steering_file.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

ScenarioOptions scenarioWith(const std::string& steering) {
  SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.cbv_planner = "diffusion";
  request.set = {"steering=" + steering};
  return resolveRequest(request);
}

std::string refusalOf(const std::string& steering) {
  try {
    scenarioWith(steering);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Steering, AListOfAScenarioIsReadAndWritten) {
  const ScenarioOptions options = scenarioWith(
      "[{at: 12, profile: safety_critical}, {at: 13.5, objective: speed, weight: 0.25}]");
  ASSERT_EQ(options.steering.size(), 2U);
  EXPECT_EQ(options.steering[0].profile, "safety_critical");
  EXPECT_EQ(options.steering[1].at, 13.5);
  ScenarioOptions again;
  core::loadOptions({"written", core::dumpOptions(options)}, again);
  EXPECT_EQ(core::dumpOptions(again), core::dumpOptions(options));
}

TEST(Steering, BadEntriesAreNamed) {
  struct Case {
    std::string steering, reason;
  };
  for (const Case& c :
       {Case{"[{at: 1, profile: nice}]", "key 'steering[0]': profile 'nice'"},
        Case{"[{at: 1, mode: naturalistic}, {at: 2}]", "key 'steering[1]': it changes nothing"},
        Case{"[{at: 0, remove: car}]", "expected a later time"},
        Case{"[{at: 1, target_speed: 0.2}]", "[0.5, 40] m/s"},
        Case{"[{at: 1, objective: speedy, weight: 1}]", "'speed'"},
        Case{"[{at: 1, profile: none, weight: 3}]", "expected 'objective'"},
        Case{"[{at: 1, choose: a, lane: e_0}]", "expected 'place'"},
        Case{"[{at: 1, shade: red}]", "unknown key"}}) {
    EXPECT_NE(refusalOf(c.steering).find(c.reason), std::string::npos)
        << c.steering << ": " << refusalOf(c.steering);
  }
}

TEST(Steering, TheFiercestModeIsThatOfTheWholeSession) {
  ScenarioOptions options;
  const auto fiercestWith = [&](const std::string& mode) {
    options.steering.emplace_back();
    options.steering.back().mode = mode;
    return options.fiercestMode();
  };
  EXPECT_EQ(fiercestWith(""), "naturalistic");
  EXPECT_EQ(fiercestWith("challenging"), "challenging");
  EXPECT_EQ(fiercestWith("naturalistic"), "challenging");
  EXPECT_EQ(fiercestWith("safety_critical"), "safety_critical");
  EXPECT_EQ(fiercestWith("challenging"), "safety_critical");
}

// Each field, as a change of the record, is the entry that asks for it again.
TEST(Steering, AnEntryIsWhatItsChangesAskFor) {
  std::vector<SteeringEntry> entries(8);
  entries[0].profile = "none";
  entries[1].mode = "safety_critical";
  entries[2].objective = "collision_seeking";
  entries[2].weight = 12.5;
  entries[3].target_speed = 1.0 / 3.0;
  entries[4].choose = "a \"b\"";
  entries[5].release = "c";
  entries[6].remove = "d";
  entries[7].place = "probe";
  entries[7].lane = ":j_0_0";
  entries[7].position = 0.1 + 0.2;
  entries[7].speed = 7.0;
  for (SteeringEntry& entry : entries) {
    entry.at = 2.9000000000000004;
    const auto requests = requestsOf(entry);
    ASSERT_EQ(requests.size(), 1U);
    const auto& [by, what, value] = requests[0];
    const bool ends = what == steered::kRelease || what == steered::kRemove;
    const traffic::SteeringChange change{by, what, ends ? value : "", ends ? "" : value};
    EXPECT_EQ(flowText(entryOf(change, entry.at)), flowText(entry));
    ScenarioOptions read;
    core::loadOptions({"flow", "steering: [" + flowText(entry) + "]"}, read);
    ASSERT_EQ(read.steering.size(), 1U) << flowText(entry);
    EXPECT_EQ(flowText(read.steering[0]), flowText(entry));
  }
}

/// A result folder that holds what is read of one.
class SteeringFile : public ::testing::Test {
 protected:
  void write(const std::string& changes, bool paced) const {
    std::ofstream(folder_.path() / "summary.json")
        << R"({"steering": {"by_hand": true, "paced_by_wall_clock": )" << (paced ? "true" : "false")
        << R"(, "changes": [)" << changes << "]}}";
    const ScenarioOptions options = scenarioWith("[{at: 1, profile: none}]");
    std::ofstream file(folder_.path() / "session.yaml");
    file << "schema_version: 1\nscenario:\n";
    std::istringstream lines(core::dumpOptions(options));
    for (std::string line; std::getline(lines, line);) file << "  " << line << "\n";
  }
  static std::string change(const std::string& what, const std::string& after) {
    return R"({"tick": 58, "seconds": 2.9, "by": "node /panel", "what": ")" + what +
           R"(", "before": "", "after": ")" + after + R"(", "refused": ""})";
  }
  test::TemporaryFolder folder_;
};

TEST_F(SteeringFile, TheRecordOfASessionBecomesAScenario) {
  write(change("profile", "none") + ", " + change("weight.speed", "2"), false);
  const std::string text = steeredScenario(folder_.path());
  EXPECT_NE(text.find("\nsteering:\n  - {at: 2.9, profile: \"none\"}\n"
                      "  - {at: 2.9, objective: \"speed\", weight: 2}\n"),
            std::string::npos)
      << text;
  const auto file = folder_.path() / "found.yaml";
  std::ofstream(file) << text;
  const ScenarioOptions found = loadScenario(file.string());
  ASSERT_EQ(found.steering.size(), 2U);
  EXPECT_EQ(found.name, "crossing_left_turn_steered");
  for (const auto& source : {folder_.path(), folder_.path() / "summary.json", file}) {
    const auto entries = readSteering(source);
    ASSERT_EQ(entries.size(), 2U) << source;
    EXPECT_EQ(entries[1].objective, "speed");
  }
}

TEST_F(SteeringFile, ThatOfAPacedSessionIsRefused) {
  write(change("profile", "none"), true);
  for (const auto& call : {std::function<void()>([&] { readSteering(folder_.path()); }),
                           std::function<void()>([&] { steeredScenario(folder_.path()); })}) {
    try {
      call();
      FAIL() << "no error";
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("real_time_factor"), std::string::npos);
    }
  }
}

TEST_F(SteeringFile, WhatHoldsNoneIsRefused) {
  write("", false);
  EXPECT_THROW(steeredScenario(folder_.path()), core::InputError);
  EXPECT_THROW(readSteering("crossing_left_turn"), core::InputError);
  EXPECT_THROW(readSteering(folder_.path() / "none.json"), core::InputError);
  std::ofstream(folder_.path() / "summary.json") << "{}";
  EXPECT_THROW(readSteering(folder_.path()), core::InputError);
}

TEST_F(SteeringFile, WhatIsNoSummaryIsNamedInPlainWords) {
  std::string deep = R"({"steering": )";
  for (int i = 0; i < 300000; ++i) deep += "[";
  const auto file = folder_.path() / "summary.json";
  for (const std::string& text :
       {deep + std::string(300000, ']') + "}", std::string("{}"), std::string("{"),
        std::string(R"({"steering": 1})"), std::string(R"({"scenario": 1, "steering": []})")}) {
    std::ofstream(file) << text;
    const std::string error = test::errorOf([&] { readSteering(folder_.path()); });
    EXPECT_NE(error.find(file.string()), std::string::npos) << error;
    EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
  }
  std::ofstream(file) << R"({"scenario": 1})";
  const std::string error = test::errorOf([&] { steeredSession(file); });
  EXPECT_NE(error.find(file.string()), std::string::npos) << error;
  EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
}

}  // namespace
}  // namespace cdiff::session
