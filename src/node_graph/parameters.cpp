// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/parameters.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/recorded_steering.h"
#include "node_graph/lockstep/node_process.h"
#include "ros/ros.h"
#include "session/steering_file.h"
#include "suite/seal.h"

namespace cdiff::node_graph {
namespace {

std::string textOf(const std::string& key, XmlRpc::XmlRpcValue value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string&>(value);
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int&>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return core::formatNumber(static_cast<double&>(value));
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool&>(value) ? "true" : "false";
    default:
      throw core::InputError("parameter ~" + key + " is neither a text, a number nor a flag");
  }
}

}  // namespace

Parameters Parameters::ofThisNode() {
  const Parameters parameters = of(nodeName());
  if (parameters.empty() && !ros::master::check())
    throw std::runtime_error("the ROS master at " + ros::master::getURI() +
                             " does not answer any more");
  return parameters;
}

Parameters Parameters::ofNode(const std::string& node) { return of(ros::names::resolve(node)); }

Parameters Parameters::of(const std::string& full_name) {
  std::map<std::string, std::string> values;
  XmlRpc::XmlRpcValue all;
  if (!ros::param::get(full_name, all)) return Parameters(values);
  if (all.getType() != XmlRpc::XmlRpcValue::TypeStruct) return Parameters(values);
  for (auto& [key, value] : all) values[key] = textOf(key, value);
  return Parameters(values);
}

void Parameters::requireKnown(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : values_) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw core::InputError("unknown parameter ~" + key + "; the nearest known one is ~" +
                           core::nearestName(key, known));
  }
}

std::string Parameters::text(const std::string& key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? std::string() : found->second;
}

double Parameters::positive(const std::string& key, double otherwise) const {
  const std::string value = text(key);
  if (value.empty()) return otherwise;
  const std::optional<double> number = core::parseNumber(value);
  if (!number || *number <= 0.0) {
    throw core::InputError("parameter ~" + key + " is '" + value + "'; expected a number above 0");
  }
  return *number;
}

bool Parameters::flag(const std::string& key, bool otherwise) const {
  const std::string value = text(key);
  if (value.empty()) return otherwise;
  if (value != "true" && value != "false") {
    throw core::InputError("parameter ~" + key + " is '" + value + "'; expected true or false");
  }
  return value == "true";
}

Parameters launchParameters() {
  std::optional<LaunchCommand> command = launchCommand();
  if (!command) return Parameters({});
  command->arguments.emplace("folder", command->folder.string());
  return Parameters(command->arguments);
}

session::SessionRequest sessionRequest(const Parameters& parameters) {
  session::SessionRequest request;
  request.scenario = parameters.text("scenario");
  request.bench2drive = parameters.text("bench2drive");
  request.route = parameters.text("route");
  request.network = parameters.text("network");
  request.mode = parameters.text("mode");
  request.ego_planner = parameters.text("ego_planner");
  request.cbv_planner = parameters.text("cbv_planner");
  request.seed = parameters.text("seed");
  const std::string steering = parameters.text("steering");
  if (!steering.empty()) request.steering = readSteering(steering);
  request.video = parameters.flag("video", false);
  request.set = core::splitText(parameters.text("set"), ' ');
  request.set_source = "parameter ~set";
  if (request.scenario.empty() && request.bench2drive.empty())
    request.scenario = "crossing_left_turn";
  return request;
}

session::ScenarioOptions requestedScenario(const Parameters& parameters) {
  const session::SessionRequest request = sessionRequest(parameters);
  suite::requireOpen(request.scenario);
  session::ScenarioOptions options = session::resolveRequest(request);
  const std::string steering = parameters.text("steering");
  if (!steering.empty())
    session::requireSameSession(steering, steeredSession(steering), options, E2E_CDIFF_VERSION);
  return options;
}

}  // namespace cdiff::node_graph
