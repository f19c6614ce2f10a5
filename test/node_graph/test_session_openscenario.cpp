// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// OpenSCENARIO files through the node graph.
#include "core/file.h"
#include "node_graph/bags/replay.h"
#include "node_graph/session_launch.h"

namespace cdiff {
namespace {

/// The shipped cut-in, in which pdm_lite drives the car that cuts in once it is a CBV.
class OpenScenarioSession : public Session {
 protected:
  void SetUp() override {
    fs::copy(core::shareFolder() / "config/openscenario", folder_ / "files",
             fs::copy_options::recursive);
    std::string text = core::readFile(file(), "example");
    const std::string entity = "<ScenarioObject name=\"overtaker\">";
    const std::size_t end = text.find("</ScenarioObject>", text.find(entity));
    ASSERT_NE(end, std::string::npos);
    text.insert(end, "<ObjectController><Controller name=\"pdm_lite\"/></ObjectController>");
    core::writeFileAtomically(file(), text);
  }
  std::string file() const { return (folder_ / "files/cut_in.xosc").string(); }
};

TEST_F(OpenScenarioSession, HasTheResultOfTheClosedLoopAndOfItsReplay) {
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=" + file() + " ego_planner:=pdm_lite record:=true");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "completed") << log;  // by the file's stop trigger
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the overtaker is no CBV; choose another file";
  session::SessionRequest request;
  request.scenario = file();
  request.ego_planner = "pdm_lite";
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, alone));
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_EQ(countsIn(results() / "session.bag"), countsIn(alone / "session.bag"));
  node_graph::replayBag(results() / "session.bag", folder_ / "replay");
  expectSameResult(folder_ / "replay", results());
}

}  // namespace
}  // namespace cdiff
