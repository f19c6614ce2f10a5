// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Drives the ego.
#include "ros/messages/topics.h"
#include "ros/node_main.h"
#include "ros/planner_ros.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kEgoPlannerNode, [](StopSignal& stop) {
    return cdiff::ros::EgoPlannerRos(stop).run();
  });
}
