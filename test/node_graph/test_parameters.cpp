// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <csignal>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/session_files.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

using Values = std::map<std::string, std::string>;

TEST(Parameters, UnknownOneIsAnErrorThatNamesTheNearest) {
  const Parameters parameters(Values{{"scenari", "x"}});
  try {
    parameters.requireKnown({"scenario", "seed"});
    FAIL() << "expected an InputError";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("~scenari; the nearest known one is ~scenario"),
              std::string::npos);
  }
}

TEST(Parameters, EmptyTextMeansNotGiven) {
  const Parameters parameters(Values{{"seed", ""}, {"start_timeout", ""}});
  EXPECT_EQ(parameters.text("seed"), "");
  EXPECT_EQ(parameters.positive("start_timeout", 30.0), 30.0);
  EXPECT_TRUE(parameters.flag("record", true));
}

TEST(Parameters, WrongValuesAreErrors) {
  const Parameters parameters(
      Values{{"start_timeout", "-1"}, {"answer_timeout", "soon"}, {"record", "yes"}});
  EXPECT_THROW(parameters.positive("start_timeout", 1.0), core::InputError);
  EXPECT_THROW(parameters.positive("answer_timeout", 1.0), core::InputError);
  EXPECT_THROW(parameters.flag("record", false), core::InputError);
}

TEST(Parameters, SessionRequestTakesAssignmentsApart) {
  const session::SessionRequest request =
      sessionRequest(Parameters(Values{{"set", "seed=3  max_cbv=1"}, {"mode", "naturalistic"}}));
  EXPECT_EQ(request.scenario, "crossing_left_turn");
  EXPECT_EQ(request.mode, "naturalistic");
  EXPECT_EQ(request.set, (std::vector<std::string>{"seed=3", "max_cbv=1"}));
}

TEST(Parameters, BadAssignmentNamesTheParameter) {
  try {
    session::resolveRequest(sessionRequest(Parameters(Values{{"set", "sed=3"}})));
    FAIL() << "expected an InputError";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("parameter ~set"), std::string::npos) << error.what();
  }
}

std::string refusalOf(const Parameters& parameters) {
  try {
    requestedScenario(parameters);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, ARouteOfASealedSuiteIsRefused) {
  const test::TemporaryFolder folder;
  const auto suite = folder.path() / "sealed_mine";
  const auto scenario = suite / "scenarios" / "mine.yaml";
  std::filesystem::create_directories(scenario.parent_path());
  core::writeFileAtomically(scenario,
                            "network: crossing_district\nroute:\n  edges: [a2_b2, b2_c2]\n");
  const Parameters parameters(Values{{"scenario", scenario.string()}});
  EXPECT_EQ(refusalOf(parameters), "");
  core::writeFileAtomically(suite / "seal.sha256", "");
  for (const char* part : {"a route of the sealed suite sealed_mine", "--open-sealed"})
    EXPECT_NE(refusalOf(parameters).find(part), std::string::npos) << refusalOf(parameters);
}

TEST(StopSignal, IsRememberedOnceRaised) {
  StopSignal stop;
  EXPECT_FALSE(stop.raised());
  std::raise(SIGINT);  // blocked: does not end the test
  EXPECT_TRUE(stop.raised());
  EXPECT_TRUE(stop.raised());
}

}  // namespace
}  // namespace cdiff::node_graph
