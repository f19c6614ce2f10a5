// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The nodes of a session as nodelets (nodelet_plugins.xml). Each must have its node's usual name.
#include <pluginlib/class_list_macros.hpp>
#include <thread>

#include "node_graph/lockstep/node_process.h"
#include "node_graph/node_main.h"
#include "node_graph/session_graph.h"
#include "nodelet/nodelet.h"

namespace cdiff::node_graph {

/// A node of a session as a nodelet: it runs in a thread of its own until the session ends. The end
/// of the object takes it out of the session.
class SessionNodelet : public nodelet::Nodelet {
 public:
  explicit SessionNodelet(const char* kind) : kind_(kind) {}
  ~SessionNodelet() override {
    stop_.raise();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void onInit() override {
    thread_ = std::thread([this] { runHostedNode(kind_, getName(), stop_); });
  }

  const char* kind_;  ///< name of the node without namespace
  StopSignal stop_;
  std::thread thread_;
};

struct TrafficSimulatorNodelet : SessionNodelet {
  TrafficSimulatorNodelet() : SessionNodelet(kTrafficSimulatorNode) {}
};
struct CbvIdentificationNodelet : SessionNodelet {
  CbvIdentificationNodelet() : SessionNodelet(kCbvIdentificationNode) {}
};
struct CameraNodelet : SessionNodelet {
  CameraNodelet() : SessionNodelet(kCameraNode) {}
};
struct EgoPlannerNodelet : SessionNodelet {
  EgoPlannerNodelet() : SessionNodelet(kEgoPlannerNode) {}
};
struct CbvPlannerNodelet : SessionNodelet {
  CbvPlannerNodelet() : SessionNodelet(kCbvPlannerNode) {}
};
struct DiffusionPlannerNodelet : SessionNodelet {
  DiffusionPlannerNodelet() : SessionNodelet(kDiffusionPlannerNode) {}
};
struct MetricsNodelet : SessionNodelet {
  MetricsNodelet() : SessionNodelet(kMetricsNode) {}
};
struct RecorderNodelet : SessionNodelet {
  RecorderNodelet() : SessionNodelet(kRecorderNode) {}
};

}  // namespace cdiff::node_graph

PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::TrafficSimulatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::CbvIdentificationNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::CameraNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::EgoPlannerNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::CbvPlannerNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::DiffusionPlannerNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::MetricsNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(cdiff::node_graph::RecorderNodelet, nodelet::Nodelet)
