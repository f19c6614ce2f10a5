// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "boost/make_shared.hpp"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/image_inbox.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/nodes/planner_node.h"
#include "node_graph/sample_messages.h"

namespace cdiff::node_graph {
namespace {

/// Every byte value occurs, and no two rows are alike.
traffic::CameraImage sampleImage(std::uint64_t tick, int width = 160, int height = 96) {
  traffic::CameraImage image{width, height, tick, {}};
  for (int i = 0; i < 3 * width * height; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>((i * 7 + i / 480) % 256));
  return image;
}

double timeOf(std::uint64_t tick) { return static_cast<double>(tick) * 0.05; }

const ExpectedImage kExpected{"cbv_1/camera/image_raw", "bg_7", 160, 96, 0.05};

std::string errorOf(const sensor_msgs::Image& message) {
  try {
    fromMsg(message, kExpected);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

sensor_msgs::Image sampleMessage(std::uint64_t tick = 4) {
  return toMsg(sampleImage(tick), timeOf(tick), "bg_7");
}

TEST(ImageConversions, ImageComesBackByteByByte) {
  const sensor_msgs::Image message = sampleMessage();
  EXPECT_EQ(message.encoding, "rgb8");
  EXPECT_EQ(message.step, 480U);
  EXPECT_EQ(message.header.frame_id, "bg_7/camera_optical");
  EXPECT_EQ(message.header.stamp, ros::Time(0, 200000000));
  const traffic::CameraImage back = fromMsg(message, kExpected);
  EXPECT_EQ(back.width, 160);
  EXPECT_EQ(back.height, 96);
  EXPECT_EQ(back.tick, 4U);
  EXPECT_EQ(back.rgb, sampleImage(4).rgb);
}

TEST(ImageConversions, TickComesBackFromTheStampOverTwelveHours) {
  // 864000 ticks of 0.05 s; a prime stride meets every remainder of the stamps' rounding.
  for (std::uint64_t tick = 0; tick <= 864000; tick += 997) {
    sensor_msgs::Image message = toMsg({1, 1, tick, {1, 2, 3}}, timeOf(tick), "a");
    message.header.seq = 12345;  // roscpp counts here; it means nothing
    EXPECT_EQ(fromMsg(message, {"topic", "a", 1, 1, 0.05}).tick, tick);
  }
}

TEST(ImageConversions, PaddedRowsAreRead) {
  sensor_msgs::Image message = toMsg({2, 2, 0, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}, 0.0, "a");
  message.step = 8;
  message.data = {1, 2, 3, 4, 5, 6, 99, 99, 7, 8, 9, 10, 11, 12, 99, 99};
  EXPECT_EQ(fromMsg(message, {"topic", "a", 2, 2, 0.05}).rgb,
            (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
}

TEST(ImageConversions, WrongImagesAreErrorsThatNameTheTopic) {
  sensor_msgs::Image message = sampleMessage();
  message.encoding = "bgr8";
  EXPECT_EQ(errorOf(message),
            "image on cbv_1/camera/image_raw has encoding 'bgr8'; expected 'rgb8'");
  message = toMsg(sampleImage(4, 80, 96), timeOf(4), "bg_7");
  EXPECT_EQ(errorOf(message),
            "image on cbv_1/camera/image_raw is 80 x 96 pixels; expected 160 x 96");
  message = sampleMessage();
  message.data.pop_back();
  EXPECT_EQ(errorOf(message),
            "image on cbv_1/camera/image_raw has 46079 bytes in rows of 480 for 160 x 96 pixels");
  message = sampleMessage();
  message.header.frame_id = "bg_8/camera_optical";
  EXPECT_EQ(errorOf(message),
            "image on cbv_1/camera/image_raw has frame 'bg_8/camera_optical'; expected "
            "'bg_7/camera_optical'");
  message = sampleMessage();
  message.header.stamp += ros::Duration(0, 1);  // a nanosecond off
  EXPECT_EQ(errorOf(message),
            "image on cbv_1/camera/image_raw has stamp 0.200000001, which is no tick of 0.05 s");
}

TEST(ImageConversions, CameraInfoIsThePinhole) {
  std_msgs::Header header;
  header.frame_id = "bg_7/camera_optical";
  const sensor_msgs::CameraInfo info = toCameraInfoMsg(rendering::frontCamera({}), header);
  // 160 x 96, 90 degrees: f = 80 / tan 45 degrees, center (159 / 2, 95 / 2).
  const double f = 80.0 / std::tan(std::atan(1.0));
  EXPECT_NEAR(info.K[0], f, 1e-12);
  EXPECT_EQ(info.K[4], info.K[0]);
  EXPECT_EQ(info.K[2], 79.5);
  EXPECT_EQ(info.K[5], 47.5);
  EXPECT_EQ(info.K[8], 1.0);
  EXPECT_EQ(info.P[0], info.K[0]);
  EXPECT_EQ(info.P[2], 79.5);
  EXPECT_EQ(info.P[5], info.K[0]);
  EXPECT_EQ(info.P[6], 47.5);
  EXPECT_EQ(info.P[3], 0.0);
  EXPECT_EQ(info.P[7], 0.0);
  EXPECT_EQ(info.P[10], 1.0);
  EXPECT_EQ(info.R[0] + info.R[4] + info.R[8], 3.0);
  EXPECT_EQ(info.D, std::vector<double>(5, 0.0));
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.width, 160U);
  EXPECT_EQ(info.height, 96U);
  EXPECT_EQ(info.header.frame_id, "bg_7/camera_optical");
}

/// Answers the first byte of each image as throttle, in 1/256.
class SeeingPlanner : public planning::Planner {
 public:
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot&, const std::vector<planning::PlanningTask>& tasks) override {
    ++calls;
    std::vector<planning::PlannedAction> actions;
    for (const planning::PlanningTask& task : tasks) {
      const double throttle = task.views.find("front")->rgb.at(0) / 256.0;
      actions.push_back({task.slot, task.vehicle->id, {throttle, 0.0, 0.0}, {}});
    }
    return actions;
  }
  int calls = 0;
};

sensor_msgs::Image::ConstPtr plainImage(std::uint64_t tick, const std::string& vehicle_id,
                                        std::uint8_t value) {
  return boost::make_shared<const sensor_msgs::Image>(toMsg(
      {160, 96, tick, std::vector<std::uint8_t>(3 * 160 * 96, value)}, timeOf(tick), vehicle_id));
}

/// CBVs "bg_7" in slot 1 and "bg_9" in slot 3.
class PlanSeeing : public ::testing::Test {
 protected:
  PlannerDecision decide() { return planSeeing(planner, snapshot, tasks, inbox); }

  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  std::vector<planning::PlanningTask> tasks = {{1, &snapshot.vehicles[1], nullptr},
                                               {3, &snapshot.vehicles[2], nullptr}};
  ImageInbox inbox{session::VehicleRigs(), 0.05};
  SeeingPlanner planner;
};

TEST_F(PlanSeeing, EachTaskHasTheImageOfItsSlotAndTick) {
  inbox.add(3, plainImage(2, "bg_9", 64));  // of an earlier tick
  inbox.add(3, plainImage(4, "bg_9", 32));
  inbox.add(1, plainImage(4, "bg_7", 128));
  const PlannerDecision decision = decide();
  ASSERT_EQ(decision.actions.size(), 2U);
  EXPECT_EQ(decision.actions[0].action.throttle, 0.5);
  EXPECT_EQ(decision.actions[1].action.throttle, 0.125);
  EXPECT_EQ(decision.actions[1].vehicle_id, "bg_9");
  EXPECT_EQ(decision.image_age, 0.0);
  EXPECT_EQ(decision.missing + decision.refused, 0);
}

TEST_F(PlanSeeing, VehicleWithoutImageBrakesAndTheOtherDrivesOn) {
  inbox.add(3, plainImage(4, "bg_9", 32));
  inbox.add(1, plainImage(2, "bg_7", 128));
  const PlannerDecision decision = decide();
  ASSERT_EQ(decision.actions.size(), 2U);
  EXPECT_EQ(decision.actions[0].vehicle_id, "bg_7");
  EXPECT_EQ(decision.actions[0].action, traffic::ControlAction::failSafe());
  EXPECT_EQ(decision.actions[0].fault, "no image on cbv_1/camera/image_raw for tick 4");
  EXPECT_EQ(decision.actions[1].action.throttle, 0.125);
  EXPECT_EQ(decision.actions[1].fault, "");
  EXPECT_EQ(decision.missing, 1);
  EXPECT_EQ(toMsg(decision.actions[0], snapshot, {"cbv:test", 1.0, {}}).fault,
            decision.actions[0].fault);
}

TEST_F(PlanSeeing, RefusedImagesNameWhatIsWrongAndThePlannerIsNotAsked) {
  auto wrong = boost::make_shared<sensor_msgs::Image>(*plainImage(4, "bg_7", 1));
  wrong->encoding = "mono8";
  inbox.add(1, wrong);
  inbox.add(3, plainImage(4, "bg_8", 1));  // of a vehicle that had the slot before
  const PlannerDecision decision = decide();
  EXPECT_NE(decision.actions[0].fault.find("mono8"), std::string::npos);
  EXPECT_NE(decision.actions[1].fault.find("bg_8"), std::string::npos);
  EXPECT_EQ(decision.refused, 2);
  EXPECT_EQ(planner.calls, 0);
}

TEST_F(PlanSeeing, StatisticsCountFaultsByKindAndMissedDeadlines) {
  PlannerStatistics statistics(0.1);
  inbox.add(3, plainImage(4, "bg_9", 32));
  PlannerDecision decision = decide();
  decision.latency_ms = 100.5;
  statistics.observe(decision);
  decision.latency_ms = 99.5;
  decision.fault = "threw";
  statistics.observe(decision);
  EXPECT_EQ(statistics.deadlineMisses(), 1U);
  EXPECT_EQ(statistics.faults(),
            (std::map<std::string, std::uint64_t>{{"image missing", 2}, {"planning call", 1}}));
  diagnostic_updater::DiagnosticStatusWrapper status;
  statistics.diagnose(status);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_EQ(status.message, "3 fail-safe actions");
}

TEST_F(PlanSeeing, AMissingFrameOfARigNamesCameraAndTopic) {
  session::ScenarioOptions options;
  options.cbv_rig.preset = rendering::kFrontThreeRig;
  inbox = ImageInbox(session::VehicleRigs(options), 0.05);
  const auto imageFrom = [](const std::string& camera, const std::string& vehicle) {
    return boost::make_shared<const sensor_msgs::Image>(toMsg(
        {160, 96, 4, std::vector<std::uint8_t>(3 * 160 * 96, 64)}, timeOf(4), vehicle, camera));
  };
  for (const std::string camera : {"front", "front_left", "front_right"})
    inbox.add(3, imageFrom(camera, "bg_9"), camera);
  inbox.add(1, imageFrom("front", "bg_7"), "front");
  inbox.add(1, imageFrom("front_right", "bg_7"), "front_right");
  EXPECT_TRUE(inbox.complete(3, 4));
  EXPECT_FALSE(inbox.complete(1, 4));
  const PlannerDecision decision = decide();
  EXPECT_EQ(decision.actions[0].action, traffic::ControlAction::failSafe());
  EXPECT_EQ(decision.actions[0].fault,
            "no image of camera 'front_left' on cbv_1/camera_front_left/image_raw for tick 4");
  EXPECT_EQ(decision.actions[1].action.throttle, 0.25);
  EXPECT_EQ(decision.missing, 1);
  inbox.add(1, imageFrom("front", "bg_7"), "front_left");  // the frame of another camera
  EXPECT_EQ(decide().actions[0].fault,
            "image on cbv_1/camera_front_left/image_raw has frame 'bg_7/camera_optical'; expected "
            "'bg_7/camera_front_left_optical'");
}

TEST(ImageInbox, ForgetsOlderTicksOnly) {
  ImageInbox inbox(session::VehicleRigs(), 0.05);
  inbox.add(0, plainImage(2, "a", 1));
  inbox.add(0, plainImage(4, "a", 2));
  inbox.forgetBefore(4);
  EXPECT_EQ(inbox.find(0, 2), nullptr);
  EXPECT_NE(inbox.find(0, 4), nullptr);
  EXPECT_EQ(inbox.find(1, 4), nullptr);
}

TEST(GuidanceConversions, ReportComesBackBitByBit) {
  planning::PlannedAction action;
  action.slot = 1;
  action.vehicle_id = "bg_7";
  action.fault = "why";
  action.state_mismatch = 1.0 / 3.0;
  action.guidance = {{{"speed", 0.1, 0.2, 1.0 / 7.0, 0.3, 4}}, 8, 5, 0.7, {}};
  const msgs::GuidanceReport message = toGuidanceMsg({action}, test::sampleSnapshot(4));
  EXPECT_EQ(message.tick, 4U);
  ASSERT_EQ(message.vehicles.size(), 1U);
  EXPECT_EQ(message.vehicles[0].slot, 1);
  EXPECT_EQ(message.vehicles[0].vehicle_id, "bg_7");
  EXPECT_EQ(message.vehicles[0].fault, "why");
  EXPECT_EQ(message.vehicles[0].state_mismatch, 1.0 / 3.0);
  const guidance::GuidanceReport back = fromMsg(message.vehicles[0]);
  ASSERT_EQ(back.objectives.size(), 1U);
  EXPECT_EQ(back.objectives[0].name, "speed");
  EXPECT_EQ(back.objectives[0].weight, 0.1);
  EXPECT_EQ(back.objectives[0].value, 0.2);
  EXPECT_EQ(back.objectives[0].gradient_norm, 1.0 / 7.0);
  EXPECT_EQ(back.objectives[0].capped_share, 0.3);
  EXPECT_EQ(back.objectives[0].dropped, 4);
  EXPECT_EQ(back.candidates, 8);
  EXPECT_EQ(back.chosen, 5);
  EXPECT_EQ(back.trust_region_share, 0.7);
}

}  // namespace
}  // namespace cdiff::node_graph
