// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions beside nodes and tools that are no part of them.
#include "node_graph/bags/replay.h"
#include "node_graph/session_launch.h"

namespace cdiff {
namespace {

TEST_F(Session, ToolsFindItsFramesAndNothingToComplainAbout) {
  const fs::path found = folder_ / "tools";
  fs::create_directories(found);
  const std::string log =
      launch(E2E_CDIFF_TEST_FOLDER "/looked_at.launch", "found:=" + found.string(),
             "bash " E2E_CDIFF_TEST_FOLDER "/look_at_session " + found.string());
  ASSERT_TRUE(fs::exists(found / "frames")) << log;
  const std::string wtf = core::readFile(found / "roswtf", "roswtf's output");
  const std::size_t online = wtf.find("Online checks summary");
  ASSERT_NE(online, std::string::npos) << wtf << log;  // what comes before is the machine's
  EXPECT_NE(wtf.find("No errors or warnings", online), std::string::npos) << wtf;
  const std::string tf = core::readFile(found / "tf", "rostopic's output");
  EXPECT_NE(tf.find("child_frame_id: \"ego/base_link\""), std::string::npos) << tf;
  // map -> base_link as in the snapshot; the optical axis looks ahead, 6 degrees downwards.
  EXPECT_EQ(core::readFile(found / "frames", "frames"), "base_link 0 0 0\ncamera_optical 1\n");
}

/// Whether a fault of the session names both.
bool faultNames(const nlohmann::json& summary, const std::string& one, const std::string& other) {
  for (const nlohmann::json& fault : summary["faults"]) {
    const auto text = fault["text"].get<std::string>();
    if (text.find(one) != std::string::npos && text.find(other) != std::string::npos) return true;
  }
  return false;
}

// Nor does the pace: at most four times real time, tick 159 (7.95 s) comes after 1.99 s.
TEST_F(Session, NodeThatIsNoPartOfItChangesNothingAndIsNamed) {
  const std::string log = launch(E2E_CDIFF_TEST_FOLDER "/rogue.launch",
                                 "set:=\"protocol.time_limit=8 at_most=4 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.cbv_planner = "pdm_lite";
  request.set = {"protocol.time_limit=8"};
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, alone)) << summary()["faults"];
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the session shows no CBV; choose one that does";
  EXPECT_EQ(summary()["planner_latency_ms"]["cbv:pdm_lite"]["n"],
            summaryIn(alone)["planner_latency_ms"]["cbv:pdm_lite"]["n"]);
  EXPECT_GE(summary()["wall_seconds"], 1.9);
  const std::string session = core::readFile(results() / "session.yaml", "session");
  EXPECT_NE(session.find("deterministic: true"), std::string::npos);
  for (const char* topic :
       {"cbv/selection", "ego/control", "cbv_0/control", "cbv_0/rollout", "tick_ack", "traffic",
        "session", "metrics", "cbv_0/camera/image_raw"}) {
    EXPECT_TRUE(faultNames(summary(), std::string("on ") + topic + " from /rogue_node", "ignored"))
        << topic << summary()["faults"];
  }
  // The first of each topic, then the 10th, the 100th and the 1000th, and the sum: nine topics.
  EXPECT_LE(summary()["faults"].size(), 9U * 5U);
  EXPECT_EQ(node_graph::replayBag(results() / "session.bag", folder_ / "replay").exit_code, 0);
  EXPECT_EQ(summaryIn(folder_ / "replay")["planner_latency_ms"], summary()["planner_latency_ms"]);
}

}  // namespace
}  // namespace cdiff
