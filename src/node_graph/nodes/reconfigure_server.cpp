// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/reconfigure_server.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"

namespace cdiff::node_graph {
namespace {

using dynamic_reconfigure::Config;

constexpr double kLargestWeight = 1000.0;     // as guidance::WeightedObjective
constexpr double kLeastTargetSpeed = 0.5;     // as the scenario's [m/s]
constexpr double kHighestTargetSpeed = 40.0;  // likewise

void add(Config& config, const std::string& name, double value) {
  config.doubles.emplace_back();
  config.doubles.back().name = name;
  config.doubles.back().value = value;
}

/// The one group that all parameters are in.
void addGroup(Config& config) {
  config.groups.emplace_back();
  config.groups.back().name = "Default";
  config.groups.back().state = true;
}

}  // namespace

ReconfigureServer::ReconfigureServer(session::SessionControl& control,
                                     const session::SessionSetup& setup, ros::CallbackQueue& queue)
    : control_(control), target_speed_(setup.options().target_speed) {
  node_.setCallbackQueue(&queue);
  describe(setup);
  updates_ = node_.advertise<Config>("parameter_updates", 1, true);
  update();
  const boost::function<bool(Event&)> call = [this](Event& event) { return set(event); };
  server_ = node_.advertiseService<Event>("set_parameters", call);
}

void ReconfigureServer::describe(const session::SessionSetup& setup) {
  parameters_ = {{"target_speed", session::steered::kTargetSpeed,
                  "Target speed of all CBVs [m/s], capped by the lane's limit.", kLeastTargetSpeed,
                  kHighestTargetSpeed}};
  if (planners::canBeGuided(setup.options().cbv_planner)) {
    for (const guidance::WeightedObjective& entry : setup.options().guidance.objectives)
      parameters_.push_back({entry.name + "_weight", session::steered::kWeight + entry.name,
                             "Weight of the objective; 0 switches it off.", 0.0, kLargestWeight});
  }
  dynamic_reconfigure::ConfigDescription description;
  description.groups.emplace_back();
  description.groups.back().name = "Default";
  for (const Parameter& parameter : parameters_) {
    description.groups.back().parameters.emplace_back();
    description.groups.back().parameters.back().name = parameter.name;
    description.groups.back().parameters.back().type = "double";
    description.groups.back().parameters.back().description = parameter.text;
    add(description.min, parameter.name, parameter.minimum);
    add(description.max, parameter.name, parameter.maximum);
  }
  addGroup(description.min);
  addGroup(description.max);
  description.dflt = values();
  descriptions_ =
      node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  descriptions_.publish(description);
}

/// As they are, or will be at the next decision.
Config ReconfigureServer::values() const {
  Config config;
  for (const Parameter& parameter : parameters_) {
    const auto value = core::parseNumber(control_.value(parameter.what));
    add(config, parameter.name, value.value_or(target_speed_));
  }
  addGroup(config);
  return config;
}

void ReconfigureServer::update() { updates_.publish(values()); }

/// Steers what has another value; the answer shows what was refused by its old one.
bool ReconfigureServer::set(Event& event) {
  const Config before = values();
  for (const auto& wanted : event.getRequest().config.doubles) {
    const auto same = [&](const auto& other) { return other.name == wanted.name; };
    const auto known = std::find_if(parameters_.begin(), parameters_.end(), same);
    const auto now = std::find_if(before.doubles.begin(), before.doubles.end(), same);
    if (known == parameters_.end() || now->value == wanted.value) continue;
    try {
      control_.ask(
          {"node " + event.getCallerName(), known->what, core::formatNumber(wanted.value)});
    } catch (const core::InputError& error) {
      ROS_WARN("%s of %s: %s", wanted.name.c_str(), event.getCallerName().c_str(),
               core::plainText(error.what()).c_str());
    }
  }
  event.getResponse().config = values();
  update();
  return true;
}

}  // namespace cdiff::node_graph
