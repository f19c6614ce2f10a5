// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Kills the metrics node of a running session, as a crash would: at tick 10, by the process id that
// its XML-RPC server reports.
#include <csignal>

#include "e2e_cdiff/TrafficSnapshot.h"
#include "ros/network.h"
#include "ros/ros.h"
#include "ros/xmlrpc_manager.h"
#include "xmlrpcpp/XmlRpcClient.h"

namespace {

int processIdOf(const std::string& node) {
  XmlRpc::XmlRpcValue arguments, result, payload;
  arguments[0] = ros::this_node::getName();
  arguments[1] = node;
  if (!ros::master::execute("lookupNode", arguments, result, payload, true)) return 0;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(std::string(payload), host, port)) return 0;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  return client.execute("getPid", request, response) ? int(response[2]) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "kill_metrics_node");
  ros::NodeHandle node;
  const boost::function<void(const e2e_cdiff::TrafficSnapshot&)> on_traffic =
      [](const e2e_cdiff::TrafficSnapshot& traffic) {
        if (traffic.tick < 10) return;
        const int process = processIdOf("/metrics_node");
        if (process > 1) kill(process, SIGKILL);
        ros::requestShutdown();
      };
  const ros::Subscriber input =
      node.subscribe<e2e_cdiff::TrafficSnapshot>("/traffic", 10, on_traffic);
  ros::spin();
}
