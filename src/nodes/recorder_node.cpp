// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Records a session as a bag.
#include "ros/messages/topics.h"
#include "ros/node_main.h"
#include "ros/recorder_ros.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kRecorderNode,
                             [](StopSignal& stop) { return cdiff::ros::RecorderRos(stop).run(); });
}
