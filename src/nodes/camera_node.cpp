// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Renders what the driven vehicles see.
#include "ros/camera_ros.h"
#include "ros/messages/topics.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  using cdiff::ros::StopSignal;
  return cdiff::ros::runNode(argc, argv, cdiff::ros::kCameraNode,
                             [](StopSignal& stop) { return cdiff::ros::CameraRos(stop).run(); });
}
