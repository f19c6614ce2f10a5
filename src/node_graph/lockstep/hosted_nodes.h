// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/callback_queue.h"
#include "ros/ros.h"

namespace cdiff::node_graph {

// The node that a thread runs. Most programs run one node, which roscpp knows. As nodelets the
// nodes of a session are threads of one process: roscpp knows the process alone, so each thread has
// the name and the queue of its own node, and the process knows which of them have left.

/// Full name of the node that the calling thread runs.
std::string nodeName();
/// The callbacks that this node handles when it spins.
ros::CallbackQueue& nodeQueue();
/// A handle in the namespace of the session whose callbacks go there.
ros::NodeHandle nodeHandle();
/// The same in the node's private namespace.
ros::NodeHandle privateNodeHandle();

/// Makes the calling thread run a node of that full name as long as the object exists. The end of
/// the object is what others see as the node's leaving.
class HostedNode {
 public:
  explicit HostedNode(const std::string& name);
  ~HostedNode();
  HostedNode(const HostedNode&) = delete;
  HostedNode& operator=(const HostedNode&) = delete;

  /// What the node's process would end with.
  void setExitCode(int exit_code) { exit_code_ = exit_code; }

 private:
  std::string name_;
  ros::CallbackQueue queue_;
  int exit_code_ = 0;
};

/// Held while a node's object ends. roscpp may drop the topic of a third thread where two threads
/// end their publishers at once.
std::mutex& nodeEndMutex();

/// Makes a Node of the arguments, runs it and returns its exit code. Its object ends while no other
/// that was made so ends in this process, also when `run` throws.
template <class Node, class... Arguments>
int runNodeObject(Arguments&&... arguments) {
  const auto end = [](Node* node) {
    const std::lock_guard<std::mutex> lock(nodeEndMutex());
    delete node;
  };
  const std::unique_ptr<Node, decltype(end)> node(new Node(std::forward<Arguments>(arguments)...),
                                                  end);
  return node->run();
}

/// Whether the nodes of the session are threads of this process.
bool hostsNodes();
/// Whether such a node (name without namespace) runs.
bool hostedNodeRuns(const std::string& node);
/// Whether a node of the session is there, in this process or as one of the same launch, also
/// before it says anything.
bool nodeRuns(const std::string& node);
/// Its exit code once it has left; nullopt before.
std::optional<int> hostedExitCode(const std::string& node);
/// Those that have left, without namespace, in the order in which they did.
std::vector<std::string> hostedNodesLeft();
/// Whether all that came have left.
bool allHostedNodesLeft();

}  // namespace cdiff::node_graph
