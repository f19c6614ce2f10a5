// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The planner of all CBVs where it sees: as CbvPlannerRos, and waits for the image of every
/// occupied slot; tells what guidance did on cbv/guidance and how it fares in /diagnostics.
#pragma once

#include <memory>

#include "diagnostic_updater/diagnostic_updater.h"
#include "ros/planner_ros.h"
#include "ros/planner_statistics.h"

namespace cdiff::ros {

class DiffusionPlannerRos : public CbvPlannerRos {
 public:
  using CbvPlannerRos::CbvPlannerRos;

 protected:
  void begin(const ::e2e_cdiff::SessionInfo& info) override;
  bool complete(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                const ::e2e_cdiff::CbvSelection& selection) const override;
  std::vector<planning::PlannedAction> decide(const traffic::TrafficSnapshot& snapshot,
                                              const std::vector<planning::PlanningTask>& tasks,
                                              ActionOrigin& origin) override;

 private:
  void publishGuidance(const traffic::TrafficSnapshot& snapshot, const SeeingDecision& decision);

  ImageInbox images_;
  ::ros::Publisher guidance_;
  PlannerStatistics statistics_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
};

}  // namespace cdiff::ros
