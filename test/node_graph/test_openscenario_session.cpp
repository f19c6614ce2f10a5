// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// An OpenSCENARIO file through roslaunch, with a real SUMO and a master of its own on a free port.
#include "core/file.h"
#include "node_graph/session_launch.h"
#include "session/session_request.h"

namespace cdiff {
namespace {

TEST_F(Session, AnOpenScenarioFileHasTheTraceOfTheClosedLoop) {
  session::SessionRequest request;
  request.scenario =
      (core::shareFolder() / "config/openscenario/crossing_pedestrian.xosc").string();
  request.ego_planner = "pdm_lite";
  request.set = {"protocol.time_limit=12", "report.front_view_rate=0"};
  const std::string log =
      launch("e2e_cdiff session.launch",
             "scenario:=" + request.scenario +
                 " ego_planner:=pdm_lite set:=\"protocol.time_limit=12 report.front_view_rate=0\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, folder_ / "one_process"));
}

}  // namespace
}  // namespace cdiff
