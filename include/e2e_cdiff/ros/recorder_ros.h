// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The recorder as a node: takes part in the lockstep and writes every tick of the session, in a
/// fixed order and with simulated stamps, to session.bag in the result folder. While it writes, the
/// file is called session.bag.active.
#pragma once

#include <filesystem>
#include <map>

#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/ros/image_inbox.h"
#include "e2e_cdiff/ros/participant.h"
#include "e2e_cdiff/ros/tick_answers.h"
#include "nav_msgs/Path.h"
#include "rosbag/bag.h"

namespace cdiff::ros {

class RecorderRos : public Participant {
 public:
  using Participant::Participant;

 protected:
  void begin(const ::e2e_cdiff::SessionInfo& info) override;
  std::string waitingFor() const override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  int conclude(Ending ending) override;

 private:
  void listenToAll();
  void listenToSlot(int slot);
  void listenToImages(int slot);
  bool complete(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  bool seen(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  void write(const Snapshot& snapshot);
  void writeImages(std::uint64_t tick, const ::ros::Time& stamp);
  void writeDisplay(const ::e2e_cdiff::TrafficSnapshot& snapshot, const ::ros::Time& stamp);
  void forgetUntil(std::uint64_t tick);

  std::filesystem::path file_;
  rosbag::Bag bag_;
  rendering::CameraOptions camera_;
  ImageInbox images_;
  TickAnswers answers_;
  nav_msgs::Path::ConstPtr route_;
  std::map<std::uint64_t, ::e2e_cdiff::MetricReport::ConstPtr> reports_;  ///< by tick
  std::map<std::uint64_t, std::map<int, ::e2e_cdiff::Rollout::ConstPtr>>
      rollouts_;  ///< by tick, then slot
  ::ros::WallTime waiting_since_;
};

}  // namespace cdiff::ros
