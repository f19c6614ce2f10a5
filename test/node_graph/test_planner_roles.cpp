// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Every planner of the package in every role that its descriptor names, through roslaunch with a
// real SUMO and the shipped weights; every other pair is refused.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "node_graph/session_launch.h"
#include "planners/registry.h"

namespace cdiff {
namespace {

/// A planner as that of the ego, or as that of the CBVs.
struct PlannerRole {
  std::string planner;
  bool ego = false;
  std::string key() const { return ego ? "ego_planner" : "cbv_planner"; }
  std::string name() const { return planner + (ego ? "_as_ego" : "_as_cbv"); }
};

void PrintTo(const PlannerRole& role, std::ostream* stream) {  // NOLINT: a name of GoogleTest
  *stream << role.name();
}

std::vector<PlannerRole> rolesThatAre(bool possible) {
  std::vector<PlannerRole> roles;
  for (const planning::PlannerDescriptor& planner : planners::packagePlanners()) {
    if (planner.drives_ego == possible) roles.push_back({planner.name, true});
    if (planner.drives_cbv == possible) roles.push_back({planner.name, false});
  }
  return roles;
}

/// At 10 Hz from the begin on; the last tick decides nothing.
int decisionsWithin(double seconds) { return static_cast<int>(std::ceil(10.0 * seconds - 1e-6)); }

/// Both slots are occupied from 2.6 s on, with PDM-Lite as ego.
session::SessionRequest twoCbvs() {
  session::SessionRequest request;
  request.scenario =
      (core::shareFolder() / "config/suites/development/scenarios/development_right_2.yaml")
          .string();
  request.seed = "1";
  request.ego_planner = "pdm_lite";
  request.cbv_planner = "pdm_lite";
  request.set = {"protocol.time_limit=4", "verdict.judge=false"};
  return request;
}

std::string launchArguments(const session::SessionRequest& request) {
  return "scenario:=" + request.scenario + " seed:=" + request.seed +
         " ego_planner:=" + request.ego_planner + " cbv_planner:=\"" + request.cbv_planner +
         "\" set:=\"" + core::joinText(request.set, " ") + "\"";
}

class InItsRole : public Session, public testing::WithParamInterface<PlannerRole> {};

TEST_P(InItsRole, HasTheResultOfTheClosedLoop) {
  session::SessionRequest request = twoCbvs();
  (GetParam().ego ? request.ego_planner : request.cbv_planner) = GetParam().planner;
  const std::string log = launch("e2e_cdiff session.launch", launchArguments(request));
  ASSERT_EQ(exitCode(), "0\n") << log;
  const fs::path alone = folder_ / "one_process";
  test::runInOneProcess(request, alone);
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_EQ(summary()[GetParam().key()], GetParam().planner);
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  const std::string driver = (GetParam().ego ? "ego:" : "cbv:") + GetParam().planner;
  ASSERT_TRUE(summary()["planner_latency_ms"].contains(driver)) << log;
  const int decisions = summary()["planner_latency_ms"][driver]["n"];
  EXPECT_GT(decisions, 0);
  if (GetParam().ego) {
    EXPECT_EQ(decisions, decisionsWithin(summary()["simulated_seconds"]));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPlanner, InItsRole, testing::ValuesIn(rolesThatAre(true)),
                         [](const auto& info) { return info.param.name(); });

class NotItsRole : public Session, public testing::WithParamInterface<PlannerRole> {};

TEST_P(NotItsRole, IsRefusedWithTheListOfThePossible) {
  session::SessionRequest request = twoCbvs();
  (GetParam().ego ? request.ego_planner : request.cbv_planner) = GetParam().planner;
  const std::string log = launch("e2e_cdiff session.launch", launchArguments(request));
  EXPECT_EQ(exitCode(), "3\n") << log;
  std::vector<std::string> possible;
  for (const PlannerRole& role : rolesThatAre(true)) {
    if (role.ego == GetParam().ego) possible.push_back(role.planner);
  }
  std::sort(possible.begin(), possible.end());
  EXPECT_NE(log.find("key '" + GetParam().key() + "' is '" + GetParam().planner +
                     "', a planner that does not drive " + (GetParam().ego ? "the ego" : "CBVs") +
                     "; expected one of " + core::joinText(possible, ", ")),
            std::string::npos)
      << log;
}

INSTANTIATE_TEST_SUITE_P(EveryPlanner, NotItsRole, testing::ValuesIn(rolesThatAre(false)),
                         [](const auto& info) { return info.param.name(); });

TEST_F(Session, TheCbvPlannerNodeDrivesRiftAndDiffusionBySlot) {
  session::SessionRequest request = twoCbvs();
  request.cbv_planner = "[rift, diffusion]";
  const std::string log = launch("e2e_cdiff session.launch", launchArguments(request));
  ASSERT_EQ(exitCode(), "0\n") << log;
  const fs::path alone = folder_ / "one_process";
  test::runInOneProcess(request, alone);
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_EQ(planners::findPlanner(summary()["cbv_planner"])->cbv_node, "cbv_planner_node");
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  std::set<std::string> drivers;
  const nlohmann::json result = summary();
  for (const auto& selection : result["cbv"]["selections"])
    drivers.insert(selection["planner"].get<std::string>());
  EXPECT_EQ(drivers, (std::set<std::string>{"diffusion", "rift"}));
}

}  // namespace
}  // namespace cdiff
