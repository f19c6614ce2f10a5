// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "node_graph/session_launch.h"

namespace cdiff {
namespace {

TEST_F(Session, ThePanelsClientPausesStepsAndSteersIt) {
  const fs::path found = folder_ / "found";
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=crossing_left_turn seed:=3 cbv_planner:=diffusion "
                                 "set:=\"protocol.time_limit=8 at_most=1\"",
                                 CDIFF_PANEL_HAND " " + found.string());
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(core::readFile(found, "what was found"),
            "CBV yes\npaused yes\nstepped yes\nrefused yes\nprofile yes\nweight yes\nover yes\n");
  std::vector<std::string> changes;
  const nlohmann::json ended = summary();
  for (const nlohmann::json& change : ended["steering"]["changes"]) {
    EXPECT_EQ(change["by"], "node /panel_hand");
    changes.push_back(change["what"].get<std::string>() + " " + change["after"].get<std::string>());
  }
  EXPECT_EQ(changes,
            (std::vector<std::string>{"profile safety_critical", "weight.collision_seeking 20"}));
}

}  // namespace
}  // namespace cdiff
