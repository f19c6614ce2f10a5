// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/node_main.h"

#include <exception>

#include "e2e_cdiff/core/failure.h"
#include "ros/ros.h"

namespace cdiff::ros {
namespace {

constexpr double kMasterPatience = 5.0;  // [s] of wall time for a master that does not answer

int runGuarded(const std::function<int(StopSignal&)>& body, StopSignal& stop) {
  try {
    return body(stop);
  } catch (const std::exception& error) {
    const core::Failure failure = core::failureOf(error);
    ROS_FATAL("%s", failure.text.c_str());
    return failure.exit_code;
  }
}

}  // namespace

int runNode(int argc, char** argv, const char* name, const std::function<int(StopSignal&)>& body) {
  StopSignal stop;
  ::ros::init(argc, argv, name, ::ros::init_options::NoSigintHandler);
  if (!::ros::master::check()) {
    ROS_FATAL("no ROS master answers at %s; start one with roscore, or use roslaunch",
              ::ros::master::getURI().c_str());
    return 2;
  }
  ::ros::master::setRetryTimeout(::ros::WallDuration(kMasterPatience));
  ::ros::start();  // else ROS would end with the last node handle, and an error after that would
                   // not be told
  const int exit_code = runGuarded(body, stop);
  ::ros::shutdown();
  return exit_code;
}

}  // namespace cdiff::ros
