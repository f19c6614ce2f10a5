// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions that are steered, and repeated by the record of what was steered.
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

class SteeringCommand : public test::CdiffCommand {
 protected:
  /// Runs a session of 7 s into a folder of that name; its trace.
  std::string trace(const std::string& name, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--quiet", "--results", path(name)});
    EXPECT_LE(cdiff(arguments), 1) << output();
    return summary(name).at("trace_sha256");
  }
  nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(core::readFile(path(name) + "/summary.json", "summary"));
  }
  const std::vector<std::string> free_ = {"crossing_left_turn", "--set", "protocol.time_limit=7",
                                          "--seed", "3"};
  std::vector<std::string> with(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = free_;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(SteeringCommand, ARecordRepeatsTheSessionAndBecomesAScenario) {
  const std::string recorded = trace(
      "recorded",
      with({"--set", "steering=[{at: 5, profile: safety_critical}, {at: 5.5, target_speed: 11}]",
            "--set", "report.front_view_rate=0"}));
  EXPECT_NE(trace("free", free_), recorded);
  EXPECT_EQ(trace("again", with({"--steering", path("recorded")})), recorded);
  ASSERT_EQ(cdiff({"steering", path("recorded")}), 0);
  expectOutput(
      "\nsteering:\n  - {at: 5, profile: \"safety_critical\"}\n"
      "  - {at: 5.5, target_speed: 11}\n");
  std::ofstream(path("found.yaml")) << output();
  EXPECT_EQ(trace("found", {path("found.yaml")}), recorded);
  const nlohmann::json steering = summary("found").at("steering");
  EXPECT_EQ(steering.at("by_hand"), false);
  EXPECT_EQ(steering.at("changes").size(), 2U);
  EXPECT_EQ(steering.at("changes")[0].at("tick"), 100);
  EXPECT_EQ(steering.at("changes")[0].at("before"), "naturalistic");
}

TEST_F(SteeringCommand, WhatCannotBeIsBadInput) {
  EXPECT_EQ(cdiff({"run", "crossing_left_turn", "--set", "cbv_planner=pdm_lite", "--set",
                   "steering=[{at: 1, profile: none}]"}),
            3);
  expectOutput("'pdm_lite' is not guided");
  EXPECT_EQ(cdiff({"run", "crossing_left_turn", "--set",
                   "steering=[{at: 1, place: a, lane: nowhere_0, position: 9}]"}),
            3);
  expectOutput("key 'steering[0]': place: vehicle 'a': lane 'nowhere_0'");
  EXPECT_EQ(cdiff({"run", "crossing_left_turn", "--steering", path("nothing")}), 3);
  EXPECT_EQ(cdiff({"steering", path("nothing")}), 3);
}

}  // namespace
}  // namespace cdiff::cli
