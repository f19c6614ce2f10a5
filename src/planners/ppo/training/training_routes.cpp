// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/training_routes.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::planners {
namespace {

namespace fs = std::filesystem;
using core::InputError;

// RIFT's rule for CBVs in training, where it differs from evaluation.
constexpr double kTrainingDistanceGate = 60.0;  // [m]
constexpr double kTrainingRouteLength = 320.0;  // [m] 80 points, 4 m apart

constexpr double kTrainingWarmUp = 10.0;  // [s]

/// The networks whose draw lies below the share; at least one and not all.
std::set<std::string> drawNetworks(const std::set<std::string>& networks, double share) {
  const core::RandomStream stream(0, "ppo held-out networks");
  std::vector<std::pair<double, std::string>> drawn;
  for (const std::string& name : networks)
    drawn.emplace_back(stream.uniform({core::hashText(name)}, 0), name);
  std::sort(drawn.begin(), drawn.end());
  std::set<std::string> held_out;
  for (std::size_t i = 0; i + 1 < drawn.size(); ++i) {
    if (i == 0 || drawn[i].first < share) held_out.insert(drawn[i].second);
  }
  return held_out;
}

}  // namespace

PpoRoutes::PpoRoutes(const std::string& suite, double held_out_share, std::int64_t cbvs)
    : suite_(suite::loadSuite(suite)) {
  suite::requireForTraining(suite_);
  divide(held_out_share);
  hash();
  for (const suite::SuiteRoute& route : suite_.routes)
    scenarios_.push_back(scenarioOf(route, cbvs));
}

void PpoRoutes::divide(double held_out_share) {
  std::set<std::string> networks;
  for (const suite::SuiteRoute& route : suite_.routes) networks.insert(route.network);
  networks_ = networks.size();
  if (held_out_share > 0.0 && networks_ < 2) {
    throw InputError("suite '" + suite_.name +
                     "' has one network; to hold one out it needs two: take a larger suite, or "
                     "validation_share 0");
  }
  std::set<std::string> held_out;
  if (held_out_share > 0.0) held_out = drawNetworks(networks, held_out_share);
  held_out_networks_ = held_out.size();
  for (std::size_t i = 0; i < suite_.routes.size(); ++i)
    (held_out.count(suite_.routes[i].network) != 0 ? held_out_ : training_).push_back(i);
  if (held_out.empty()) held_out_ = training_;
}

void PpoRoutes::hash() {
  core::Sha256 digest;
  digest.update(suite::manifestText(suite_));
  std::set<fs::path> files;
  for (const suite::SuiteRoute& route : suite_.routes) files.insert(suite_.networkFile(route));
  for (const fs::path& file : files) digest.update(core::readFile(file, "network"));
  sha256_ = digest.finish();
}

session::ScenarioOptions PpoRoutes::scenarioOf(const suite::SuiteRoute& route,
                                               std::int64_t cbvs) const {
  session::ScenarioOptions scenario = session::loadScenario(suite_.scenarioFile(route).string());
  scenario.ego_planner = planners::kDefaultEgoPlanner;
  scenario.cbv_planner = planners::kDefaultEgoPlanner;  // its place is taken by the one that learns
  scenario.max_cbv = cbvs;
  scenario.cbv.route_distance_gate = kTrainingDistanceGate;
  scenario.cbv.ego_route_length = kTrainingRouteLength;
  scenario.lights = "green";
  scenario.demand = "generated";
  scenario.traffic.warm_up = std::min(scenario.traffic.warm_up, kTrainingWarmUp);
  scenario.validate();
  return scenario;
}

std::unique_ptr<session::SessionSetup> PpoRoutes::setup(std::size_t route,
                                                        std::int64_t seed) const {
  session::ScenarioOptions scenario = scenarios_.at(route);
  scenario.seed = seed;
  return std::make_unique<session::SessionSetup>(scenario);
}

}  // namespace cdiff::planners
