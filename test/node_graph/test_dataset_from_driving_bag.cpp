// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/core/exceptions.h"
#include "nav_msgs/Odometry.h"
#include "nav_msgs/Path.h"
#include "node_graph/bags/dataset_from_bag.h"
#include "rosbag/bag.h"
#include "sensor_msgs/Image.h"
#include "std_msgs/String.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

constexpr double kStart = 100.0;  // [s] first stamp

traffic::ControlAction actionAt(int tick) {
  if (tick < 60) return {0.6, 0.1, 0.0};
  return tick < 120 ? traffic::ControlAction{0.35, -0.15, 0.0}
                    : traffic::ControlAction{0.0, 0.0, 0.5};
}

/// A drive of 10 s with images of 320 x 240 in bgr8 at 10 Hz and odometry at 20 Hz, but for the
/// time from `gap_begin` on for `gap` [s].
void writeDrive(const std::filesystem::path& file, double gap_begin = 1e9,
                const std::string& encoding = "bgr8", double gap = 1.0) {
  rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
  const dynamics::BicycleModel model;
  traffic::VehicleState state;
  state.position = {50.0, -20.0};
  state.heading = 3.0;
  state.speed = 3.0;
  for (int tick = 0; tick < 200; ++tick) {
    const double time = 0.05 * tick;
    const ros::Time stamp(kStart + time);
    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = "odom";
    odometry.pose.pose.position.x = state.position.x();
    odometry.pose.pose.position.y = state.position.y();
    odometry.pose.pose.orientation.z = std::sin(0.5 * state.heading);
    odometry.pose.pose.orientation.w = std::cos(0.5 * state.heading);
    odometry.twist.twist.linear.x = state.speed;
    if (time < gap_begin || time > gap_begin + gap) bag.write("/my/odom", stamp, odometry);
    ::e2e_cdiff::ControlAction control;
    control.header.stamp = stamp;
    control.throttle = actionAt(tick).throttle;
    control.steer = actionAt(tick).steer;
    control.brake = actionAt(tick).brake;
    bag.write("/my/control", stamp, control);
    if (tick % 2 == 0) {
      sensor_msgs::Image image;
      image.header.stamp = stamp;
      image.encoding = encoding;
      image.width = 320;
      image.height = 240;
      image.step = 3 * image.width;
      image.data.assign(std::size_t{image.step} * image.height, 10);
      for (std::size_t i = 0; i < image.data.size(); i += 3) image.data[i] = 200;  // blue
      bag.write("/my/camera", stamp, image);
    }
    state = model.step(state, actionAt(tick), 0.05);
  }
  bag.write("/my/words", ros::Time(kStart), std_msgs::String());
}

class DrivingBagTest : public testing::Test {
 protected:
  DrivingBagTest() {
    topics_.image = "/my/camera";
    topics_.odometry = "/my/odom";
  }

  std::vector<learning::DrivingSample> samples() {
    statistics_ = {};
    return samplesFromDrivingBag(file_, topics_, {}, statistics_);
  }

  std::string error() {
    try {
      samples();
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "none";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "drive.bag";
  collection::DriveOptions topics_;
  collection::DatasetStatistics statistics_;
};

TEST_F(DrivingBagTest, SamplesAreTheDriveInTheVehiclesFrame) {
  writeDrive(file_);
  const auto all = samples();
  // An image every half second that has 3.2 s before the last odometry at 9.95 s.
  ASSERT_EQ(all.size(), 14U);
  EXPECT_EQ(statistics_.samples, 14U);
  for (const learning::DrivingSample& sample : all) {
    collection::schemaOf({}).check(sample);
    // With a step a row and the heading turning: never behind where it was.
    EXPECT_NEAR(sample.rollout(0, traffic::kRolloutX), 0.1 * sample.speed, 0.1);
    EXPECT_NEAR(sample.rollout(0, traffic::kRolloutY), 0.0, 0.1);
    EXPECT_LT(std::abs(sample.rollout(31, traffic::kRolloutHeading)), 3.0);
  }
  EXPECT_EQ(all.front().image.width, 160);
  EXPECT_EQ(all.front().image.height, 96);
  const std::vector<std::uint8_t> first(all.front().image.rgb.begin(),
                                        all.front().image.rgb.begin() + 3);
  EXPECT_EQ(first, (std::vector<std::uint8_t>{10, 10, 200}));  // rgb
}

TEST_F(DrivingBagTest, InferredActionsMakeTheMotionThatWasObserved) {
  writeDrive(file_);
  const dynamics::ActionRollout dynamics;
  const auto all = samples();
  ASSERT_FALSE(all.empty());
  for (const learning::DrivingSample& sample : all) {
    traffic::Rollout again = sample.rollout;
    dynamics.rollOut(sample.speed, again);
    const double off = (again.leftCols(2) - sample.rollout.leftCols(2)).rowwise().norm().maxCoeff();
    EXPECT_LT(off, 0.3) << "at tick " << sample.tick;
  }
}

TEST_F(DrivingBagTest, ControlsAreTakenAsRecordedWhereTheyAreNamed) {
  writeDrive(file_);
  topics_.control = "/my/control";
  const auto all = samples();
  ASSERT_FALSE(all.empty());
  for (const learning::DrivingSample& sample : all) {
    const traffic::ControlAction action = actionAt(static_cast<int>(sample.tick));
    EXPECT_DOUBLE_EQ(sample.rollout(0, traffic::kRolloutThrottle), action.throttle);
    EXPECT_DOUBLE_EQ(sample.rollout(0, traffic::kRolloutSteer), action.steer);
    EXPECT_DOUBLE_EQ(sample.rollout(0, traffic::kRolloutBrake), action.brake);
  }
}

TEST_F(DrivingBagTest, NoSampleReachesOverAGap) {
  writeDrive(file_, 5.0);
  const auto all = samples();
  EXPECT_GT(statistics_.dropped["gap"], 10U);
  ASSERT_FALSE(all.empty());
  for (const learning::DrivingSample& sample : all) {
    const double begin = 0.05 * static_cast<double>(sample.tick);
    EXPECT_TRUE(begin + 3.2 < 5.0 || begin > 6.0) << begin;
  }
}

TEST_F(DrivingBagTest, WhatIsMissingOrOfAnotherTypeIsNamed) {
  writeDrive(file_);
  topics_.image = "/other/camera";
  EXPECT_NE(error().find("drive.bag"), std::string::npos);
  EXPECT_NE(error().find("'/other/camera'"), std::string::npos);
  EXPECT_NE(error().find("/my/camera (sensor_msgs/Image)"), std::string::npos);
  topics_.image = "/my/words";
  EXPECT_NE(error().find("std_msgs/String"), std::string::npos);
  topics_.image = "";
  EXPECT_NE(error().find("image is not given"), std::string::npos);
}

TEST_F(DrivingBagTest, ImagesWithoutColorAndBagsWithoutAHorizonAreRefused) {
  writeDrive(file_, 1e9, "32FC1");
  EXPECT_NE(error().find("cannot be used"), std::string::npos);
  writeDrive(file_, 3.0, "bgr8", 10.0);
  EXPECT_NE(error().find("gives no sample"), std::string::npos);
}

/// Odometry of 5 s at 10 Hz along x, with `speed` and that orientation; from `reverse_at` on back.
void writeOdometry(rosbag::Bag& bag, double speed, double w, double reverse_at = 1e9) {
  double x = 0.0;
  for (int tick = 0; tick < 50; ++tick, x += 0.1 * speed) {
    if (0.1 * tick > reverse_at) speed = -std::abs(speed);
    const ros::Time stamp(kStart + 0.1 * tick);
    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = "odom";
    odometry.pose.pose.position.x = x;
    odometry.pose.pose.orientation.w = w;
    odometry.twist.twist.linear.x = speed;
    bag.write("/my/odom", stamp, odometry);
    sensor_msgs::Image image;
    image.header.stamp = stamp;
    image.encoding = "rgb8";
    image.width = 32;
    image.height = 24;
    image.step = 3 * image.width;
    image.data.assign(std::size_t{image.step} * image.height, 10);
    bag.write("/my/camera", stamp, image);
  }
}

TEST_F(DrivingBagTest, DrivingBackwardsGivesNoSampleButNoiseAtStandstillDoes) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, -1.0, 1.0);
  bag.close();
  EXPECT_NE(error().find("driving forwards"), std::string::npos);
  EXPECT_GT(statistics_.dropped["reversing"], 10U);
  bag.open(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, -0.02, 1.0);
  bag.close();
  for (const learning::DrivingSample& sample : samples()) {
    EXPECT_EQ(sample.speed, 0.0);
    EXPECT_EQ(sample.rollout.col(traffic::kRolloutSpeed).minCoeff(), 0.0);
  }
  EXPECT_EQ(statistics_.dropped["reversing"], 0U);
}

TEST_F(DrivingBagTest, TheDrivenPathGoesStraightOnWhereTheVehicleReverses) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, 5.0, 1.0, 3.5);
  bag.close();
  const auto all = samples();
  ASSERT_FALSE(all.empty());
  for (const learning::DrivingSample& sample : all) {
    for (std::size_t i = 0; i < sample.route.size() / 2; ++i)
      EXPECT_NEAR(sample.route[2 * i], 3.0 * static_cast<double>(i + 1) / 20.0, 1e-5);
  }
}

TEST_F(DrivingBagTest, AnOrientationOfAnyLengthButZeroIsOne) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, 2.0, 0.5);
  bag.close();
  EXPECT_FALSE(samples().empty());
  bag.open(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, 2.0, 0.0);
  bag.close();
  EXPECT_NE(error().find("no orientation"), std::string::npos);
}

nav_msgs::Path pathAlongX(const std::string& frame) {
  nav_msgs::Path path;
  path.header.stamp = ros::Time(kStart);
  path.header.frame_id = frame;
  path.poses.resize(30);
  for (std::size_t i = 0; i < path.poses.size(); ++i)
    path.poses[i].pose.position.x = 3.0 * static_cast<double>(i);
  return path;
}

TEST_F(DrivingBagTest, APathInTheSameFrameIsTheRoute) {
  topics_.path = "/my/path";
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  bag.write(topics_.path, ros::Time(kStart), pathAlongX("/odom"));
  bag.write(topics_.path, ros::Time(kStart), nav_msgs::Path());  // clears a display
  writeOdometry(bag, 2.0, 1.0);
  bag.close();
  const auto all = samples();
  ASSERT_FALSE(all.empty());
  EXPECT_NEAR(all.front().route[0], 3.0 / 20.0, 1e-6);
  EXPECT_NEAR(all.front().route[1], 0.0, 1e-6);
}

TEST_F(DrivingBagTest, APathInAnotherFrameIsRefused) {
  topics_.path = "/my/path";
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  bag.write(topics_.path, ros::Time(kStart), pathAlongX("map"));
  writeOdometry(bag, 2.0, 1.0);
  bag.close();
  EXPECT_NE(error().find("'/my/odom' is in the frame 'odom', '/my/path' in 'map'"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::node_graph
