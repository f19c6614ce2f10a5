// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Two sessions at once on one master, each in a namespace: what they compute, which topics, frames
// and diagnostics they have.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "node_graph/bags/replay.h"
#include "node_graph/launched_session.h"
#include "node_graph/recorded_bag.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

/// Listens until both sessions have an exit code; writes "KIND NAME" lines to the file `heard`.
const char* const kListener = R"(
import os, time, rospy
from diagnostic_msgs.msg import DiagnosticArray
from tf2_msgs.msg import TFMessage
rospy.init_node("listener", disable_rostime=True)
heard = set()
def on_diagnostics(message):
    heard.update("status " + status.name for status in message.status)
def on_tf(message):
    for one in message.transforms:
        heard.update(["frame " + one.header.frame_id, "frame " + one.child_frame_id])
for topic, kind, take in (("/diagnostics", DiagnosticArray, on_diagnostics), ("/tf", TFMessage, on_tf), ("/tf_static", TFMessage, on_tf)):
    rospy.Subscriber(topic, kind, take)
end = time.time() + 100.0
while time.time() < end and not all(os.path.exists(name + "/exit_code") for name in ("a", "b")):
    try:
        heard.update("topic " + topic for topic, kind in rospy.get_published_topics())
        if rospy.has_param("/use_sim_time"):
            heard.add("parameter /use_sim_time")
    except OSError:
        pass
    time.sleep(0.3)
open("heard", "w").write("".join(line + "\n" for line in sorted(heard)))
)";

session::SessionRequest requestOf(const std::string& seed, const std::string& cbv_planner) {
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = seed;
  request.cbv_planner = cbv_planner;
  request.set = {"protocol.time_limit=8", "verdict.judge=false", "at_most=2"};
  return request;
}

std::string argumentsOf(const session::SessionRequest& request, const std::string& space) {
  return "ns:=" + space + " results:=" + space + " scenario:=" + request.scenario +
         " seed:=" + request.seed + " cbv_planner:=" + request.cbv_planner + " set:=\"" +
         core::joinText(request.set, " ") + "\"";
}

class SessionNamespaces : public ::testing::Test {
 protected:
  /// One by roslaunch, the other by scripts/session.
  void runBoth(const session::SessionRequest& first, const session::SessionRequest& second) {
    core::writeFileAtomically(session_.folder() / "listener.py", kListener);
    session_.start("roscore -p " + std::to_string(session_.port()) +
                   " & core=$!; for try in $(seq 100); do rosnode list >/dev/null 2>&1 && break; "
                   "sleep 0.2; done; /usr/bin/python3 -B listener.py & listener=$!; "
                   "roslaunch e2e_cdiff session.launch record:=true " +
                   argumentsOf(first, "a") +
                   " & first=$!; BUILD=" E2E_CDIFF_BUILD
                   " E2E_CDIFF_MASTER=$ROS_MASTER_URI " E2E_CDIFF_SCRIPTS "/session " +
                   argumentsOf(second, "b") +
                   " & wait $! $first; wait $listener; kill -INT $core; wait $core; true");
    EXPECT_LT(session_.endAfter(150.0), 150.0) << session_.log();
  }
  /// What the listener heard of a kind.
  std::set<std::string> heard(const std::string& kind) const {
    std::set<std::string> names;
    std::ifstream file(session_.folder() / "heard");
    for (std::string line; std::getline(file, line);) {
      if (line.rfind(kind + " ", 0) == 0) names.insert(line.substr(kind.size() + 1));
    }
    return names;
  }
  nlohmann::json summaryIn(const fs::path& folder) const {
    return nlohmann::json::parse(core::readFile(folder / "summary.json", "summary"));
  }

  test::LaunchedSession session_;
};

/// The texts that the aggregator's configuration looks for, one a group.
std::vector<std::string> aggregated() {
  std::vector<std::string> texts;
  std::ifstream file(fs::path(E2E_CDIFF_CONFIG) / "diagnostics.yaml");
  const std::string key = "    contains: '";
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key, 0) == 0)
      texts.push_back(line.substr(key.size(), line.size() - key.size() - 1));
  }
  return texts;
}

TEST_F(SessionNamespaces, TwoOnOneMasterHaveTheBytesOfEachAlone) {
  const session::SessionRequest first = requestOf("3", "diffusion");
  const session::SessionRequest second = requestOf("2", "pdm_lite");
  runBoth(first, second);
  for (const auto& [request, space] : {std::pair{first, "a"}, std::pair{second, "b"}}) {
    const fs::path alone = session_.folder() / (std::string(space) + "_alone");
    test::runInOneProcess(request, alone);
    ASSERT_TRUE(fs::exists(session_.folder() / space / "summary.json")) << session_.log();
    const nlohmann::json summary = summaryIn(session_.folder() / space);
    EXPECT_EQ(summary["trace_sha256"], summaryIn(alone)["trace_sha256"]) << space;
    EXPECT_EQ(summary["faults"].size(), 0U) << summary["faults"];
  }
  const fs::path replayed = session_.folder() / "replayed";
  node_graph::replayBag(session_.folder() / "a" / "session.bag", replayed);
  EXPECT_EQ(summaryIn(replayed)["metrics"], summaryIn(session_.folder() / "a")["metrics"]);
  EXPECT_EQ(summaryIn(replayed)["faults"].size(), 0U) << summaryIn(replayed)["faults"];

  const std::set<std::string> topics = heard("topic");
  EXPECT_EQ(topics.count("/a/traffic") + topics.count("/b/traffic"), 2U) << session_.log();
  EXPECT_EQ(topics.count("/clock") + topics.count("/traffic"), 0U);
  EXPECT_TRUE(heard("parameter").empty());
  const std::set<std::string> frames = heard("frame");
  for (const char* frame : {"a/map", "a/ego/base_link", "a/ego/laser", "b/map", "b/ego/base_link"})
    EXPECT_EQ(frames.count(frame), 1U) << frame;
  for (const std::string& frame : frames)
    EXPECT_TRUE(frame.rfind("a/", 0) == 0 || frame.rfind("b/", 0) == 0) << frame;

  // Each line belongs to one group, and each group has a line.
  const std::vector<std::string> groups = aggregated();
  std::set<std::string> used;
  const std::set<std::string> lines = heard("status");
  for (const std::string& line : lines) {
    const auto holds = [&](const std::string& text) {
      return line.find(text) != std::string::npos;
    };
    if (line.find("node") == std::string::npos) continue;  // of the master's own
    EXPECT_EQ(std::count_if(groups.begin(), groups.end(), holds), 1) << line;
    const auto group = std::find_if(groups.begin(), groups.end(), holds);
    if (group != groups.end()) used.insert(*group);
  }
  EXPECT_EQ(used, std::set<std::string>(groups.begin(), groups.end()));
  EXPECT_EQ(lines.count("a/traffic_simulator_node: session"), 1U);
}

TEST_F(SessionNamespaces, OneThatIsNoNameIsRefused) {
  session_.start("BUILD=" E2E_CDIFF_BUILD " exec " E2E_CDIFF_SCRIPTS "/session ns:=7up results:=a");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 3);
  EXPECT_NE(session_.log().find("'ns:=7up' names no namespace"), std::string::npos)
      << session_.log();
  EXPECT_FALSE(fs::exists(session_.folder() / "a"));
}

}  // namespace
}  // namespace cdiff
