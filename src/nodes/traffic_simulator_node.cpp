// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Owns a session's world and clock.
#include "ros/messages/topics.h"
#include "ros/node_main.h"
#include "ros/traffic_simulator_ros.h"

int main(int argc, char** argv) {
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kTrafficSimulatorNode,
                             cdiff::ros::runTrafficSimulator);
}
