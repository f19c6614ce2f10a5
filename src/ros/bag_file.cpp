// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/bag_file.h"

#include <algorithm>
#include <cerrno>

#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/conversions.h"
#include "ros/display.h"
#include "ros/image_conversions.h"
#include "ros/topics.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

/// A bag takes no stamp of zero.
::ros::Time bagStamp(const ::ros::Time& stamp) { return std::max(stamp, ::ros::TIME_MIN); }

std::string controlTopic(int slot) {
  return slot == kEgoSlot ? kEgoControlTopic : cbvControlTopic(slot);
}

}  // namespace

BagFile::BagFile(const fs::path& file, const rendering::CameraOptions& camera, Naming naming)
    : file_(file),
      camera_(camera),
      naming_(std::move(naming)),
      bag_(std::make_unique<rosbag::Bag>()) {
  guard([&] {
    if (file_.has_parent_path()) fs::create_directories(file_.parent_path());
    bag_->open(file_.string() + ".active", rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
  });
}

BagFile::~BagFile() {
  try {
    bag_->close();
  } catch (const std::exception&) {
    // On a full disk. Its destructor would try once more and end the program, so it gets none.
    static_cast<void>(bag_.release());
  }
  std::error_code ignored;
  if (failed_) fs::remove(file_.string() + ".active", ignored);
}

void BagFile::discard() { failed_ = true; }

/// Errors of the bag name its file.
void BagFile::guard(const std::function<void()>& writing) {
  errno = 0;
  try {
    writing();
  } catch (const std::exception& error) {
    const std::string reason = errno == 0 ? "" : " (" + core::writeErrorText(errno) + ")";
    failed_ = true;
    throw core::InputError("cannot write the bag '" + file_.string() + "': " + error.what() +
                           reason + "; check that the folder exists, is writable and has room");
  }
}

void BagFile::write(const msgs::SessionInfo& info) {
  guard([&] { bag_->write(naming_(kSessionTopic), ::ros::TIME_MIN, info); });
}

void BagFile::write(const nav_msgs::Path& ego_route) {
  guard([&] { bag_->write(naming_(kEgoRouteTopic), ::ros::TIME_MIN, ego_route); });
}

void BagFile::write(const TickMessages& tick) {
  guard([&] { writeTick(tick); });
}

void BagFile::writeTick(const TickMessages& tick) {
  const ::ros::Time stamp = bagStamp(tick.snapshot->header.stamp);
  put(kTrafficTopic, stamp, tick.snapshot);
  put(kDecisionRecordTopic, stamp, tick.decision);  // before what it speaks of
  put(kSelectionTopic, stamp, tick.selection);
  for (const auto& [slot, control] : tick.controls) put(controlTopic(slot), stamp, control);
  for (const auto& [slot, rollout] : tick.rollouts) put(cbvRolloutTopic(slot), stamp, rollout);
  put(kGuidanceTopic, stamp, tick.guidance);
  for (const auto& [slot, image] : tick.images) {
    put(imageTopic(slot), stamp, image);
    bag_->write(naming_(cameraInfoTopic(slot)), stamp, toCameraInfoMsg(camera_, image->header));
  }
  put(kMetricsTopic, stamp, tick.report);
  if (tick.snapshot->decision_tick) writeDisplay(tick, stamp);
}

void BagFile::writeDisplay(const TickMessages& tick, const ::ros::Time& stamp) {
  const traffic::TrafficSnapshot snapshot = fromMsg(*tick.snapshot);
  bag_->write("/tf", stamp, toTfMsg(snapshot, tick.images.empty() ? nullptr : &camera_));
  if (const traffic::Vehicle* ego = snapshot.ego())
    bag_->write(naming_(kEgoOdometryTopic), stamp, toOdometryMsg(*ego, snapshot.time));
}

void BagFile::finish() {
  guard([&] {
    bag_->close();
    fs::rename(file_.string() + ".active", file_);
  });
}

}  // namespace cdiff::ros
