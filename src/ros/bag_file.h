// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The file session.bag, whoever writes it: the topics of a session in a fixed order, tick by tick,
/// with simulated stamps. While it is written, the file is called FILE.active.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "nav_msgs/Path.h"
#include "ros/tick_messages.h"
#include "rosbag/bag.h"
#include "session/scenario_options.h"

namespace cdiff::ros {

class BagFile {
 public:
  /// Name in the bag of a topic whose name is relative.
  using Naming = std::function<std::string(const std::string& topic)>;

  /// Makes the file's folder. Throws InputError naming the file when it cannot be written.
  BagFile(const std::filesystem::path& file, const session::ScenarioOptions& options,
          Naming naming);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  void write(const ::e2e_cdiff::SessionInfo& info);
  void write(const nav_msgs::Path& ego_route);
  /// What the table of channels records of a tick, and at decisions what tools need beside `rosbag
  /// play`. The snapshot must be among the messages.
  void write(const TickMessages& tick);
  /// Gives the file its name. Without this call it stays FILE.active; one that could not be written
  /// (disk full) is removed instead, and its room is free again.
  void finish();
  /// Nothing of it stays.
  void discard();

 private:
  void guard(const std::function<void()>& writing);
  void writeTick(const TickMessages& tick);
  void put(const Topic& topic, const ::ros::Time& stamp, const AnyMessage& message);

  std::filesystem::path file_;
  int max_cbv_;  ///< slots
  TickReading reading_;
  Naming naming_;
  std::unique_ptr<rosbag::Bag> bag_;
  bool failed_ = false;
};

}  // namespace cdiff::ros
