// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// One test per node; each .test file starts that node and runs its test. What is expected is the
// node's contract in the lockstep: an answer that carries the tick, and for observers an
// acknowledgement of every tick and whole files at the end.
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/file.h"
#include "diagnostic_msgs/DiagnosticArray.h"
#include "metrics/metric_registry.h"
#include "node_graph/fake_simulator.h"
#include "node_graph/messages/channel_conversions.h"
#include "rendering/front_camera.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;
using node_graph::msgs::TickAck;
using test::FakeSimulator;

fs::path resultFolder() {
  const fs::path folder =
      fs::temp_directory_path() / ("e2e_cdiff_node_test_" + std::to_string(::getpid()));
  fs::remove_all(folder);
  return folder;
}

/// Ticks 0, 1 and 2 as in lockstep, then the last snapshot, completed.
void runObserver(FakeSimulator& simulator) {
  ASSERT_TRUE(simulator.ready());
  for (std::uint64_t tick = 0; tick < 4; ++tick) {
    traffic::TrafficSnapshot snapshot = simulator.snapshot(tick);
    if (tick == 3) snapshot.status = traffic::SessionStatus::kCompleted;
    simulator.publish(snapshot);
    if (snapshot.decision_tick) simulator.answer(snapshot);
    // The recorder waits for the metrics node's report only where that node takes part; here it
    // does not.
    ASSERT_TRUE(simulator.until([&] {
      return simulator.acknowledged(TickAck::ACKNOWLEDGED, tick);
    })) << tick;
  }
  ASSERT_TRUE(simulator.until([&] { return simulator.acknowledged(TickAck::FINISHED, 3); }));
}

TEST(CbvIdentification, SelectsAtDecisionTicksOnly) {
  FakeSimulator simulator(node_graph::kCbvIdentificationNode, resultFolder());
  ASSERT_TRUE(simulator.ready());
  for (std::uint64_t tick = 0; tick <= 2; ++tick) simulator.publish(simulator.snapshot(tick));
  ASSERT_TRUE(simulator.until([&] { return simulator.selections.count(2) > 0; }));
  EXPECT_EQ(simulator.selections.count(0), 1U);
  EXPECT_EQ(simulator.selections.count(1), 0U);
  EXPECT_EQ(simulator.selections.at(2)->header.stamp, node_graph::toStamp(0.1));
}

TEST(EgoPlanner, DrivesTheEgoAtDecisionTicks) {
  FakeSimulator simulator(node_graph::kEgoPlannerNode, resultFolder());
  ASSERT_TRUE(simulator.ready());
  for (std::uint64_t tick = 0; tick <= 2; ++tick) simulator.publish(simulator.snapshot(tick));
  ASSERT_TRUE(simulator.until([&] { return simulator.ego_controls.count(2) > 0; }));
  EXPECT_EQ(simulator.ego_controls.count(1), 0U);
  const node_graph::msgs::ControlAction& control = *simulator.ego_controls.at(2);
  EXPECT_EQ(control.slot, -1);
  EXPECT_EQ(control.vehicle_id, "ego");
  EXPECT_EQ(control.planner, "ego:pdm_lite");
  EXPECT_EQ(control.fault, "");
  EXPECT_TRUE(node_graph::fromMsg(control).action.valid());
}

/// Goes on with decisions until the planner's diagnostics come, which they do once a second.
bool reportsStatistics(FakeSimulator& simulator) {
  bool reported = false;
  ros::NodeHandle node;
  const auto note = [&](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
    for (const auto& status : message->status)
      reported = reported || status.name.find("cbv_planner_node: planner") != std::string::npos;
  };
  const ros::Subscriber input = node.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 10,
      boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>(note));
  for (std::uint64_t tick = 2; !reported && tick < 60; tick += 2) {
    simulator.publish(simulator.snapshot(tick));
    simulator.publishSelection(simulator.snapshot(tick));
    const ros::WallTime wait = ros::WallTime::now() + ros::WallDuration(0.2);
    simulator.until([&] { return ros::WallTime::now() > wait; });
  }
  return reported;
}

TEST(CbvPlanner, WaitsForTheSelectionThenDrivesItsVehicle) {
  FakeSimulator simulator(node_graph::kCbvPlannerNode, resultFolder());
  ASSERT_TRUE(simulator.ready());
  const traffic::TrafficSnapshot snapshot = simulator.snapshot(0);
  simulator.publish(snapshot);
  const ros::WallTime wait = ros::WallTime::now() + ros::WallDuration(0.3);
  EXPECT_FALSE(simulator.until([&] { return ros::WallTime::now() > wait; }) &&
               !simulator.cbv_controls.empty());
  simulator.publishSelection(snapshot);
  ASSERT_TRUE(simulator.until(
      [&] { return !simulator.cbv_controls.empty() && !simulator.rollouts.empty(); }));
  const node_graph::msgs::ControlAction& control = *simulator.cbv_controls.at(0);
  EXPECT_EQ(control.slot, 0);
  EXPECT_EQ(control.vehicle_id, "bg_0");
  EXPECT_EQ(control.planner, "cbv:pdm_lite");
  EXPECT_EQ(control.fault, "");
  EXPECT_EQ(simulator.rollouts.at(0)->vehicle_id, "bg_0");
  EXPECT_TRUE(simulator.guidance.empty());  // its planner is not guided
  EXPECT_TRUE(reportsStatistics(simulator));
}

TEST(DiffusionPlanner, WaitsForTheImageAndBrakesWithANamedFaultWithoutAUsableOne) {
  FakeSimulator simulator(node_graph::kDiffusionPlannerNode, resultFolder());
  ASSERT_TRUE(simulator.ready());
  const auto publish = [&](std::uint64_t tick) {
    simulator.publish(simulator.snapshot(tick));
    simulator.publishSelection(simulator.snapshot(tick));
  };
  const auto answered = [&](std::uint64_t tick) {
    return simulator.until(
        [&] { return simulator.cbv_controls.count(tick) + simulator.guidance.count(tick) == 2; });
  };
  const auto imageAt = [](std::uint64_t tick) {
    const traffic::CameraImage gray{160, 96, tick, std::vector<std::uint8_t>(3 * 160 * 96, 128)};
    return node_graph::toMsg(gray, 0.05 * static_cast<double>(tick), "bg_0");
  };
  const auto expectNoAnswer = [&](std::uint64_t tick) {
    const ros::WallTime wait = ros::WallTime::now() + ros::WallDuration(0.3);
    EXPECT_TRUE(simulator.until([&] { return ros::WallTime::now() > wait; }));
    EXPECT_EQ(simulator.cbv_controls.count(tick), 0U);
  };
  publish(0);
  expectNoAnswer(0);
  simulator.publishImage(imageAt(0));
  ASSERT_TRUE(answered(0));
  EXPECT_EQ(simulator.cbv_controls.at(0)->planner, "cbv:diffusion");
  EXPECT_EQ(simulator.cbv_controls.at(0)->fault, "");
  ASSERT_TRUE(simulator.until([&] { return simulator.rollouts.count(0) == 1; }));
  EXPECT_GT(simulator.rollouts.at(0)->points.size(), 0U);
  EXPECT_EQ(simulator.guidance.at(0)->vehicles.at(0).vehicle_id, "bg_0");

  publish(2);
  sensor_msgs::Image wrong = imageAt(2);
  wrong.encoding = "bgr8";
  simulator.publishImage(wrong);
  ASSERT_TRUE(answered(2));
  const node_graph::msgs::ControlAction refused = *simulator.cbv_controls.at(2);
  EXPECT_EQ(node_graph::fromMsg(refused).action, traffic::ControlAction::failSafe());
  EXPECT_NE(refused.fault.find("bgr8"), std::string::npos) << refused.fault;
  EXPECT_EQ(simulator.guidance.at(2)->vehicles.at(0).fault, refused.fault);

  // Only once snapshot and selection are there, which come by different connections.
  publish(4);
  expectNoAnswer(4);
  simulator.publish(simulator.snapshot(5));  // the session goes on without it
  ASSERT_TRUE(answered(4));
  EXPECT_EQ(simulator.cbv_controls.at(4)->fault, "no image on cbv_0/camera/image_raw for tick 4");
  EXPECT_EQ(simulator.cbv_controls.at(4)->brake, 1.0);
}

TEST(Camera, ShowsEgoAndOccupiedSlotAtDecisionTicksOnly) {
  FakeSimulator simulator(node_graph::kCameraNode, resultFolder());
  ASSERT_TRUE(simulator.ready());
  for (std::uint64_t tick = 0; tick <= 2; ++tick) {
    const traffic::TrafficSnapshot snapshot = simulator.snapshot(tick);
    simulator.publish(snapshot);
    if (!snapshot.decision_tick) continue;
    simulator.publishSelection(snapshot);
    // As in lockstep: the next snapshot would tell the node that the session goes on without it.
    ASSERT_TRUE(simulator.until([&] {
      return simulator.images.count(tick) + simulator.ego_images.count(tick) +
                 simulator.infos.count(tick) ==
             3;
    })) << tick;
  }
  EXPECT_EQ(simulator.images.count(1), 0U);
  EXPECT_EQ(simulator.ego_images.count(1), 0U);
  const session::ScenarioOptions& options = simulator.setup().options();
  rendering::FrontCamera camera(options.camera, simulator.setup().network());
  const traffic::TrafficSnapshot snapshot = simulator.snapshot(2);
  const traffic::CameraImage here = camera.render(snapshot, snapshot.vehicles[1]);
  const node_graph::ExpectedImage expected{"cbv_0/camera/image_raw", "bg_0", 160, 96, 0.05};
  const traffic::CameraImage image = fromMsg(*simulator.images.at(2), expected);
  EXPECT_EQ(image.rgb, here.rgb);
  EXPECT_EQ(image.tick, here.tick);
  EXPECT_EQ(simulator.ego_images.at(2)->header.frame_id, "ego/camera_optical");
  EXPECT_NE(simulator.ego_images.at(2)->data, simulator.images.at(2)->data);
  EXPECT_EQ(simulator.infos.at(2)->header.frame_id, "bg_0/camera_optical");
}

TEST(Metrics, AcknowledgesEveryTickAndWritesTheResult) {
  const fs::path folder = resultFolder();
  FakeSimulator simulator(node_graph::kMetricsNode, folder);
  runObserver(simulator);
  // It ended as completed, but drove far less than the 90 % that the scenario's rules ask for.
  EXPECT_EQ(core::readFile(folder / "exit_code", "exit code"), "1\n");
  const std::string summary = core::readFile(folder / "summary.json", "summary");
  EXPECT_NE(summary.find("\"status\": \"completed\""), std::string::npos) << summary;
  EXPECT_NE(summary.find("\"outcome\": \"failed\""), std::string::npos) << summary;
  EXPECT_NE(summary.find("\"ego:test\""), std::string::npos) << summary;
  const std::string trace = core::readFile(folder / "trace.csv", "trace");
  EXPECT_EQ(std::count(trace.begin(), trace.end(), '\n'),
            1 + 4 * 2);  // header, then two vehicles at four ticks
  ASSERT_TRUE(simulator.until([&] { return simulator.reports.count(3) > 0; }));
  EXPECT_TRUE(simulator.reports.at(3)->final);
  // All measures at the first decision, then once in a simulated second, and at the end.
  EXPECT_EQ(simulator.reports.at(3)->measures.size(), metrics::measureDefinitions().size());
  EXPECT_EQ(simulator.reports.at(0)->measures.size(), metrics::measureDefinitions().size());
  EXPECT_TRUE(simulator.reports.at(2)->measures.empty());
}

TEST(Recorder, BagHoldsEveryTickInOrder) {
  const fs::path folder = resultFolder();
  FakeSimulator simulator(node_graph::kRecorderNode, folder);
  runObserver(simulator);
  EXPECT_FALSE(fs::exists(folder / "session.bag.active"));
  rosbag::Bag bag((folder / "session.bag").string(), rosbag::bagmode::Read);
  std::map<std::string, int> counts;
  std::uint64_t next_tick = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    ++counts[message.getTopic()];
    const auto snapshot = message.instantiate<node_graph::msgs::TrafficSnapshot>();
    if (!snapshot) continue;
    EXPECT_EQ(snapshot->tick, next_tick++);
  }
  // Decisions at ticks 0 and 2.
  const std::map<std::string, int> expected = {
      {"/session", 1},       {"/ego/route", 1},    {"/traffic", 4},
      {"/cbv/selection", 2}, {"/ego/control", 2},  {"/cbv_0/control", 2},
      {"/cbv_0/rollout", 2}, {"/ego/odometry", 4}, {"/tf", 2}};
  EXPECT_EQ(counts, expected);
}

}  // namespace
}  // namespace cdiff

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "traffic_simulator_node");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
