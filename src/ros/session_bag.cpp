// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/session_bag.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/ros/display.h"
#include "e2e_cdiff/ros/topics.h"
#include "sensor_msgs/Image.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

/// A bag takes no stamp of zero.
::ros::Time bagStamp(const ::ros::Time& stamp) { return std::max(stamp, ::ros::TIME_MIN); }

std::string bagTopic(const std::string& topic) { return "/" + topic; }

sensor_msgs::Image toImageMsg(const traffic::CameraImage& image, double time, int slot) {
  sensor_msgs::Image message;
  message.header.stamp = toStamp(time);
  message.header.seq = static_cast<std::uint32_t>(image.tick);
  message.header.frame_id =
      (slot < 0 ? std::string("ego") : "cbv_" + std::to_string(slot)) + "/camera_optical";
  message.height = static_cast<std::uint32_t>(image.height);
  message.width = static_cast<std::uint32_t>(image.width);
  message.encoding = "rgb8";
  message.step = 3 * message.width;
  message.data = image.rgb;
  return message;
}

}  // namespace

std::string cameraImageTopic(int slot) {
  return (slot < 0 ? std::string("ego") : "cbv_" + std::to_string(slot)) + "/camera/image_raw";
}

SessionBag::SessionBag(const scenario::SessionSetup& setup, const fs::path& file,
                       const BagOrigin& origin)
    : setup_(setup), file_(file) {
  write([&] { open(origin); });
}

SessionBag::~SessionBag() = default;

/// Errors of the bag name its file.
void SessionBag::write(const std::function<void()>& writing) {
  try {
    writing();
  } catch (const std::exception& error) {
    throw core::InputError("cannot write the bag '" + file_.string() + "': " + error.what());
  }
}

void SessionBag::open(const BagOrigin& origin) {
  if (file_.has_parent_path()) fs::create_directories(file_.parent_path());
  bag_.open(file_.string() + ".active", rosbag::bagmode::Write);
  bag_.setCompression(rosbag::compression::LZ4);
  msgs::SessionInfo info = toMsg(setup_);
  info.deployment = origin.deployment;
  info.simulator_version = origin.simulator_version;
  info.package_version = E2E_CDIFF_VERSION;
  info.results_folder = fs::absolute(file_).parent_path().string();
  bag_.write(bagTopic(kSessionTopic), ::ros::TIME_MIN, info);
  bag_.write(bagTopic(kEgoRouteTopic), ::ros::TIME_MIN, toPathMsg(setup_.egoRoute()));
}

void SessionBag::observe(const scenario::TickRecord& record) {
  write([&] {
    const traffic::TrafficSnapshot& snapshot = *record.snapshot;
    const ::ros::Time stamp = bagStamp(toStamp(snapshot.time));
    bag_.write(bagTopic(kTrafficTopic), stamp, toMsg(snapshot));
    if (record.selection != nullptr) {
      bag_.write(bagTopic(kSelectionTopic), stamp,
                 toMsg(*record.selection, snapshot.time, setup_.network()));
    }
    if (record.actions != nullptr) {
      for (const planning::PlannedAction& action : *record.actions) writeAction(action, record);
    }
    if (record.images != nullptr) {
      for (const scenario::SlotImage& seen : *record.images) writeImage(seen);
    }
    if (!snapshot.decision_tick) return;
    bag_.write("/tf", stamp, toTfMsg(snapshot));
    if (const traffic::Vehicle* ego = snapshot.ego())
      bag_.write(bagTopic(kEgoOdometryTopic), stamp, toOdometryMsg(*ego, snapshot.time));
  });
}

void SessionBag::writeAction(const planning::PlannedAction& action,
                             const scenario::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  const ::ros::Time stamp = bagStamp(toStamp(snapshot.time));
  const bool ego = action.slot < 0;
  const scenario::ScenarioOptions& options = setup_.options();
  ActionOrigin origin;
  origin.planner = ego ? "ego:" + options.ego_planner : "cbv:" + options.cbv_planner;
  for (const scenario::PlannerLatency& latency : record.latencies) {
    if (latency.planner == origin.planner) origin.latency_ms = latency.milliseconds;
  }
  if (noisy_ && noisy_(action.vehicle_id)) origin.planner += kNoiseMark;
  origin.fault = action.fault;
  const std::string topic = ego ? kEgoControlTopic : cbvControlTopic(action.slot);
  bag_.write(bagTopic(topic), stamp, toMsg(action, snapshot, origin));
  if (!ego)
    bag_.write(bagTopic(cbvRolloutTopic(action.slot)), stamp, toRolloutMsg(action, snapshot));
}

void SessionBag::writeImage(const scenario::SlotImage& seen) {
  const double time = static_cast<double>(seen.image.tick) * setup_.options().simulation_step;
  bag_.write(bagTopic(cameraImageTopic(seen.slot)), bagStamp(toStamp(time)),
             toImageMsg(seen.image, time, seen.slot));
}

void SessionBag::finish() {
  write([&] {
    bag_.close();
    fs::rename(file_.string() + ".active", file_);
  });
}

}  // namespace cdiff::ros
