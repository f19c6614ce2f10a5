// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>

#include "cbv/cbv_selector.h"
#include "e2e_cdiff/CbvSelection.h"
#include "nav_msgs/Path.h"
#include "node_graph/lockstep/participant.h"

namespace cdiff::node_graph {

/// CBV identification as a node: ego route and snapshots in, a selection at every decision tick
/// out.
class CbvIdentificationNode : public Participant {
 public:
  using Participant::Participant;

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  std::string waitingFor() const override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  std::string subject() const override { return "selection"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  int conclude(Ending) override { return core::ExitCode::kPassed; }

 private:
  void takeRoute(const nav_msgs::Path& path);
  session::ScenarioOptions options_;
  std::optional<map::RoadNetwork> network_;
  std::optional<map::LaneGraph> graph_;
  map::Route ego_route_;
  std::unique_ptr<cbv::CbvSelector> selector_;
  ros::Publisher selections_;
  cbv::CbvSelection newest_;  ///< of the newest decision
};

}  // namespace cdiff::node_graph
