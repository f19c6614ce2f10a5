// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/hosted_nodes.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"

namespace cdiff::node_graph {
namespace {

struct ThreadNode {
  std::string name;                     ///< full
  ros::CallbackQueue* queue = nullptr;  ///< null where the thread runs no hosted node
};

thread_local ThreadNode thread_node;

/// The hosted nodes of this process, without namespace.
struct Host {
  std::mutex mutex;
  std::vector<std::string> running;
  std::vector<std::pair<std::string, int>> left;  ///< with exit codes
};

Host& host() {
  static Host of_process;
  return of_process;
}

}  // namespace

std::string nodeName() {
  return thread_node.queue == nullptr ? ros::this_node::getName() : thread_node.name;
}

ros::CallbackQueue& nodeQueue() {
  return thread_node.queue == nullptr ? *ros::getGlobalCallbackQueue() : *thread_node.queue;
}

ros::NodeHandle nodeHandle() {
  ros::NodeHandle handle;
  handle.setCallbackQueue(&nodeQueue());
  return handle;
}

ros::NodeHandle privateNodeHandle() {
  ros::NodeHandle handle(nodeName());
  handle.setCallbackQueue(&nodeQueue());
  return handle;
}

HostedNode::HostedNode(const std::string& name) : name_(name) {
  thread_node = {name, &queue_};
  const std::lock_guard<std::mutex> lock(host().mutex);
  host().running.push_back(baseName(name));
}

HostedNode::~HostedNode() {
  thread_node = {};
  const std::lock_guard<std::mutex> lock(host().mutex);
  auto& running = host().running;
  running.erase(std::find(running.begin(), running.end(), baseName(name_)));
  host().left.emplace_back(baseName(name_), exit_code_);
}

std::mutex& nodeEndMutex() {
  static std::mutex mutex;
  return mutex;
}

bool hostsNodes() {
  const std::lock_guard<std::mutex> lock(host().mutex);
  return !host().running.empty() || !host().left.empty();
}

bool hostedNodeRuns(const std::string& node) {
  const std::lock_guard<std::mutex> lock(host().mutex);
  const auto& running = host().running;
  return std::find(running.begin(), running.end(), node) != running.end();
}

bool nodeRuns(const std::string& node) {
  return hostsNodes() ? hostedNodeRuns(node) : launchedProcess(node).has_value();
}

std::optional<int> hostedExitCode(const std::string& node) {
  const std::lock_guard<std::mutex> lock(host().mutex);
  for (const auto& [name, exit_code] : host().left) {
    if (name == node) return exit_code;
  }
  return std::nullopt;
}

std::vector<std::string> hostedNodesLeft() {
  const std::lock_guard<std::mutex> lock(host().mutex);
  std::vector<std::string> names;
  for (const auto& entry : host().left) names.push_back(entry.first);
  return names;
}

bool allHostedNodesLeft() {
  const std::lock_guard<std::mutex> lock(host().mutex);
  return host().running.empty();
}

}  // namespace cdiff::node_graph
