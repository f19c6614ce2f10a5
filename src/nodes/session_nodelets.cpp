// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A nodelet manager for one session: loads the nodelets whose kinds it is given (metrics,
/// recorder, ...), beside them what `nodelet load` asks for, and ends with the session.
#include "node_graph/node_main.h"
#include "nodelet/loader.h"

int main(int argc, char** argv) {
  return cdiff::node_graph::runNodeletManager(
      argc, argv, [](const std::string& kind, const std::string& name) {
        static nodelet::Loader loader;  // made once ROS runs
        return loader.load(name, "e2e_cdiff/" + kind, {}, {});
      });
}
