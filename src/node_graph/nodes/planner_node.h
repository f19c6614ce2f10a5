// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "diagnostic_updater/diagnostic_updater.h"
#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/planning/planner.h"
#include "nav_msgs/Path.h"
#include "node_graph/lockstep/image_inbox.h"
#include "node_graph/lockstep/participant.h"
#include "node_graph/messages/session_conversions.h"
#include "session/session_setup.h"
#include "session/steered_cbvs.h"

namespace cdiff::node_graph {

/// How a planner fares over a session: latency of the last 1000 calls [ms], batch size, age of
/// images, faults by kind, calls that took longer than the decision period. For /diagnostics.
class PlannerStatistics {
 public:
  /// `decision_period` [s]: a call that takes longer in wall time misses its deadline.
  explicit PlannerStatistics(double decision_period = 0.1) : decision_period_(decision_period) {}

  void observe(const PlannerDecision& decision);
  /// Vehicles that got the fail-safe action, by kind: "image missing", "image refused", "planning
  /// call" (all of a call), "vehicle" (the planner's own).
  const std::map<std::string, std::uint64_t>& faults() const { return faults_; }
  std::uint64_t deadlineMisses() const { return deadline_misses_; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  double decision_period_;
  boost::circular_buffer<double> latencies_ms_{1000};
  std::uint64_t decisions_ = 0;
  std::map<std::string, std::uint64_t> faults_;
  std::uint64_t deadline_misses_ = 0;
  std::size_t batch_size_ = 0;  ///< vehicles in the last call
  double image_age_ = 0.0;      ///< age of the images at the last call [s]
};

// Planners as nodes: one for the ego, one for all CBVs, each asking its planner exactly as the
// closed loop in one process does.

/// A node whose planner may see: it keeps the images of its vehicles' cameras.
class SeeingParticipant : public Participant {
 public:
  using Participant::Participant;

 protected:
  /// To all cameras of the slot's rig, which images() must know by now.
  void listenToImages(int slot);
  ImageInbox& images() { return images_; }
  const ImageInbox& images() const { return images_; }

 private:
  ImageInbox images_;
};

/// The ego's planner: snapshots and route in (and its images where the planner sees), its control
/// out, and what it intends and believes to see as markers while anyone subscribes.
class EgoPlannerNode : public SeeingParticipant {
 public:
  using SeeingParticipant::SeeingParticipant;

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  std::string waitingFor() const override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  bool ready(const ::e2e_cdiff::TrafficSnapshot& snapshot) const override;
  bool leavesOut() const override { return graph().paced; }
  std::string subject() const override { return "planner"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    statistics_.diagnose(status);
  }
  int conclude(Ending) override { return core::ExitCode::kPassed; }

 private:
  void show(const traffic::TrafficSnapshot& snapshot, const PlannerDecision& decision);

  std::unique_ptr<session::SessionSetup> setup_;
  map::Route route_;
  std::unique_ptr<planning::Planner> planner_;
  ros::Publisher controls_;
  ros::Publisher markers_;
  PlannerStatistics statistics_;
};

/// The planner of all CBVs, asked once per decision for all slots: snapshots and selection in (and
/// the images of every occupied slot where the planner sees), controls and rollouts out, what
/// guidance did where the planner is guided, the rollouts as markers while anyone subscribes, and
/// how the planner fares in /diagnostics.
class CbvPlannerNode : public SeeingParticipant {
 public:
  using SeeingParticipant::SeeingParticipant;

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  bool ready(const ::e2e_cdiff::TrafficSnapshot& snapshot) const override;
  void arrived(const ::e2e_cdiff::TrafficSnapshot& snapshot) override;
  bool leavesOut() const override { return graph().paced; }
  std::string subject() const override { return "planner"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    statistics_.diagnose(status);
  }
  int conclude(Ending) override { return core::ExitCode::kPassed; }

 private:
  void listenToInputs();
  /// Follows what was steered up to a tick, whether its snapshots were left out or not.
  void followSteering(std::uint64_t tick);
  /// Whether the images of every slot with a vehicle have arrived, where the planner sees.
  bool complete(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                const ::e2e_cdiff::CbvSelection& selection) const;
  void plan(const traffic::TrafficSnapshot& snapshot, const ::e2e_cdiff::CbvSelection& selection);
  void publish(const traffic::TrafficSnapshot& snapshot, const PlannerDecision& decision);

  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<planning::Planner> planner_;
  std::unique_ptr<session::SteeredCbvs> steered_;
  std::map<std::uint64_t, std::vector<traffic::SteeringChange>> steering_;   ///< to follow, by tick
  std::map<std::uint64_t, ::e2e_cdiff::CbvSelection::ConstPtr> selections_;  ///< by tick
  std::map<Topic, ros::Publisher> answers_;
  ros::Publisher markers_;
  PlannerStatistics statistics_;
};

}  // namespace cdiff::node_graph
