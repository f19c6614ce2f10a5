// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/recorder_ros.h"

#include <algorithm>

#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/ros/display.h"
#include "e2e_cdiff/ros/image_conversions.h"
#include "e2e_cdiff/ros/session_parts.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

constexpr double kReportPatience =
    2.0;  // [s] of wall time for the last report, which a dead metrics node never sends

/// A bag takes no stamp of zero.
::ros::Time bagStamp(const ::ros::Time& stamp) { return std::max(stamp, ::ros::TIME_MIN); }

std::string bagTopic(const std::string& topic) { return ::ros::names::resolve(topic); }

}  // namespace

void RecorderRos::begin(const msgs::SessionInfo& info) {
  file_ = fs::path(info.results_folder) / "session.bag";
  fs::create_directories(file_.parent_path());
  bag_.open(file_.string() + ".active", rosbag::bagmode::Write);
  bag_.setCompression(rosbag::compression::LZ4);
  bag_.write(bagTopic(kSessionTopic), ::ros::TIME_MIN, info);
  const scenario::ScenarioOptions options = optionsFromMsg(info);
  answers_ = TickAnswers(options.simulation_step);
  camera_ = options.camera;
  images_ = ImageInbox(camera_, options.simulation_step);
  listenToAll();
}

void RecorderRos::listenToAll() {
  listen<nav_msgs::Path>(kEgoRouteTopic, [this](const nav_msgs::Path::ConstPtr& path) {
    if (!route_) bag_.write(bagTopic(kEgoRouteTopic), ::ros::TIME_MIN, path);
    route_ = path;
  });
  listen<msgs::CbvSelection>(kSelectionTopic,
                             [this](const auto& message) { answers_.add(message); });
  listen<msgs::ControlAction>(kEgoControlTopic,
                              [this](const auto& message) { answers_.addEgo(message); });
  for (int slot = 0; slot < graph().max_cbv; ++slot) listenToSlot(slot);
  if (graph().imagesOfEgo()) listenToImages(kEgoSlot);
  if (graph().cbvsSee()) {
    answers_.expectGuidance();
    listen<msgs::GuidanceReport>(kGuidanceTopic,
                                 [this](const auto& message) { answers_.add(message); });
  }
  if (!graph().has(kMetricsNode)) return;
  listen<msgs::MetricReport>(kMetricsTopic,
                             [this](const auto& message) { reports_[message->tick] = message; });
}

void RecorderRos::listenToSlot(int slot) {
  listen<msgs::ControlAction>(
      cbvControlTopic(slot), [this, slot](const auto& message) { answers_.addCbv(slot, message); });
  listen<msgs::Rollout>(cbvRolloutTopic(slot), [this, slot](const auto& message) {
    rollouts_[message->tick][slot] = message;
  });
  if (graph().imagesOfCbvs()) listenToImages(slot);
}

void RecorderRos::listenToImages(int slot) {
  listen<sensor_msgs::Image>(imageTopic(slot),
                             [this, slot](const auto& message) { images_.add(slot, message); });
}

std::string RecorderRos::waitingFor() const { return route_ ? "" : "no ego route has come yet"; }

/// Whether everything that belongs to a tick is here.
bool RecorderRos::complete(const msgs::TrafficSnapshot& snapshot) {
  if (!answers_.missing(snapshot).empty() || !seen(snapshot)) return false;
  for (const Answer& answer : answers_.answers(snapshot)) {
    const auto at_tick = rollouts_.find(snapshot.tick);
    if (answer.action.slot < 0) continue;
    if (at_tick == rollouts_.end() || at_tick->second.count(answer.action.slot) == 0) return false;
  }
  const bool final = snapshot.status != msgs::TrafficSnapshot::RUNNING;
  if (!graph().has(kMetricsNode) || (!snapshot.decision_tick && !final) ||
      reports_.count(snapshot.tick) > 0)
    return true;
  if (waiting_since_.isZero()) waiting_since_ = ::ros::WallTime::now();
  return final && (::ros::WallTime::now() - waiting_since_).toSec() > kReportPatience;
}

/// Whether the images of all that are rendered at this tick are here.
bool RecorderRos::seen(const msgs::TrafficSnapshot& snapshot) const {
  if (!snapshot.decision_tick) return true;
  for (const Answer& answer : answers_.answers(snapshot)) {
    const int slot = answer.action.slot;
    const bool rendered = slot == kEgoSlot ? graph().imagesOfEgo() : graph().imagesOfCbvs();
    if (rendered && !images_.find(slot, snapshot.tick)) return false;
  }
  return true;
}

bool RecorderRos::handle(const Snapshot& snapshot, bool superseded) {
  if (!superseded && !complete(*snapshot)) return false;
  write(snapshot);
  acknowledge(snapshot->tick);
  forgetUntil(snapshot->tick);
  waiting_since_ = {};
  return true;
}

void RecorderRos::write(const Snapshot& snapshot) {
  const ::ros::Time stamp = bagStamp(snapshot->header.stamp);
  bag_.write(bagTopic(kTrafficTopic), stamp, snapshot);
  if (const auto selection = answers_.selection(snapshot->tick))
    bag_.write(bagTopic(kSelectionTopic), stamp, selection);
  if (const auto control = answers_.ego(snapshot->tick))
    bag_.write(bagTopic(kEgoControlTopic), stamp, control);
  for (int slot = 0; slot < graph().max_cbv; ++slot) {
    if (const auto control = answers_.cbv(slot, snapshot->tick))
      bag_.write(bagTopic(cbvControlTopic(slot)), stamp, control);
  }
  for (const auto& [slot, rollout] : rollouts_[snapshot->tick])
    bag_.write(bagTopic(cbvRolloutTopic(slot)), stamp, rollout);
  if (const auto guidance = answers_.guidance(snapshot->tick))
    bag_.write(bagTopic(kGuidanceTopic), stamp, guidance);
  writeImages(snapshot->tick, stamp);
  const auto report = reports_.find(snapshot->tick);
  if (report != reports_.end()) bag_.write(bagTopic(kMetricsTopic), stamp, report->second);
  if (snapshot->decision_tick) writeDisplay(*snapshot, stamp);
}

/// With the intrinsics that camera_node publishes beside them.
void RecorderRos::writeImages(std::uint64_t tick, const ::ros::Time& stamp) {
  for (int slot = kEgoSlot; slot < graph().max_cbv; ++slot) {
    const auto image = images_.find(slot, tick);
    if (!image) continue;
    bag_.write(bagTopic(imageTopic(slot)), stamp, image);
    bag_.write(bagTopic(cameraInfoTopic(slot)), stamp, toCameraInfoMsg(camera_, image->header));
  }
}

/// For rviz beside `rosbag play`.
void RecorderRos::writeDisplay(const msgs::TrafficSnapshot& message, const ::ros::Time& stamp) {
  const traffic::TrafficSnapshot snapshot = fromMsg(message);
  bag_.write("/tf", stamp,
             graph().has(kCameraNode) ? toTfMsg(snapshot, camera_) : toTfMsg(snapshot));
  if (const traffic::Vehicle* ego = snapshot.ego()) {
    bag_.write(bagTopic(kEgoOdometryTopic), stamp, toOdometryMsg(*ego, snapshot.time));
  }
}

void RecorderRos::forgetUntil(std::uint64_t tick) {
  answers_.forgetBefore(tick);
  images_.forgetBefore(tick + 1);
  rollouts_.erase(rollouts_.begin(), rollouts_.upper_bound(tick));
  reports_.erase(reports_.begin(), reports_.upper_bound(tick));
}

int RecorderRos::conclude(Ending ending) {
  bag_.close();
  fs::rename(file_.string() + ".active", file_);
  return ending == Ending::kSimulatorGone ? 2 : 0;
}

}  // namespace cdiff::ros
