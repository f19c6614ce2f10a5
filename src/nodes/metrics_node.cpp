// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Measures a session and writes its result folder.
#include "ros/messages/topics.h"
#include "ros/metrics_ros.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  using namespace cdiff::ros;
  return runNode(
      argc, argv, kMetricsNode, [](StopSignal& stop) { return MetricsRos(stop).run(); },
      MetricsRos::runWithoutMaster);
}
