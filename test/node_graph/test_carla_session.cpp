// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions on a stand-in for CARLA's ROS bridge (fake_carla_bridge.cpp).
#include <sys/resource.h>

#include "node_graph/session_launch.h"

namespace cdiff {
namespace {

class CarlaSession : public Session {
 protected:
  /// The session's log; the bridge stops after `frames`.
  std::string launchCarla(int frames, const std::string& arguments) {
    return launch(
        E2E_CDIFF_TEST_FOLDER "/carla.launch",
        "frames:=" + std::to_string(frames) + " report:=" + report().string() + " " + arguments);
  }
  fs::path report() const { return folder_ / "report.json"; }
  nlohmann::json bridge() const {
    return nlohmann::json::parse(core::readFile(report(), "report of the bridge"));
  }
  /// Every frame from the first that was commanded has one command of each vehicle.
  void expectOneCommandEach() const {
    EXPECT_EQ(bridge()["least_commands"], 1) << bridge();
    EXPECT_EQ(bridge()["most_commands"], 1) << bridge();
    EXPECT_EQ(bridge()["commanded"], bridge()["frames_between"]) << bridge();
    EXPECT_EQ(bridge()["unexpected"], 0) << bridge();
  }
  bool faultNames(const std::string& word) const {
    const nlohmann::json faults = summary()["faults"];
    for (const nlohmann::json& fault : faults) {
      if (fault["text"].get<std::string>().find(word) != std::string::npos) return true;
    }
    return false;
  }
};

constexpr int kEndless = 1000000;  // frames

TEST_F(CarlaSession, DrivesCriticalVehiclesWithOneCommandAFrame) {
  const std::string log =
      launchCarla(kEndless, "set:=\"protocol.time_limit=6 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(summary()["simulated_seconds"], 6.0);
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  EXPECT_GT(summary()["cbv"]["count"], 0) << log;
  EXPECT_EQ(exitCode(), "0\n");
  ASSERT_TRUE(fs::exists(report())) << log;
  expectOneCommandEach();
  EXPECT_EQ(bridge()["commanded"], 121) << bridge();  // ticks 0 to 120
}

// The ego is ours, too, and every vehicle is awaited.
TEST_F(CarlaSession, DrivesTheEgoWhereAsked) {
  const std::string log = launchCarla(kEndless,
                                      "ego_planner:=pdm_lite ego_commanded:=true "
                                      "set:=\"protocol.time_limit=4 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  EXPECT_GT(summary()["ego"]["route_completion_percent"], 0.0);
  EXPECT_EQ(summary()["planner_latency_ms"]["ego:pdm_lite"]["n"], 40);
  expectOneCommandEach();
}

TEST_F(CarlaSession, EndsReadableWhereTheBridgeStops) {
  const std::string log = launchCarla(100, "set:=\"protocol.time_limit=60\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "error");
  EXPECT_EQ(lastFaultSource(), "carla_bridge");
  EXPECT_EQ(exitCode(), "2\n");
  EXPECT_TRUE(fs::exists(results() / "report.html"));
}

TEST_F(CarlaSession, LeavesAnExitCodeWhereItsFilesCannotGrow) {
  rlimit usual{};
  ::getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit small{400000, usual.rlim_max};  // less than the trace of two minutes
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string log =
      launchCarla(kEndless, "set:=\"protocol.time_limit=120 verdict.judge=false\"");
  ::setrlimit(RLIMIT_FSIZE, &usual);
  ASSERT_TRUE(fs::exists(results() / "exit_code")) << log;
  EXPECT_EQ(exitCode(), "2\n") << log;
  EXPECT_NE(log.find("trace.csv"), std::string::npos) << log;
}

TEST_F(CarlaSession, LeavesAnExitCodeWhereNoBridgeAnswers) {
  const std::string log = launchCarla(0, "start_timeout:=3 set:=\"seed=1\"");
  ASSERT_TRUE(fs::exists(results() / "exit_code")) << log;
  EXPECT_EQ(exitCode(), "2\n") << log;
  EXPECT_FALSE(fs::exists(results() / "summary.json"));
}

TEST_F(CarlaSession, RefusesARoleThatNoActorHas) {
  const std::string log = launchCarla(kEndless, "cbv_roles:=\"hero1 hero9\" set:=\"seed=1\"");
  EXPECT_EQ(exitCode(), "3\n") << log;
  EXPECT_NE(log.find("'hero9'"), std::string::npos) << log;
  EXPECT_FALSE(fs::exists(results() / "summary.json"));
}

TEST_F(CarlaSession, RefusesARoleThatTheBridgeDoesNotControl) {
  const std::string log =
      launchCarla(kEndless, "controlled:=\"hero hero1 hero2\" start_timeout:=15 set:=\"seed=1\"");
  EXPECT_EQ(exitCode(), "3\n") << log;
  EXPECT_NE(log.find("/carla/hero3/vehicle_control_cmd"), std::string::npos) << log;
}

TEST_F(CarlaSession, NamesAnotherNodeThatCommands) {
  const std::string log =
      launchCarla(kEndless, "commander:=true set:=\"protocol.time_limit=4 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_TRUE(faultNames("/other_commander")) << summary()["faults"];
  EXPECT_GT(bridge()["unexpected"], 0) << bridge();
}

// A planner that sees drives nobody by the image of another frame.
TEST_F(CarlaSession, BrakesWithoutTheImageOfTheFrame) {
  const std::string log = launchCarla(kEndless,
                                      "cbv_planner:=diffusion image_delay:=1 image_timeout:=0.2 "
                                      "set:=\"protocol.time_limit=5 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_GT(summary()["cbv"]["count"], 0) << log;
  EXPECT_TRUE(faultNames("no image")) << summary()["faults"];
  expectOneCommandEach();
}

TEST_F(CarlaSession, LosesNoFrameOfAMinute) {
  const std::string log = launchCarla(
      kEndless, "cbv_planner:=diffusion set:=\"protocol.time_limit=60 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  EXPECT_GT(summary()["cbv"]["count"], 1) << log;
  expectOneCommandEach();
  EXPECT_EQ(bridge()["commanded"], 1201) << bridge();
  std::cout << "latency p95 " << bridge()["latency_p95_ms"] << " ms\n";
}

}  // namespace
}  // namespace cdiff
