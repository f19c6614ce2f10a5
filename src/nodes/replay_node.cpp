// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Tells a recorded session again, under the traffic simulator's name, to which the other nodes
/// listen.
#include "ros/messages/topics.h"
#include "ros/node_main.h"
#include "ros/replay_ros.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kTrafficSimulatorNode,
                             [](StopSignal& stop) { return cdiff::ros::runReplay(stop); });
}
