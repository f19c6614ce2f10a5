// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>

#include "e2e_cdiff/CbvSelection.h"
#include "image_transport/image_transport.h"
#include "nav_msgs/Path.h"
#include "node_graph/lockstep/participant.h"
#include "session/session_setup.h"
#include "session/vehicle_cameras.h"

namespace cdiff::node_graph {

/// The cameras as a node: snapshots and selection in; at decision ticks an image (rgb8) and its
/// intrinsics of each camera of each occupied slot and of the ego out, of those whose planner sees
/// or that the session shows.
class CameraNode : public Participant {
 public:
  explicit CameraNode(StopSignal& stop) : Participant(stop), transport_(node()) {}

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  bool ready(const ::e2e_cdiff::TrafficSnapshot& snapshot) const override {
    return !graph().imagesOfCbvs() || selections_.count(snapshot.tick) > 0;
  }
  bool leavesOut() const override { return graph().paced; }
  bool mayLag() const override { return true; }
  std::string subject() const override { return "images"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    status.add("images", images_);
  }
  int conclude(Ending) override { return core::ExitCode::kPassed; }

 private:
  struct Output {
    image_transport::Publisher images;
    ros::Publisher infos;
  };
  void open(int slot);
  void open(int slot, const std::string& camera);
  void show(int slot, const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id);

  image_transport::ImageTransport transport_;
  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<session::VehicleCameras> cameras_;
  std::map<std::uint64_t, ::e2e_cdiff::CbvSelection::ConstPtr> selections_;  ///< by tick
  std::map<std::pair<int, std::string>, Output> outputs_;                    ///< by slot and camera
  std::uint64_t images_ = 0;                                                 ///< published
};

}  // namespace cdiff::node_graph
