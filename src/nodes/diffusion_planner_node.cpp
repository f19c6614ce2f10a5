// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Drives all CBVs where their planner sees: cbv_planner_node under another name.
#include "ros/messages/topics.h"
#include "ros/node_main.h"
#include "ros/planner_ros.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kDiffusionPlannerNode, [](StopSignal& stop) {
    return cdiff::ros::CbvPlannerRos(stop).run();
  });
}
