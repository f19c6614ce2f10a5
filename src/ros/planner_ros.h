// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Planners as nodes: one for the ego, one for all CBVs, each asking its planner exactly as the
/// closed loop in one process does.
#pragma once

#include <map>
#include <memory>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/planning/planner.h"
#include "nav_msgs/Path.h"
#include "ros/conversions.h"
#include "ros/image_inbox.h"
#include "ros/participant.h"
#include "session/session_setup.h"

namespace cdiff::ros {

/// The ego's planner: snapshots and route in (and its image where the planner sees), ego/control
/// out.
class EgoPlannerRos : public Participant {
 public:
  using Participant::Participant;

 protected:
  void begin(const ::e2e_cdiff::SessionInfo& info) override;
  std::string waitingFor() const override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  bool ready(const ::e2e_cdiff::TrafficSnapshot& snapshot) const override;
  bool leavesOut() const override { return graph().paced; }
  int conclude(Ending) override { return 0; }

 private:
  std::vector<planning::PlannedAction> decide(const traffic::TrafficSnapshot& snapshot,
                                              const std::vector<planning::PlanningTask>& tasks,
                                              ActionOrigin& origin);
  std::unique_ptr<session::SessionSetup> setup_;
  map::Route route_;
  ImageInbox images_;
  std::unique_ptr<planning::Planner> planner_;
  ::ros::Publisher controls_;
};

/// The planner of all CBVs, asked once per decision for all slots: snapshots and selection in,
/// cbv_K/control and cbv_K/rollout out, and the rollouts as markers while somebody looks.
class CbvPlannerRos : public Participant {
 public:
  using Participant::Participant;

 protected:
  void begin(const ::e2e_cdiff::SessionInfo& info) override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  bool ready(const ::e2e_cdiff::TrafficSnapshot& snapshot) const override;
  bool leavesOut() const override { return graph().paced; }
  int conclude(Ending) override { return 0; }

  /// Whether all that the planner needs for this decision besides the selection has come.
  virtual bool complete(const ::e2e_cdiff::TrafficSnapshot&,
                        const ::e2e_cdiff::CbvSelection&) const {
    return true;
  }
  /// The actions for the tasks (one at least), in their order; fills in latency and fault.
  virtual std::vector<planning::PlannedAction> decide(
      const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks,
      ActionOrigin& origin);
  const session::SessionSetup& setup() const { return *setup_; }
  planning::Planner& planner() { return *planner_; }

 private:
  void plan(const traffic::TrafficSnapshot& snapshot, const ::e2e_cdiff::CbvSelection& selection);
  void publish(const traffic::TrafficSnapshot& snapshot,
               const std::vector<planning::PlannedAction>& actions, const ActionOrigin& origin);
  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<planning::Planner> planner_;
  ::ros::Publisher markers_;
  std::map<std::uint64_t, ::e2e_cdiff::CbvSelection::ConstPtr> selections_;  ///< by tick
  std::vector<::ros::Publisher> controls_;                                   ///< by slot
  std::vector<::ros::Publisher> rollouts_;                                   ///< by slot
};

}  // namespace cdiff::ros
