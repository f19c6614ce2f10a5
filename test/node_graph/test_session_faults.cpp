// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions some of whose processes are killed or stopped: each ends in time, names who is to blame,
// leaves a result and no process. "Campaign" runs under `scripts/test --nightly`.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <random>
#include <thread>

#include "core/output_folder.h"
#include "node_graph/launched_session.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

// A session that goes on for as long as the fault needs, at the pace of the wall clock.
const char* const kLong =
    "scenario:=crossing_straight cbv_planner:=pdm_lite set:=\"real_time_factor=1 "
    "protocol.time_limit=60\"";

class SessionFaults : public ::testing::Test {
 protected:
  void expectError(const std::string& culprit) {
    EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
    EXPECT_EQ(session_.summary()["status"], "error");
    EXPECT_EQ(session_.fault().find(culprit + ": "), 0U) << session_.fault() << session_.log();
    EXPECT_EQ(session_.leftovers(), "");
    EXPECT_FALSE(fs::exists(session_.results() / ".reserve"));
  }
  /// Files that are only written on the way to others.
  std::string halfFiles() const {
    std::string names;
    for (const auto& entry : fs::recursive_directory_iterator(session_.results())) {
      const std::string name = entry.path().filename().string();
      const std::string extension = entry.path().extension().string();
      if (name == ".reserve" || name == ".lock" || extension == ".part" || extension == ".active" ||
          name.find(".tmp") != std::string::npos)
        names += entry.path().string() + "\n";
    }
    return names;
  }
  std::size_t timesInLog(const std::string& text) const {
    const std::string log = session_.log();
    std::size_t times = 0;
    for (std::size_t at = log.find(text); at != std::string::npos; at = log.find(text, at + 1))
      ++times;
    return times;
  }
  /// The summary for the terminal, once, with the files where they lie.
  void expectTable(const std::string& status, const std::string& verdict) const {
    const auto row = [](std::string name, const std::string& value) {
      name.resize(24, ' ');
      return "\n  " + name + value + "\n";
    };
    EXPECT_EQ(timesInLog(row("status", status)), 1U) << session_.log();
    EXPECT_EQ(timesInLog(row("verdict", verdict)), 1U) << session_.log();
    EXPECT_EQ(timesInLog(row("results", session_.results().string())), 1U) << session_.log();
  }
  /// Ticks in the bag of the session.
  std::uint64_t recordedTicks() const {
    const rosbag::Bag bag((session_.results() / "session.bag").string(), rosbag::bagmode::Read);
    return rosbag::View(bag, rosbag::TopicQuery("/traffic")).size();
  }
  void launchWithExternalEgo(const std::string& arguments) {
    session_.start(
        "roslaunch -p " + std::to_string(session_.port()) +
        " e2e_cdiff session.launch ego_planner:=external results:=" + session_.results().string() +
        " " + arguments + " & sleep 1; rosrun e2e_cdiff external_ego_node __name:=my_ego & wait");
    ASSERT_TRUE(session_.hasTicks()) << session_.log();
  }
  /// scripts/session of a session, as a command.
  static std::string script(const std::string& arguments, const test::LaunchedSession& session) {
    return "BUILD=" E2E_CDIFF_BUILD " exec " E2E_CDIFF_SCRIPTS "/session results:=" +
           session.results().string() + " " + arguments;
  }
  void pause(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }

  test::LaunchedSession session_;
};

TEST_F(SessionFaults, StoppedSimulatorIsMissedAndEnded) {
  session_.launch(std::string("record:=true heartbeat_timeout:=3 ") + kLong);
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_TRUE(session_.signal("traffic_simulator_node", SIGSTOP));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("traffic_simulator_node");
  EXPECT_NE(session_.fault().find(" 3 s"), std::string::npos) << session_.fault();
  EXPECT_GT(recordedTicks(), 0U);
  expectTable("error", "ERROR");
  EXPECT_EQ(timesInLog("\n  bag                     " +
                       (session_.results() / "session.bag").string() + "\n"),
            1U)
      << session_.log();
}

// The limit is 2 s; before, only the silence of 10 s or 30 s showed it.
TEST_F(SessionFaults, KilledExternalEgoIsNoticedByItsConnection) {
  ASSERT_NO_FATAL_FAILURE(launchWithExternalEgo(kLong));
  ASSERT_TRUE(session_.signal("my_ego", SIGKILL));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("the external ego planner");
  EXPECT_LT(session_.errorAfter("the external ego planner: no node publishes"), 2.0);
}

TEST_F(SessionFaults, KilledExternalEgoIsNoticedInLockstep) {
  ASSERT_NO_FATAL_FAILURE(
      launchWithExternalEgo("scenario:=crossing_straight cbv_planner:=pdm_lite set:=\"at_most=1 "
                            "protocol.time_limit=60\""));
  ASSERT_TRUE(session_.signal("my_ego", SIGKILL));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("the external ego planner");
  EXPECT_LT(session_.errorAfter("the external ego planner: no node publishes"), 2.0);
}

// The ego brakes for want of a planner and would be blocked after 5 s or so, half of the limit.
TEST_F(SessionFaults, StoppedEgoPlannerIsNamedThoughTheEgoStands) {
  session_.launch(kLong);
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_TRUE(session_.signal("ego_planner_node", SIGSTOP));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("ego_planner_node");
  EXPECT_GE(session_.errorAfter("ego_planner_node: nothing came for 10 s"), 9.0);
}

TEST_F(SessionFaults, SimulatorKilledBeforeTheSessionLeavesAResult) {
  session_.launch("seed:=7 scenario:=crossing_straight");
  ASSERT_GT(session_.process("metrics_node"), 0) << session_.log();
  pause(100);
  ASSERT_TRUE(session_.signal("traffic_simulator_node", SIGKILL));
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  expectError("traffic_simulator_node");
  EXPECT_EQ(session_.summary()["seed"], 7);
}

TEST_F(SessionFaults, KilledMasterIsNotTheUser) {
  session_.launch(kLong);
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_GT(session_.process("sumo"), 0);
  ASSERT_TRUE(session_.signal("rosmaster", SIGKILL));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("rosmaster");
}

TEST_F(SessionFaults, StoppedNodeIsBlamedOnceAndEnded) {
  session_.launch(std::string("answer_timeout:=4 ") + kLong);
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_TRUE(session_.signal("cbv_identification_node", SIGSTOP));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  expectError("cbv_identification_node");
  EXPECT_NE(session_.fault().find(" 4 s"), std::string::npos) << session_.fault();
}

// No vehicle is near enough to become a CBV, so nothing waits for the camera and the planner of
// CBVs. For 2.5 s at twice real time, 5 s of simulated time, they read nothing; then the selections
// of these 5 s reach them before the snapshots do.
TEST_F(SessionFaults, NodesThatNoVehicleNeedsMayLagBehind) {
  const std::vector<std::string> idle = {"camera_node", "diffusion_planner_node"};
  session_.launch(
      "scenario:=crossing_straight cbv_planner:=diffusion set:=\"at_most=2 cbv.minimum_distance=0 "
      "cbv.search_radius=1\"");
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  for (const std::string& node : idle) ASSERT_TRUE(session_.signal(node, SIGSTOP));
  pause(2500);
  for (const std::string& node : idle) ASSERT_TRUE(session_.signal(node, SIGCONT));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  EXPECT_EQ(session_.exitCode(), "0\n") << session_.log();
  const nlohmann::json summary = session_.summary();
  EXPECT_EQ(summary["status"], "completed");
  EXPECT_EQ(summary["cbv"]["count"], 0);
  EXPECT_EQ(summary["faults"].size(), 0U) << summary["faults"];
}

TEST_F(SessionFaults, ScriptStoppedInItsFirstSecondGives130AndAResult) {
  session_.start(script("scenario:=crossing_straight", session_));
  ASSERT_TRUE(session_.isScript());
  pause(300);
  session_.signalLaunch(SIGINT);
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 130) << session_.log();
  EXPECT_EQ(session_.exitCode(), "130\n");
  EXPECT_EQ(session_.summary()["status"], "interrupted");
  EXPECT_EQ(session_.leftovers(), "");
}

// The metrics node has not begun, so the simulator writes the result; it printed no table.
TEST_F(SessionFaults, ScriptStoppedBeforeTheFirstTickPrintsTheTable) {
  session_.start(script("scenario:=crossing_straight", session_));
  ASSERT_TRUE(session_.signal("metrics_node", SIGSTOP));
  ASSERT_TRUE(session_.hasFile(".reserve")) << session_.log();
  session_.signalLaunch(SIGINT);
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 130) << session_.log();
  EXPECT_EQ(session_.summary()["status"], "interrupted");
  expectTable("interrupted", "INTERRUPTED");
  EXPECT_EQ(session_.leftovers(), "");
}

// The nodes need no master once they are connected; roslaunch waits for it without end.
TEST_F(SessionFaults, ScriptEndsThoughItsMasterIsStopped) {
  session_.start(
      script("scenario:=crossing_straight cbv_planner:=pdm_lite set:=\"at_most=1 "
             "protocol.time_limit=8 verdict.judge=false\"",
             session_));
  ASSERT_TRUE(session_.hasTicks()) << session_.log();
  ASSERT_TRUE(session_.signal("rosmaster", SIGSTOP));
  EXPECT_LT(session_.endAfter(200.0), 200.0) << session_.log();
  EXPECT_EQ(session_.exitStatus(), 0) << session_.log();
  EXPECT_EQ(session_.summary()["status"], "timed_out");
  EXPECT_EQ(timesInLog("session: no ROS master answers at http://"), 1U) << session_.log();
  EXPECT_EQ(halfFiles(), "");
  EXPECT_EQ(session_.leftovers(), "");
}

// roslaunch, and each node that begins, waits for such a master without end.
TEST_F(SessionFaults, ScriptEndsThoughItsMasterStopsBeforeTheNodesBegin) {
  session_.start(script("scenario:=crossing_straight", session_));
  ASSERT_GT(session_.process("rosout"), 0) << session_.log();  // the first one after the master
  ASSERT_TRUE(session_.signal("rosmaster", SIGSTOP)) << session_.log();
  EXPECT_LT(session_.endAfter(200.0), 200.0) << session_.log();
  EXPECT_EQ(session_.exitStatus(), 2) << session_.log();
  EXPECT_EQ(session_.summary()["status"], "error");
  EXPECT_EQ(session_.fault().find("rosmaster: no ROS master answers at http://"), 0U)
      << session_.fault();
  EXPECT_EQ(session_.leftovers(), "");
}

// The nodes have begun their files and wait for an ego that never comes.
TEST_F(SessionFaults, ScriptEndsThoughItsMasterStopsWhileTheNodesBegin) {
  session_.start(
      script("record:=true start_timeout:=8 answer_timeout:=4 ego_planner:=external "
             "scenario:=crossing_straight",
             session_));
  ASSERT_TRUE(session_.hasFile("session.yaml")) << session_.log();
  ASSERT_TRUE(session_.signal("rosmaster", SIGSTOP)) << session_.log();
  EXPECT_LT(session_.endAfter(200.0), 200.0) << session_.log();
  EXPECT_EQ(session_.exitStatus(), 2) << session_.log();
  expectError("rosmaster");
  EXPECT_EQ(halfFiles(), "");
}

// One that ends while it starts its nodes knows only those before. Here it is a function of the
// shell, and its node takes a second to finish its file.
TEST_F(SessionFaults, ScriptWaitsForNodesThatItsRoslaunchForgot) {
  const std::string finished = (session_.folder() / "finished").string();
  session_.start(
      "roslaunch() { env --default-signal=INT bash -c 'trap \"sleep 1; touch $0; exit\" INT; touch "
      "$0.begun; while :; do sleep 0.1; done' " +
      finished + " __name:=late_node & while [ ! -e " + finished +
      ".begun ]; do sleep 0.1; done; }; export -f roslaunch; " +
      script("scenario:=crossing_straight", session_));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  EXPECT_EQ(session_.exitStatus(), 2) << session_.log();
  EXPECT_TRUE(fs::exists(finished)) << session_.log();
  EXPECT_EQ(session_.leftovers(), "");
}

// The recorder alone had begun: its bag, without a tick, gives way to the result.
TEST_F(SessionFaults, ScriptWritesTheResultOfASessionThatLeftNothingButItsBag) {
  core::OutputFolder(session_.results()).claim("session.bag");
  session_.start("roslaunch() { echo bag >" + (session_.results() / "session.bag").string() +
                 "; }; export -f roslaunch; " + script("scenario:=crossing_straight", session_));
  EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  EXPECT_EQ(session_.exitStatus(), 2) << session_.log();
  EXPECT_EQ(session_.summary()["status"], "error");
}

TEST_F(SessionFaults, ScriptNamesAMasterThatDoesNotAnswer) {
  session_.start("E2E_CDIFF_MASTER=http://127.0.0.1:" + std::to_string(session_.port()) +
                 " BUILD=" E2E_CDIFF_BUILD " exec " E2E_CDIFF_SCRIPTS
                 "/session scenario:=crossing_straight");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 3) << session_.log();
  EXPECT_EQ(session_.log().find("session: E2E_CDIFF_MASTER is "), 0U) << session_.log();
  EXPECT_EQ(session_.log().find('\n'), session_.log().size() - 1) << session_.log();  // one line
}

TEST_F(SessionFaults, UnknownLaunchArgumentIsNamedWithTheNearest) {
  session_.launch("senario:=crossing_straight");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitCode(), "3\n") << session_.log();
  EXPECT_NE(session_.log().find("'senario:=crossing_straight'"), std::string::npos)
      << session_.log();
  EXPECT_NE(session_.log().find("'scenario'"), std::string::npos) << session_.log();
}

TEST_F(SessionFaults, UnknownLaunchArgumentIsRefusedOnceAndLeavesNoResult) {
  session_.start("HOME=" + session_.folder().string() + "/home exec roslaunch -p " +
                 std::to_string(session_.port()) +
                 " e2e_cdiff session.launch senario:=crossing_straight");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(timesInLog("has no argument 'senario'"), 1U) << session_.log();
  EXPECT_FALSE(fs::exists(session_.folder() / "home" / "e2e_cdiff_results"));
  EXPECT_FALSE(fs::exists(session_.results()));
  EXPECT_EQ(session_.leftovers(), "");
}

TEST_F(SessionFaults, PluginsOfANodeThatCrashesAreNamed) {
  const std::string launch = "E2E_CDIFF_PLUGINS=" CRASHING_PLUGIN " exec roslaunch -p " +
                             std::to_string(session_.port()) +
                             " e2e_cdiff session.launch scenario:=crossing_straight "
                             "cbv_planner:=pdm_lite results:=" +
                             session_.results().string();
  session_.start(launch + " ego_planner:=quitter set:=quitter.end=segmentation_fault");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  expectError("ego_planner_node");
  EXPECT_NE(session_.fault().find("it calls planner 'quitter' of plug-in '" CRASHING_PLUGIN),
            std::string::npos)
      << session_.fault();
}

TEST_F(SessionFaults, ACrashingMetricIsNamedAndLeftOut) {
  session_.start("export CRASHING_METRIC=segmentation_fault E2E_CDIFF_PLUGINS=" CRASHING_PLUGIN
                 "; exec roslaunch -p " +
                 std::to_string(session_.port()) +
                 " e2e_cdiff session.launch scenario:=crossing_straight cbv_planner:=pdm_lite "
                 "results:=" +
                 session_.results().string());
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  expectError("metrics_node");
  EXPECT_NE(session_.fault().find("it calls metric 'crashing_metric'"), std::string::npos)
      << session_.fault();
  EXPECT_TRUE(session_.summary()["metrics"]["crashing_calls"]["value"].is_null());
}

// roslaunch itself would run the session without such an argument.
TEST_F(SessionFaults, LaunchArgumentWithALineBreakIsRefused) {
  session_.launch(R"(set:=$'protocol.time_limit=1\nmax_cbv=1')");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitCode(), "3\n") << session_.log();
  EXPECT_EQ(timesInLog("argument 'set' holds a line break"), 1U) << session_.log();
  EXPECT_FALSE(fs::exists(session_.results() / "summary.json"));
}

TEST_F(SessionFaults, LaunchArgumentWithASecondSignIsRefused) {
  session_.launch("scenario:=crossing_straight set:=seed:=3");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitCode(), "3\n") << session_.log();
  EXPECT_EQ(timesInLog("argument 'set' holds ':='"), 1U) << session_.log();
}

TEST_F(SessionFaults, ScriptNamesAnArgumentOfAnotherKind) {
  for (const std::string argument :
       {"record:=banana", "rviz:=1.5", "start_timeout:=abc", "start_timeout:=0",
        "start_timeout:=0.0e9", "start_timeout:=1e400", "start_timeout:=1e-400", "watch_port:=0.5",
        "watch_port:=65536", "watch_port:=99999999999999999999"}) {
    test::LaunchedSession session;
    session.start(script("scenario:=crossing_straight " + argument, session));
    EXPECT_LT(session.endAfter(100.0), 100.0);
    EXPECT_EQ(session.exitStatus(), 3) << session.log();
    const std::string name = argument.substr(0, argument.find(':'));
    EXPECT_EQ(session.log().find("session: argument '" + name + "' is '"), 0U) << session.log();
    EXPECT_FALSE(fs::exists(session.results()));
  }
}

TEST_F(SessionFaults, ScriptRemovesOnlyTheFoldersThatItMade) {
  const fs::path kept = session_.folder() / "kept";
  fs::create_directory(kept);
  session_.start("BUILD=" E2E_CDIFF_BUILD " exec " E2E_CDIFF_SCRIPTS
                 "/session scenario:=no_scenario results:=" +
                 (kept / "made" / "too").string());
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 3) << session_.log();
  EXPECT_TRUE(fs::exists(kept));
  EXPECT_FALSE(fs::exists(kept / "made"));
}

TEST_F(SessionFaults, ScriptNamesATemporaryFolderThatIsNotThere) {
  session_.start("export TMPDIR=/no_such_folder; " +
                 script("scenario:=crossing_straight", session_));
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitStatus(), 3) << session_.log();
  EXPECT_EQ(timesInLog("TMPDIR is '/no_such_folder'"), 1U) << session_.log();
  EXPECT_FALSE(fs::exists(session_.results()));
}

struct Fault {
  const char* process;
  int signal;
};

std::string nameOf(const ::testing::TestParamInfo<Fault>& info) {
  return std::string(info.param.signal == SIGKILL ? "Killed_" : "Stopped_") + info.param.process;
}

class SessionFaultsCampaign : public SessionFaults, public ::testing::WithParamInterface<Fault> {};

// At the default limits, whenever it comes: during the start of the nodes or on the way. A master
// that is killed while roslaunch starts its own rosout can leave that behind; scripts/session ends
// it, so that fault is tried by the script.
TEST_P(SessionFaultsCampaign, EndsWithin45SecondsAndNamesTheCulprit) {
  const Fault fault = GetParam();
  std::string name = nameOf({fault, 0});
  std::seed_seq seed(name.begin(), name.end());  // a moment of its own for each fault
  std::mt19937 random(seed);
  for (const char* pace : {"real_time_factor=1", "real_time_factor=0"}) {
    const int delay = static_cast<int>(random() % 3000);  // [ms]
    SCOPED_TRACE(std::string(pace) + ", " + std::to_string(delay) + " ms");
    test::LaunchedSession session;
    const std::string arguments =
        "record:=true camera:=true scenario:=roundabout_cross cbv_planner:=pdm_lite set:=\"" +
        std::string(pace) + " protocol.time_limit=60\"";
    if (fault.process == std::string("rosmaster")) {
      session.start(script(arguments, session));
    } else {
      session.launch(arguments);
    }
    ASSERT_GT(session.process("metrics_node"), 0);
    pause(delay);
    const bool ended = fs::exists(session.results() / "exit_code");
    const bool sent = !ended && session.signal(fault.process, fault.signal);
    if (!sent && pace == std::string("real_time_factor=0")) continue;  // it may be over by then
    ASSERT_TRUE(sent) << session.log();
    EXPECT_LT(session.endAfter(60.0), 45.0) << session.log();
    EXPECT_EQ(session.exitCode(), "2\n") << session.log();
    EXPECT_EQ(session.summary()["status"], "error");
    EXPECT_EQ(session.fault().find(fault.process), 0U) << session.fault();
    EXPECT_EQ(session.leftovers(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(
    SessionFaultsCampaign, SessionFaultsCampaign,
    ::testing::Values(Fault{"traffic_simulator_node", SIGKILL},
                      Fault{"traffic_simulator_node", SIGSTOP},
                      Fault{"cbv_identification_node", SIGKILL},
                      Fault{"cbv_identification_node", SIGSTOP}, Fault{"ego_planner_node", SIGKILL},
                      Fault{"ego_planner_node", SIGSTOP}, Fault{"cbv_planner_node", SIGKILL},
                      Fault{"cbv_planner_node", SIGSTOP}, Fault{"camera_node", SIGKILL},
                      Fault{"camera_node", SIGSTOP}, Fault{"metrics_node", SIGKILL},
                      Fault{"metrics_node", SIGSTOP}, Fault{"recorder_node", SIGKILL},
                      Fault{"recorder_node", SIGSTOP}, Fault{"rosmaster", SIGKILL}),
    nameOf);

}  // namespace
}  // namespace cdiff
