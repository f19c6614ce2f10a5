// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/node_main.h"

#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <thread>

#include "core/program.h"
#include "plugins/plugin_loader.h"
#include "ros/ros.h"

namespace cdiff::ros {
namespace {

constexpr double kMasterPatience = 5.0;  // [s] of wall time for a master that does not answer

int runGuarded(const std::function<int(StopSignal&)>& body, StopSignal& stop) {
  try {
    plugins::loadPlugins();
    return body(stop);
  } catch (const std::exception& error) {
    const core::Failure failure = core::failureOf(error);
    ROS_FATAL("%s", failure.text.c_str());
    return failure.exit_code;
  }
}

}  // namespace

bool masterAnswers() {
  auto promise = std::make_shared<std::promise<bool>>();
  std::future<bool> answer = promise->get_future();
  std::thread([promise] { promise->set_value(::ros::master::check()); }).detach();
  return answer.wait_for(std::chrono::seconds(2)) == std::future_status::ready && answer.get();
}

int runNode(int argc, char** argv, const char* name, const std::function<int(StopSignal&)>& body,
            const std::function<int()>& without_master) {
  core::prepareProgram();
  StopSignal stop;
  ::ros::init(argc, argv, name, ::ros::init_options::NoSigintHandler);
  if (!::ros::master::check()) {
    ROS_FATAL("no ROS master answers at %s; start one with roscore, or use roslaunch",
              ::ros::master::getURI().c_str());
    return without_master ? without_master() : 2;
  }
  ::ros::master::setRetryTimeout(::ros::WallDuration(kMasterPatience));
  ::ros::start();  // else ROS would end with the last node handle, and an error after that would
                   // not be logged
  const int exit_code = runGuarded(body, stop);
  ::ros::shutdown();
  return exit_code;
}

}  // namespace cdiff::ros
