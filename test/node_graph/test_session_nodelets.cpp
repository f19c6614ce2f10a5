// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions whose nodes are threads of one process: the same bytes as one process and as nodes, and
// a result whatever becomes of the nodes or their process.
#include <gtest/gtest.h>
#include <signal.h>

#include "e2e_cdiff/GuidanceReport.h"
#include "node_graph/launched_session.h"
#include "node_graph/session_launch.h"
#include "nodelet/NodeletUnload.h"
#include "ros/ros.h"
#include "support/temporary_folder.h"

namespace cdiff {
namespace {

/// The messages of a bag one after the other, but for what names the deployment or the wall clock.
std::string messagesIn(const fs::path& bag_file) {
  std::string text;
  rosbag::Bag bag(bag_file.string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    text += message.getTopic() + " " + std::to_string(message.getTime().toNSec()) + " ";
    const bool of_wall_clock = message.isType<::e2e_cdiff::SessionInfo>() ||
                               message.isType<::e2e_cdiff::ControlAction>() ||
                               message.isType<::e2e_cdiff::GuidanceReport>();
    if (!of_wall_clock) {
      std::vector<std::uint8_t> bytes(message.size());
      ros::serialization::OStream stream(bytes.data(), message.size());
      message.write(stream);
      text.append(bytes.begin(), bytes.end());
    }
    text += "\n";
  }
  return text;
}

TEST_F(Session, NodeletsHaveTheTraceAndTheBagOfNodesAndOfOneProcess) {
  const std::string arguments =
      "scenario:=crossing_left_turn seed:=2 record:=true camera:=true "
      "set:=\"protocol.time_limit=8 verdict.judge=false\"";
  const std::string log = launch("e2e_cdiff session.launch", "nodelets:=true " + arguments);
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(exitCode(), "0\n") << log;
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = {"protocol.time_limit=8", "verdict.judge=false"};
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, alone));
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the session shows no CBV; choose one that does";
  fs::rename(results(), folder_ / "nodelets");
  const std::string of_nodes = launch("e2e_cdiff session.launch", arguments);
  EXPECT_EQ(exitCode(), "0\n") << of_nodes;
  EXPECT_EQ(messagesIn(folder_ / "nodelets" / "session.bag"),
            messagesIn(results() / "session.bag"));
}

TEST_F(Session, NodeletsRefuseBadInputAsNodesDo) {
  const std::string log =
      launch("e2e_cdiff session.launch", "nodelets:=true scenario:=crossing_left_trun");
  EXPECT_EQ(exitCode(), "3\n") << log;
  EXPECT_NE(log.find("crossing_left_turn"), std::string::npos) << log;
}

// A session that goes on for as long as the fault needs.
const char* const kLong =
    "nodelets:=true record:=true scenario:=crossing_straight cbv_planner:=pdm_lite "
    "set:=\"at_most=2 protocol.time_limit=60\"";

std::string script(const test::LaunchedSession& session) {
  return "BUILD=" E2E_CDIFF_BUILD " exec " E2E_CDIFF_SCRIPTS "/session results:=" +
         session.results().string() + " " + kLong;
}

/// Who ends the process of all nodes, by which signal.
struct Crash {
  const char* nodelet;  ///< from inside; empty: from outside
  int signal;
};

std::string nameOf(const ::testing::TestParamInfo<Crash>& info) {
  const std::string nodelet = info.param.nodelet;
  return (nodelet.empty() ? "outside" : nodelet) + "_" + std::to_string(info.param.signal);
}

class NodeletCrash : public ::testing::TestWithParam<Crash> {
 protected:
  /// A session in which every node takes part.
  std::string command() const {
    return "export CRASHING_NODELET=" + order().string() + " LD_PRELOAD=" CRASHING_NODELET "; " +
           script(session_) + " camera:=true";
  }
  bool crash() {
    const auto& [nodelet, signal] = GetParam();
    if (nodelet[0] == '\0') return session_.signal("session_nodelets", signal);
    core::writeFileAtomically(order(), std::string(nodelet) + " " + std::to_string(signal));
    return true;
  }
  fs::path order() const { return session_.folder() / "order"; }

  test::LaunchedSession session_;
};

/// The trace of the session as it would have gone on.
const std::string& wholeTrace() {
  static const std::string trace = [] {
    const test::TemporaryFolder folder;
    session::SessionRequest request;
    request.scenario = "crossing_straight";
    request.cbv_planner = "pdm_lite";
    request.set = {"protocol.time_limit=60"};
    test::runInOneProcess(request, folder.path() / "results");
    return core::readFile(folder.path() / "results" / "trace.csv", "trace");
  }();
  return trace;
}

// The simulator's record has all ticks but those that its process had not handed to the system.
TEST_P(NodeletCrash, LeavesTheResultOfTheTicksBefore) {
  session_.start(command());
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_TRUE(crash());
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 2) << session_.log();
  EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
  EXPECT_EQ(session_.summary()["status"], "error");
  EXPECT_EQ(session_.fault(),
            "session_nodelets: the process of all nodes ended before the session did, by signal " +
                std::to_string(GetParam().signal))
      << session_.log();
  const std::string trace = core::readFile(session_.results() / "trace.csv", "trace");
  constexpr std::size_t kEnd =
      8000;  // [bytes] more than the last tick, which repeats the one before
  ASSERT_GT(trace.size(), 2 * kEnd);
  const std::string driven = trace.substr(0, trace.size() - kEnd);
  EXPECT_EQ(wholeTrace().substr(0, driven.size()), driven);
  EXPECT_FALSE(fs::exists(session_.results() / ".reserve"));
  EXPECT_EQ(session_.leftovers(), "");
}

INSTANTIATE_TEST_SUITE_P(Outside, NodeletCrash,
                         ::testing::Values(Crash{"", SIGSEGV}, Crash{"", SIGKILL}), nameOf);
INSTANTIATE_TEST_SUITE_P(
    Inside, NodeletCrash,
    ::testing::Values(Crash{"cbv_identification_node", SIGSEGV}, Crash{"camera_node", SIGSEGV},
                      Crash{"recorder_node", SIGSEGV}, Crash{"traffic_simulator_node", SIGSEGV},
                      Crash{"cbv_planner_node", SIGSEGV}, Crash{"metrics_node", SIGSEGV}),
    nameOf);
INSTANTIATE_TEST_SUITE_P(
    KilledInside, NodeletCrash,
    ::testing::Values(Crash{"cbv_identification_node", SIGKILL}, Crash{"camera_node", SIGKILL},
                      Crash{"recorder_node", SIGKILL}, Crash{"traffic_simulator_node", SIGKILL},
                      Crash{"cbv_planner_node", SIGKILL}, Crash{"metrics_node", SIGKILL}),
    nameOf);

/// A session with the crashing plug-in.
std::string scriptWithPlugin(const test::LaunchedSession& session, const std::string& variables,
                             const std::string& arguments) {
  return "export E2E_CDIFF_PLUGINS=" CRASHING_PLUGIN " " + variables + "; " + script(session) +
         " " + arguments;
}

TEST(NodeletSession, AMetricThatHangsIsNamedAndCostsItsOwnMeasuresAlone) {
  test::LaunchedSession session;
  session.start(scriptWithPlugin(session, "CRASHING_METRIC=endless", "answer_timeout:=3"));
  EXPECT_LT(session.endAfter(100.0), 100.0);
  EXPECT_EQ(session.exitCode(), "2\n") << session.log();
  EXPECT_EQ(session.summary()["status"], "error");
  EXPECT_EQ(session.fault().rfind("metrics_node: ", 0), 0U) << session.fault();
  EXPECT_NE(session.fault().find("it calls metric 'crashing_metric'"), std::string::npos)
      << session.fault();
  // The plug-in hangs at its sixth tick: five and more were driven.
  EXPECT_GE(session.summary()["simulated_seconds"], 0.25);
  EXPECT_TRUE(session.summary()["metrics"]["crashing_calls"]["value"].is_null());
  EXPECT_EQ(session.leftovers(), "");
}

/// Where the plug-in ends the process of all nodes: variables and arguments of the session, and
/// what its result names.
struct CrashingNodelet {
  const char* variables;
  const char* arguments;
  const char* named;
};

class NodeletFault : public ::testing::TestWithParam<CrashingNodelet> {};

TEST_P(NodeletFault, EndsTheSessionWithAResult) {
  test::LaunchedSession session;
  session.start(scriptWithPlugin(session, GetParam().variables, GetParam().arguments));
  EXPECT_LT(session.endAfter(100.0), 100.0);
  EXPECT_EQ(session.exitCode(), "2\n") << session.log();
  EXPECT_EQ(session.summary()["status"], "error");
  const std::string fault = session.fault();
  EXPECT_EQ(fault.rfind("session_nodelets: ", 0), 0U) << fault << session.log();
  EXPECT_NE(fault.find("by signal " + std::to_string(SIGSEGV)), std::string::npos) << fault;
  EXPECT_NE(fault.find(std::string(GetParam().named) + " of plug-in '" CRASHING_PLUGIN),
            std::string::npos)
      << fault;
  EXPECT_FALSE(fs::exists(session.results() / ".reserve"));
  EXPECT_EQ(session.leftovers(), "");
}

INSTANTIATE_TEST_SUITE_P(
    NodeletFault, NodeletFault,
    ::testing::Values(
        CrashingNodelet{"CRASHING_METRIC=segmentation_fault", "", "metric 'crashing_metric'"},
        CrashingNodelet{"", "ego_planner:=quitter set:=quitter.end=segmentation_fault",
                        "planner 'quitter'"},
        CrashingNodelet{"", "cbv_planner:=quitter set:=quitter.end=segmentation_fault",
                        "planner 'quitter'"},
        CrashingNodelet{"", "ego_planner:=quitter set:=quitter.end=constructor_fault",
                        "planner 'quitter'"}));

TEST(NodeletSession, ANodeletThatIsUnloadedEndsTheSessionAndIsNamed) {
  test::LaunchedSession session;
  session.launch(std::string("ns:=a ") + kLong);
  ASSERT_TRUE(session.hasTicks()) << session.log();
  const std::string master = "http://127.0.0.1:" + std::to_string(session.port());
  ros::init(ros::M_string{{"__master", master}}, "unloader", ros::init_options::NoSigintHandler);
  ros::NodeHandle node;
  nodelet::NodeletUnload unload;
  unload.request.name = "/a/cbv_identification_node";
  EXPECT_TRUE(ros::service::call("/a/session_nodelets/unload_nodelet", unload)) << session.log();
  ros::shutdown();
  EXPECT_LT(session.endAfter(100.0), 100.0) << session.log();
  EXPECT_EQ(session.exitCode(), "2\n") << session.log();
  EXPECT_EQ(session.summary()["status"], "error");
  EXPECT_EQ(session.fault(), "cbv_identification_node: the node left the session");
  EXPECT_EQ(session.leftovers(), "");
}

}  // namespace
}  // namespace cdiff
