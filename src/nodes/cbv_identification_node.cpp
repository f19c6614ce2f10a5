// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Finds the critical background vehicles of a session.
#include "ros/cbv_identification_ros.h"
#include "ros/messages/topics.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kCbvIdentificationNode, [](StopSignal& stop) {
    return cdiff::ros::CbvIdentificationRos(stop).run();
  });
}
