// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions whose CBVs are driven by a program of the user's own.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <fstream>

#include "core/file.h"
#include "core/text.h"
#include "node_graph/bags/replay.h"
#include "node_graph/launched_session.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

/// What every planner of these tests does: answers each CBV of a decision by
/// `drive(traffic, cbv, state)`, where it gives a command.
const char* const kPlanner = R"(
import rospy
from e2e_cdiff.msg import *
newest = {}
def run(drive):
    rospy.init_node("my_cbvs", disable_rostime=True)
    controls = [rospy.Publisher(f"/cbv_{slot}/control", ControlAction, queue_size=10) for slot in range(2)]
    def take(message):
        if isinstance(message, TrafficSnapshot) and message.status != TrafficSnapshot.RUNNING:
            return rospy.signal_shutdown("the session is over")
        newest[type(message)] = message
        traffic, selection = newest.get(TrafficSnapshot), newest.get(CbvSelection)
        if not traffic or not selection or traffic.tick != selection.tick:
            return
        states = {vehicle.id: vehicle.state for vehicle in traffic.vehicles}
        for cbv in selection.assignments:
            command = drive(traffic, cbv, states[cbv.vehicle_id]) if cbv.vehicle_id in states else None
            if command is not None:
                controls[cbv.slot].publish(command)
    rospy.Subscriber("/cbv/selection", CbvSelection, take, tcp_nodelay=True)
    rospy.Subscriber("/traffic", TrafficSnapshot, take, tcp_nodelay=True)
    rospy.spin()
)";

// Its first CBV is chosen before 6 s.
const std::string kCrossing = "scenario:=crossing_left_turn seed:=3 cbv_planner:=external ";

class CbvSession : public ::testing::Test {
 protected:
  /// A session beside a program of Python, whose text follows kPlanner.
  void runBeside(const std::string& program, const std::string& arguments) {
    core::writeFileAtomically(session_.folder() / "cbvs.py", kPlanner + program);
    runBesideFile("cbvs.py", arguments);
  }
  void runBesideFile(const std::string& file, const std::string& arguments) {
    session_.start("roslaunch -p " + std::to_string(session_.port()) +
                   " e2e_cdiff session.launch results:=" + session_.results().string() + " " +
                   kCrossing + arguments + " & sleep 1; timeout 90 /usr/bin/python3 -B " + file +
                   " __name:=my_cbvs; wait");
    EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  }
  std::string faults() const { return session_.summary()["faults"].dump(); }
  /// Column of the CBVs' rows in trace.csv, in their order.
  std::vector<double> column(std::size_t index) const {
    std::vector<double> values;
    std::ifstream file(session_.results() / "trace.csv");
    for (std::string line; std::getline(file, line);) {
      const std::vector<std::string> cells = core::splitText(line, ',');
      if (cells.size() > index && cells[2] == "cbv" && !cells[index].empty())
        values.push_back(std::stod(cells[index]));
    }
    return values;
  }
  static constexpr std::size_t kThrottle = 7, kBrake = 9;

  test::LaunchedSession session_;
};

TEST_F(CbvSession, TheExampleDrivesThemAndItsBagGivesTheSameResult) {
  runBesideFile(E2E_CDIFF_EXAMPLES "/external_cbv.py",
                "mode:=safety_critical record:=true set:=\"protocol.time_limit=8 "
                "verdict.judge=false\"");
  const nlohmann::json live = session_.summary();
  ASSERT_FALSE(live.empty()) << session_.log();
  EXPECT_EQ(live["faults"].size(), 0U) << faults();
  EXPECT_EQ(live["cbv_planner"], "external");
  EXPECT_GE(live["cbv"]["count"], 1);
  EXPECT_GT(live["planner_latency_ms"]["cbv:external"]["n"], 10);
  const std::vector<double> throttle = column(kThrottle);
  EXPECT_NE(std::count(throttle.begin(), throttle.end(), 0.6), 0) << "the example's";
  const fs::path again = session_.folder() / "again";
  node_graph::replayBag(session_.results() / "session.bag", again);
  EXPECT_EQ(core::readFile(again / "trace.csv", "trace"),
            core::readFile(session_.results() / "trace.csv", "trace"));
  const auto replayed = nlohmann::json::parse(core::readFile(again / "summary.json", "summary"));
  for (const char* key : {"cbv", "metrics", "planner_latency_ms", "ego"})
    EXPECT_EQ(replayed[key], live[key]) << key;
}

TEST_F(CbvSession, WrongCommandsBrakeFullyAndAreNamed) {
  runBeside(R"(
def drive(traffic, cbv, state):
    wrong = traffic.tick % 4 == 0
    return ControlAction(tick=traffic.tick, vehicle_id="nobody" if wrong else cbv.vehicle_id, throttle=0.5 if wrong else float("nan"))
run(drive)
)",
            "set:=\"protocol.time_limit=8\"");
  EXPECT_NE(session_.summary()["status"], "error") << session_.log();
  EXPECT_NE(faults().find("cbv_0/control: the command is for vehicle 'nobody', and the slot holds"),
            std::string::npos)
      << faults();
  EXPECT_NE(faults().find("got throttle nan"), std::string::npos) << faults();
  const std::vector<double> brakes = column(kBrake);
  EXPECT_GT(brakes.size(), 10U);
  for (const double brake : brakes) EXPECT_EQ(brake, 1.0);
}

TEST_F(CbvSession, SilenceInLockstepEndsTheSessionAndNamesWhoIsSilent) {
  runBeside("run(lambda traffic, cbv, state: None)\n",
            "answer_timeout:=4 set:=\"protocol.time_limit=8\"");
  EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
  EXPECT_EQ(session_.summary()["status"], "error");
  EXPECT_EQ(session_.fault().find("the external CBV planner: nothing came for 4 s: cbv_0/control "
                                  "for tick "),
            0U)
      << session_.fault();
  EXPECT_TRUE(fs::exists(session_.results() / "report.html"));
}

// It takes the CBV over at its first answer and falls silent 0.5 s later.
TEST_F(CbvSession, SilenceBesideTheWallClockBrakesFully) {
  runBeside(R"(
begin = []
def drive(traffic, cbv, state):
    begin.append(traffic.time)
    return ControlAction(tick=traffic.tick, vehicle_id=cbv.vehicle_id, throttle=0.5) if traffic.time < begin[0] + 0.5 else None
run(drive)
)",
            "set:=\"protocol.time_limit=8 real_time_factor=1\"");
  EXPECT_NE(session_.summary()["status"], "error") << session_.log();
  const nlohmann::json late = session_.summary()["late_answers"]["planners"];
  EXPECT_GT(late["cbv:external"]["by_full_brake"], 0) << late;
  const std::vector<double> brakes = column(kBrake);
  ASSERT_FALSE(brakes.empty()) << session_.log();
  EXPECT_EQ(brakes.front(), 0.0);
  EXPECT_EQ(brakes.back(), 1.0);
}

TEST_F(CbvSession, ALostPlannerIsNamed) {
  runBeside(R"(
import os, signal
begin = []
def drive(traffic, cbv, state):
    begin.append(traffic.time)
    if traffic.time > begin[0] + 0.5:
        os.kill(os.getpid(), signal.SIGKILL)
    return ControlAction(tick=traffic.tick, vehicle_id=cbv.vehicle_id, throttle=0.5)
run(drive)
)",
            "");
  EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
  EXPECT_EQ(session_.fault().find("the external CBV planner: no node publishes on cbv_"), 0U)
      << session_.fault();
}

}  // namespace
}  // namespace cdiff
