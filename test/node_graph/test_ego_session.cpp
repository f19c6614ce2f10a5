// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions whose ego is a Python program, the sensors that it may listen to, and how sessions and
// their bags look to people who use roslaunch and rosbag.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "node_graph/launched_session.h"
#include "node_graph/recorded_bag.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

/// What every ego of these tests does: answers a decision by `answer(traffic, ego)`, whose result
/// it publishes as `Message` on `topic`.
const char* const kEgo = R"(
import collections, time, rospy
from e2e_cdiff.msg import *
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import LaserScan, PointCloud2
from visualization_msgs.msg import MarkerArray
heard = collections.defaultdict(list)  # stamps by name, in seconds
awaited = {}  # messages by name, before the end
def stamp(message):
    return (message.markers[0] if hasattr(message, "markers") else message).header.stamp.to_sec()
def run(topic, Message, answer):
    rospy.init_node("my_ego", disable_rostime=True)
    commands = rospy.Publisher(topic, Message, queue_size=10)
    def on_traffic(traffic):
        if traffic.status != TrafficSnapshot.RUNNING:
            end = time.time() + 10.0
            while time.time() < end and any(len(heard[name]) < count for name, count in awaited.items()):
                time.sleep(0.05)
            rospy.signal_shutdown("the session is over")
        elif traffic.decision_tick and traffic.vehicles:
            command = answer(traffic, traffic.vehicles[0].state)
            if command is not None:
                commands.publish(command)
    kinds = {"odometry": Odometry, "objects": TrackedObjects, "objects/markers": MarkerArray, "scan": LaserScan, "points": PointCloud2}
    inputs = [rospy.Subscriber("/ego/" + name, kinds[name], lambda message, name=name: heard[name].append(stamp(message))) for name in awaited]
    rospy.wait_for_message("/ego/route", Path)
    while any(one.get_num_connections() == 0 for one in inputs):
        time.sleep(0.05)
    rospy.Subscriber("/traffic", TrafficSnapshot, on_traffic, tcp_nodelay=True)
    rospy.spin()
    open("heard", "w").write(" ".join(f"{name} {len(stamps)} {stamps[-1] - stamps[0]}" for name, stamps in sorted(heard.items())))
)";

class EgoSession : public ::testing::Test {
 protected:
  /// A session beside a program of Python, whose text follows kEgo. It may start before there is a
  /// master.
  void runBeside(const std::string& program, const std::string& arguments) {
    core::writeFileAtomically(session_.folder() / "ego.py", kEgo + program);
    runBesideFile("ego.py", arguments);
  }
  void runBesideFile(const std::string& file, const std::string& arguments) {
    session_.start("roslaunch -p " + std::to_string(session_.port()) +
                   " e2e_cdiff session.launch ego_planner:=external cbv_planner:=pdm_lite "
                   "scenario:=crossing_straight results:=" +
                   session_.results().string() + " " + arguments +
                   " & sleep 1; timeout 90 /usr/bin/python3 -B " + file + "; wait");
    EXPECT_LT(session_.endAfter(100.0), 100.0) << session_.log();
  }
  nlohmann::json latencies() const { return session_.summary()["planner_latency_ms"]; }
  std::string faults() const { return session_.summary()["faults"].dump(); }
  void expectDroven(double seconds) const {
    const nlohmann::json summary = session_.summary();
    ASSERT_EQ(summary["status"], "timed_out") << session_.log();
    EXPECT_EQ(summary["faults"].size(), 0U) << faults();
    EXPECT_EQ(summary["planner_latency_ms"]["ego:external"]["n"], std::lround(10.0 * seconds));
    EXPECT_GT(summary["planner_latency_ms"]["ego:external"]["p50"], 0.0);
    EXPECT_GT(summary["ego"]["route_completion_percent"], 5.0);
  }
  /// One column of the ego in trace.csv, by tick.
  std::map<std::uint64_t, double> column(std::size_t index) const {
    std::map<std::uint64_t, double> values;
    std::ifstream file(session_.results() / "trace.csv");
    for (std::string line; std::getline(file, line);) {
      const std::vector<std::string> cells = core::splitText(line, ',');
      if (cells.size() > index && cells[1] == "ego" && !cells[index].empty())
        values[std::stoull(cells[0])] = std::stod(cells[index]);
    }
    return values;
  }
  static constexpr std::size_t kY = 4, kSpeed = 6, kBrake = 9;

  test::LaunchedSession session_;
};

const std::string kShort = "set:=\"protocol.time_limit=4 verdict.judge=false";

TEST_F(EgoSession, TheExampleOfTwentyFiveLinesDrivesByPedals) {
  runBesideFile(E2E_CDIFF_EXAMPLES "/external_ego.py", kShort + "\"");
  expectDroven(4.0);
  EXPECT_NEAR(column(kSpeed).rbegin()->second, 5.5, 0.6) << "between its 5 and 6 m/s";
}

TEST_F(EgoSession, TheExampleDrivesByAckermannCommands) {
  runBesideFile(E2E_CDIFF_EXAMPLES "/ackermann_ego.py", kShort + " ego.command=ackermann\"");
  expectDroven(4.0);
  EXPECT_NEAR(column(kSpeed).rbegin()->second, 5.0, 0.1);
  EXPECT_NEAR(column(kY).rbegin()->second, column(kY).begin()->second, 1.0)
      << "the road is straight";
}

TEST_F(EgoSession, ItDrivesByVelocitiesAndHearsItsSensors) {
  runBeside(R"(
awaited = {"odometry": 81, "objects": 81, "objects/markers": 81, "scan": 40, "points": 40}
def answer(traffic, ego):
    twist = Twist()
    twist.linear.x = 4.0
    return twist
run("/ego/cmd_vel", Twist, answer)
)",
            kShort + " ego.command=cmd_vel at_most=2\"");
  expectDroven(4.0);
  EXPECT_NEAR(column(kSpeed).rbegin()->second, 4.0, 0.1);
  std::istringstream heard(core::readFile(session_.folder() / "heard", "counts"));
  std::map<std::string, std::pair<int, double>> counts;
  for (std::string name; heard >> name;) heard >> counts[name].first >> counts[name].second;
  // 4 s are ticks 0 to 80; the last one decides nothing. The master may connect a listener after
  // the first tick; from then on each message comes.
  EXPECT_EQ(counts.size(), 5U);
  for (const auto& [name, count] : counts) {
    const double period = name == "scan" || name == "points" ? 0.1 : 0.05;
    EXPECT_GT(count.first, 1) << name;
    EXPECT_EQ(count.first, std::lround(count.second / period) + 1) << name;
  }
}

TEST_F(EgoSession, ItDrivesByATrajectory) {
  runBeside(R"(
def answer(traffic, ego):
    path = Path()
    path.header = traffic.header
    for i in range(1, 7):
        pose = PoseStamped()
        pose.header.stamp = traffic.header.stamp + rospy.Duration(0.5 * i)
        pose.pose.position.x = ego.x + 0.5 * i * 5.0
        pose.pose.position.y = ego.y
        path.poses.append(pose)
    return path
run("/ego/trajectory", Path, answer)
)",
            kShort + " ego.command=trajectory\"");
  expectDroven(4.0);
  EXPECT_NEAR(column(kSpeed).rbegin()->second, 5.0, 0.5);
}

TEST_F(EgoSession, BadCommandsBrakeFullyAndAreNamed) {
  runBeside(R"(
def answer(traffic, ego):
    command = AckermannCommand(tick=traffic.tick, speed=5.0)
    if traffic.tick >= 40:
        command.steering_angle = 0.7
    return command
run("/ego/ackermann", AckermannCommand, answer)
)",
            kShort + " ego.command=ackermann\"");
  EXPECT_EQ(session_.summary()["status"], "timed_out") << session_.log();
  EXPECT_NE(faults().find("steering_angle is 0.7 rad; the vehicle's largest is"), std::string::npos)
      << faults();
  const auto brakes = column(kBrake);
  EXPECT_LT(brakes.at(20), 1.0);
  for (const auto& [tick, brake] : brakes) {
    if (tick > 41) {
      EXPECT_EQ(brake, 1.0) << tick;
    }
  }
}

TEST_F(EgoSession, ItBrakesFullyHalfASecondAfterItsLastCommand) {
  runBeside(R"(
last = 0
def answer(traffic, ego):
    global last
    if traffic.time > 2.0:
        return None
    last = traffic.tick
    return AckermannCommand(tick=traffic.tick, speed=5.0)
run("/ego/ackermann", AckermannCommand, answer)
open("last", "w").write(str(last))
)",
            kShort + " ego.command=ackermann real_time_factor=1\"");
  EXPECT_EQ(session_.summary()["status"], "timed_out") << session_.log();
  const std::uint64_t last = std::stoull(core::readFile(session_.folder() / "last", "last tick"));
  ASSERT_GT(last, 0U);
  // A command of tick n counts until n + 10; what drives from a tick on shows at the next one.
  for (const auto& [tick, brake] : column(kBrake)) {
    if (tick > last + 11) {
      EXPECT_EQ(brake, 1.0) << tick;
    }
  }
  EXPECT_EQ(column(kSpeed).rbegin()->second, 0.0);
}

TEST_F(EgoSession, CommandsOfAnotherKindAreNamed) {
  runBesideFile(E2E_CDIFF_EXAMPLES "/ackermann_ego.py", "start_timeout:=8");
  EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
  EXPECT_NE(session_.fault().find("/ackermann_ego publishes /ego/ackermann "
                                  "(e2e_cdiff/AckermannCommand), but ego.command is control"),
            std::string::npos)
      << session_.fault();
  EXPECT_NE(session_.fault().find("set ego.command=ackermann"), std::string::npos);
}

TEST_F(EgoSession, AnotherMessageTypeIsNamed) {
  runBeside("run('/ego/control', Twist, lambda traffic, ego: None)\n", "start_timeout:=8");
  EXPECT_NE(session_.fault().find("/my_ego publishes /ego/control (geometry_msgs/Twist), but "
                                  "ego.command is control, which takes e2e_cdiff/ControlAction"),
            std::string::npos)
      << session_.fault() << session_.log();
}

TEST_F(EgoSession, CommandsWithoutTickAreNamedAsThat) {
  runBeside(
      "run('/ego/control', ControlAction, lambda traffic, ego: ControlAction(throttle=0.5))\n",
      "answer_timeout:=4");
  EXPECT_EQ(session_.exitCode(), "2\n") << session_.log();
  EXPECT_NE(faults().find("it has neither tick nor stamp"), std::string::npos) << faults();
  EXPECT_NE(faults().find("/my_ego"), std::string::npos) << faults();
}

TEST_F(EgoSession, AGoodEndIsNoDeath) {
  session_.launch(kShort + " protocol.time_limit=1\"");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitCode(), "0\n") << session_.log();
  EXPECT_EQ(session_.exitStatus(), 0);
  EXPECT_EQ(session_.log().find("has died"), std::string::npos) << session_.log();
  EXPECT_EQ(session_.leftovers(), "");
}

TEST_F(EgoSession, NeitherIsAFailedVerdictNorTheEndOfAReplay) {
  session_.launch("record:=true set:=\"protocol.time_limit=1\"");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(session_.exitCode(), "1\n") << session_.log();
  EXPECT_EQ(session_.log().find("has died"), std::string::npos) << session_.log();
  session_.start("exec roslaunch -p " + std::to_string(session_.port()) +
                 " e2e_cdiff replay.launch rate:=0 bag:=results/session.bag results:=again");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  EXPECT_EQ(core::readFile(session_.folder() / "again/exit_code", "exit code"), "1\n");
  EXPECT_EQ(session_.log().find("has died"), std::string::npos) << session_.log();
}

TEST_F(EgoSession, PythonFindsThePedalMapBesideTheMessages) {
  session_.start(
      "/usr/bin/python3 -B -c 'from e2e_cdiff.msg import AckermannCommand; from "
      "e2e_cdiff.pedal_map "
      "import pedals_for; print(round(pedals_for(6.0, -4.0)[1], 3))' >pedals");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  // Half of full braking, which is capped at 8 m/s^2.
  EXPECT_EQ(core::readFile(session_.folder() / "pedals", "pedals"), "0.5\n") << session_.log();
}

TEST_F(EgoSession, NoArgumentIsListedAsRequiredButTheBagOfAReplay) {
  session_.start(
      "roslaunch --ros-args e2e_cdiff session.launch >session; roslaunch --ros-args e2e_cdiff "
      "replay.launch >replay");
  EXPECT_LT(session_.endAfter(100.0), 100.0);
  const std::string session = core::readFile(session_.folder() / "session", "arguments");
  EXPECT_EQ(session.find("Required"), std::string::npos) << session;
  EXPECT_NE(session.find("scenario (default"), std::string::npos) << session;
  const std::string replay = core::readFile(session_.folder() / "replay", "arguments");
  const std::size_t optional = replay.find("Optional Arguments:");
  const std::size_t required = replay.find("Required Arguments:\n  bag: ");
  ASSERT_LT(required, optional) << replay;
  EXPECT_EQ(replay.find('\n', replay.find("  bag: ")) + 1, optional) << "bag alone\n" << replay;
}

TEST_F(EgoSession, RosbagPlayShowsTheSceneInRviz) {
  test::recordSession(session_.folder() / "recorded", {"protocol.time_limit=8"});
  session_.start(
      "roslaunch -p " + std::to_string(session_.port()) +
      " e2e_cdiff scene.launch rviz:=false & "
      "for try in $(seq 100); do rosnode list 2>/dev/null | grep -q scene_node && break; sleep "
      "0.3; done; "
      "for topic in markers markers/map markers/rollouts tf ego/odometry; do "
      "timeout 60 rostopic echo -n 1 /$topic >${topic//\\//_} & echoes=\"$echoes $!\"; done; "
      "for try in 1 2 3; do sleep 2; rosbag play --clock --quiet recorded/session.bag; "
      "[ -s markers ] && [ -s markers_map ] && [ -s markers_rollouts ] && [ -s tf ] && [ -s "
      "ego_odometry ] && break; "
      "done; wait $echoes; kill -INT %1; wait");
  EXPECT_LT(session_.endAfter(120.0), 120.0) << session_.log();
  const auto shown = [&](const char* name) {
    return core::readFile(session_.folder() / name, "output");
  };
  EXPECT_NE(shown("markers").find("ns: \"vehicles\""), std::string::npos) << session_.log();
  EXPECT_NE(shown("markers_map").find("ns: \"surfaces\""), std::string::npos) << session_.log();
  EXPECT_NE(shown("markers_rollouts").find("ns: \"rollouts\""), std::string::npos);
  EXPECT_NE(shown("tf").find("ego/base_link"), std::string::npos);
  EXPECT_NE(shown("ego_odometry").find("covariance: [1e-06"), std::string::npos);
}

}  // namespace
}  // namespace cdiff
