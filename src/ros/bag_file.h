// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The file session.bag, whoever writes it: the topics of a session in a fixed order, tick by tick,
/// with simulated stamps. While it is written, the file is called FILE.active.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "nav_msgs/Path.h"
#include "rosbag/bag.h"
#include "sensor_msgs/Image.h"

namespace cdiff::ros {

/// Everything that belongs to a tick; only the snapshot must be there.
struct TickMessages {
  ::e2e_cdiff::TrafficSnapshot::ConstPtr snapshot;
  ::e2e_cdiff::DecisionRecord::ConstPtr decision;
  ::e2e_cdiff::CbvSelection::ConstPtr selection;
  std::map<int, ::e2e_cdiff::ControlAction::ConstPtr> controls;  ///< by slot, the ego's as kEgoSlot
  std::map<int, ::e2e_cdiff::Rollout::ConstPtr> rollouts;        ///< by slot
  ::e2e_cdiff::GuidanceReport::ConstPtr guidance;
  std::map<int, sensor_msgs::Image::ConstPtr> images;  ///< by slot, the ego's as kEgoSlot
  ::e2e_cdiff::MetricReport::ConstPtr report;
};

class BagFile {
 public:
  /// Name in the bag of a topic of topics.h.
  using Naming = std::function<std::string(const std::string& topic)>;

  /// Makes the file's folder. Throws InputError naming the file when it cannot be written.
  BagFile(const std::filesystem::path& file, const rendering::CameraOptions& camera, Naming naming);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  void write(const ::e2e_cdiff::SessionInfo& info);
  void write(const nav_msgs::Path& ego_route);
  /// With camera_info beside each image and, at decisions, what rviz needs beside `rosbag play`: tf
  /// and the ego's odometry.
  void write(const TickMessages& tick);
  /// Gives the file its name. Without this call it stays FILE.active; one that could not be written
  /// (disk full) is removed instead, and its room is free again.
  void finish();
  /// Nothing of it stays.
  void discard();

 private:
  void guard(const std::function<void()>& writing);
  void writeTick(const TickMessages& tick);
  void writeDisplay(const TickMessages& tick, const ::ros::Time& stamp);
  template <class Message>
  void put(const std::string& topic, const ::ros::Time& stamp, const Message& message) {
    if (message) bag_->write(naming_(topic), stamp, message);
  }

  std::filesystem::path file_;
  rendering::CameraOptions camera_;
  Naming naming_;
  std::unique_ptr<rosbag::Bag> bag_;
  bool failed_ = false;
};

}  // namespace cdiff::ros
