// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/node_main.h"

#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <future>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/markup.h"
#include "core/program.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/messages/topics.h"
#include "node_graph/nodes/camera_node.h"
#include "node_graph/nodes/carla_session_node.h"
#include "node_graph/nodes/cbv_identification_node.h"
#include "node_graph/nodes/metrics_node.h"
#include "node_graph/nodes/planner_node.h"
#include "node_graph/nodes/recorder_node.h"
#include "node_graph/nodes/replay_node.h"
#include "node_graph/nodes/scene_node.h"
#include "node_graph/nodes/traffic_simulator_node.h"
#include "plugins/plugin_loader.h"
#include "ros/ros.h"

namespace cdiff::node_graph {
namespace {

constexpr double kMasterPatience = 5.0;  // [s] of wall time for a master that does not answer

/// What plug-ins throw while they are loaded: ROS says it, which begins later, with threads of its
/// own.
std::exception_ptr loadPlugins() {
  try {
    plugins::loadPlugins();
    return nullptr;
  } catch (...) {
    return std::current_exception();
  }
}

int runGuarded(const std::function<int(StopSignal&)>& body, StopSignal& stop,
               const std::exception_ptr& wrong_plugin) {
  try {
    if (wrong_plugin) std::rethrow_exception(wrong_plugin);
    return body(stop);
  } catch (const std::exception& error) {
    const core::Failure failure = core::failureOf(error);
    ROS_FATAL("%s", core::plainText(failure.text).c_str());
    return failure.exit_code;
  }
}

/// The nodes follow the ticks, and none but the metrics node (which stamps /diagnostics) asks ROS
/// for the time: /clock would wake each of them once more at every tick.
/// In a namespace nobody makes a clock.
void initWithoutClock(int argc, char** argv, const std::string& name) {
  const char* space = std::getenv("ROS_NAMESPACE");  // set by roslaunch
  const bool has_clock = space == nullptr || std::string(space).size() < 2;
  std::string no_clock = "/use_sim_time:=/e2e_cdiff_use_sim_time";
  std::vector<char*> arguments(argv, argv + argc);
  if (name != kMetricsNode || !has_clock) arguments.push_back(no_clock.data());
  int count = static_cast<int>(arguments.size());
  ros::init(count, arguments.data(), name, ros::init_options::NoSigintHandler);
}

/// `without_master`, where given, gives the exit code when no ROS master answers.
int runNode(int argc, char** argv, const char* name, const std::function<int(StopSignal&)>& body,
            const std::function<int()>& without_master = {}) {
  core::prepareProgram();
  StopSignal stop;
  const std::exception_ptr wrong_plugin = loadPlugins();
  initWithoutClock(argc, argv, name);
  if (!ros::master::check()) {
    ROS_FATAL("no ROS master answers at %s; start one with roscore, or use roslaunch",
              ros::master::getURI().c_str());
    return without_master ? without_master() : core::ExitCode::kRunTimeError;
  }
  ros::master::setRetryTimeout(ros::WallDuration(kMasterPatience));
  ros::start();  // else ROS would end with the last node handle, and an error after that
                 // would not be logged
  const int exit_code = runGuarded(body, stop, wrong_plugin);
  ros::shutdown();
  return exit_code;
}

template <class Node>
int runNode(int argc, char** argv, const char* name) {
  return runNode(argc, argv, name, runNodeObject<Node, StopSignal&>);
}

using NodeBody = int (*)(StopSignal&);

NodeBody bodyOf(const std::string& kind) {
  static const std::map<std::string, NodeBody> bodies = {
      {kTrafficSimulatorNode, runTrafficSimulator},
      {kCbvIdentificationNode, runNodeObject<CbvIdentificationNode, StopSignal&>},
      {kCameraNode, runNodeObject<CameraNode, StopSignal&>},
      {kEgoPlannerNode, runNodeObject<EgoPlannerNode, StopSignal&>},
      {kCbvPlannerNode, runNodeObject<CbvPlannerNode, StopSignal&>},
      {kDiffusionPlannerNode, runNodeObject<CbvPlannerNode, StopSignal&>},
      {kMetricsNode, runNodeObject<MetricsNode, StopSignal&>},
      {kRecorderNode, runNodeObject<RecorderNode, StopSignal&>}};
  const auto found = bodies.find(kind);
  if (found == bodies.end()) throw std::logic_error("no node of a session is called " + kind);
  return found->second;
}

/// Waits for the simulator, then for the others to finish their files.
int waitForHostedNodes() {
  constexpr double kPatience = 10.0;  // [s] for who may hang
  while (!hostedExitCode(kTrafficSimulatorNode)) ros::WallDuration(kSpinPeriod).sleep();
  const auto begin = std::chrono::steady_clock::now();
  while (!allHostedNodesLeft() && secondsSince(begin) < kPatience)
    ros::WallDuration(kSpinPeriod).sleep();
  return *hostedExitCode(kTrafficSimulatorNode);
}

}  // namespace

int runHostedNode(const std::string& kind, const std::string& name, StopSignal& stop) {
  HostedNode node(name);
  const int exit_code = runGuarded(bodyOf(kind), stop, loadPlugins());
  node.setExitCode(exit_code);
  return exit_code;
}

int runNodeletManager(int argc, char** argv, const LoadNodelet& load) {
  core::prepareProgram();
  const StopSignal stop;  // blocks the signals, for the nodes to ask for
  loadPlugins();  // a child tries them, which needs a process of one thread; the nodes say what is
                  // wrong
  ros::init(argc, argv, "session_nodelets", ros::init_options::NoSigintHandler);
  if (!ros::master::check()) return MetricsNode::runWithoutMaster();
  ros::master::setRetryTimeout(ros::WallDuration(kMasterPatience));
  ros::start();
  ros::AsyncSpinner services(1);  // of the loader
  services.start();
  bool loaded = true;
  for (int i = 1; loaded && i < argc; ++i) {
    const std::string kind = argv[i];
    loaded = load(kind, ros::names::append(ros::this_node::getNamespace(), kind + "_node"));
    ROS_FATAL_COND(!loaded, "cannot load the nodelet e2e_cdiff/%s (above)", kind.c_str());
  }
  const int exit_code = loaded ? waitForHostedNodes() : core::ExitCode::kRunTimeError;
  ros::shutdown();
  std::cout.flush();
  std::fflush(nullptr);
  std::_Exit(exit_code);  // a node that hangs would hold up the end of its objects
}

bool masterAnswers() {
  auto promise = std::make_shared<std::promise<bool>>();
  std::future<bool> answer = promise->get_future();
  std::thread([promise] { promise->set_value(ros::master::check()); }).detach();
  return answer.wait_for(std::chrono::seconds(2)) == std::future_status::ready && answer.get();
}

int runTrafficSimulatorNode(int argc, char** argv) {
  return runNode(argc, argv, kTrafficSimulatorNode, runTrafficSimulator);
}

int runCbvIdentificationNode(int argc, char** argv) {
  return runNode<CbvIdentificationNode>(argc, argv, kCbvIdentificationNode);
}

int runCameraNode(int argc, char** argv) { return runNode<CameraNode>(argc, argv, kCameraNode); }

int runEgoPlannerNode(int argc, char** argv) {
  return runNode<EgoPlannerNode>(argc, argv, kEgoPlannerNode);
}

int runCbvPlannerNode(int argc, char** argv) {
  return runNode<CbvPlannerNode>(argc, argv, kCbvPlannerNode);
}

int runDiffusionPlannerNode(int argc, char** argv) {
  return runNode<CbvPlannerNode>(argc, argv, kDiffusionPlannerNode);
}

int runMetricsNode(int argc, char** argv) {
  return runNode(
      argc, argv, kMetricsNode, [](StopSignal& stop) { return MetricsNode(stop).run(); },
      MetricsNode::runWithoutMaster);
}

int runRecorderNode(int argc, char** argv) {
  // The compressor of bags takes and frees 1 MB for each chunk. On the heap the hole would be
  // filled with what the bag keeps, and the heap would grow for hours.
  constexpr int kLargeBuffer = 128 << 10;  // [bytes]
  ::mallopt(M_MMAP_THRESHOLD, kLargeBuffer);
  return runNode<RecorderNode>(argc, argv, kRecorderNode);
}

int runCarlaSessionNode(int argc, char** argv) {
  return runNode(argc, argv, kCarlaSessionNode, runCarlaSession);
}

int runSceneNode(int argc, char** argv) { return runNode<SceneNode>(argc, argv, kSceneNode); }

int runReplayNode(int argc, char** argv) {
  return runNode(argc, argv, kTrafficSimulatorNode,
                 [](StopSignal& stop) { return runReplay(stop); });
}

}  // namespace cdiff::node_graph
