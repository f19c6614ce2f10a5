// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A session of the node graph that is steered by its live page.
#include <gtest/gtest.h>

#include <sstream>

#include "node_graph/bags/recorded_steering.h"
#include "node_graph/session_launch.h"

namespace cdiff {
namespace {

std::vector<std::string> linesOf(const fs::path& file) {
  std::istringstream text(core::readFile(file, "answers"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// Files below a folder that hold a text.
std::vector<std::string> filesWith(const std::string& text, const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (file.is_regular_file() &&
        core::readFile(file.path(), "file").find(text) != std::string::npos)
      files.push_back(file.path().string());
  }
  return files;
}

TEST_F(Session, IsSteeredByItsPageAndRepeatsToTheSameBytes) {
  const fs::path found = folder_ / "found";
  const std::string log =
      launch("e2e_cdiff session.launch",
             "scenario:=crossing_left_turn seed:=3 cbv_planner:=diffusion record:=true "
             "watch:=true set:=\"protocol.time_limit=8\"",
             CDIFF_PAGE_HAND " " + this->log().string() + " " + found.string());
  ASSERT_TRUE(fs::exists(found)) << log;
  const std::vector<std::string> answers = linesOf(found);
  ASSERT_EQ(answers.size(), 11U);
  EXPECT_EQ(answers[0], "-") << "pause";
  EXPECT_NE(answers[1].find("paused already"), std::string::npos) << answers[1];
  for (const int done : {2, 3, 4, 6, 7, 8}) EXPECT_EQ(answers[done], "-") << done;
  EXPECT_NE(answers[5].find("'nobody' is not there"), std::string::npos) << answers[5];
  EXPECT_EQ(answers[10], "report");
  const nlohmann::json changes = summary()["steering"]["changes"];
  ASSERT_EQ(changes.size(), 2U) << changes;
  EXPECT_EQ(changes[0]["what"], "profile");
  EXPECT_EQ(changes[0]["by"], "live page");
  EXPECT_EQ(summary()["verdict"]["outcome"], "not_judged");
  const std::string token = answers[9].substr(answers[9].size() - 33, 32);
  EXPECT_EQ(filesWith(token, results()), std::vector<std::string>());
  EXPECT_EQ(filesWith(token, folder_ / "home"), std::vector<std::string>()) << "logs of ROS";

  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "3";
  request.cbv_planner = "diffusion";
  request.set = {"protocol.time_limit=8"};
  request.steering = node_graph::readSteering(results());
  EXPECT_EQ(traceInOneProcess(request, folder_ / "one_process"), summary()["trace_sha256"]);
}

}  // namespace
}  // namespace cdiff
