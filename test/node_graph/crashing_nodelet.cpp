// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Takes the place of one call of roscpp for the tests (LD_PRELOAD): a nodelet ends the process of
/// all nodes from inside. The file that CRASHING_NODELET names says, once it is there, which
/// nodelet does so and by which signal ("camera_node 11").
#include <dlfcn.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

#include "ros/callback_queue.h"

namespace {

/// Name of the node that this thread runs, without namespace; empty in other programs.
std::string thisNode() {
  using NodeName = std::string (*)();
  static const auto node_name =
      reinterpret_cast<NodeName>(::dlsym(RTLD_DEFAULT, "_ZN5cdiff10node_graph8nodeNameB5cxx11Ev"));
  const std::string name = node_name == nullptr ? "" : node_name();
  return name.substr(name.rfind('/') + 1);
}

void crashIfAsked() {
  static const char* const file = std::getenv("CRASHING_NODELET");
  if (file == nullptr) return;
  std::ifstream order(file);
  std::string node;
  int signal = 0;
  if (order >> node >> signal && node == thisNode()) std::raise(signal);
}

}  // namespace

/// Every node calls it at every tick.
void ros::CallbackQueue::callAvailable(ros::WallDuration timeout) {
  using Call = void (*)(CallbackQueue*, ros::WallDuration);
  static const auto original = reinterpret_cast<Call>(
      ::dlsym(RTLD_NEXT, "_ZN3ros13CallbackQueue13callAvailableENS_12WallDurationE"));
  crashIfAsked();
  original(this, timeout);
}
