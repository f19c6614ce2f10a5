// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "node_graph/bags/bag_queue.h"
#include "node_graph/lockstep/participant.h"

namespace cdiff::node_graph {

/// The recorder as a node: takes part in the lockstep and writes every tick of the session to
/// session.bag in the result folder.
class RecorderNode : public Observer {
 public:
  using Observer::Observer;

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  std::string waitingFor() const override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  std::string subject() const override { return "bag"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  int conclude(Ending ending) override;

 private:
  bool measured(const ::e2e_cdiff::TrafficSnapshot& snapshot, bool superseded);

  std::unique_ptr<BagFile> bag_;
  std::unique_ptr<BagQueue> queue_;  ///< from the first tick on
  bool has_route_ = false;
  std::optional<std::uint64_t> acknowledged_;  ///< last tick
  ros::SteadyTime waiting_since_;
};

}  // namespace cdiff::node_graph
