// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <vector>

#include "benchmark.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/planning/challenge.h"

namespace cdiff::benchmark {
namespace {

/// A vehicle that crosses the ego's way at `x` from the right within its plan.
planning::ChallengePlan crossingPlan(const traffic::Vehicle& cbv, double x) {
  planning::ChallengePlan plan;
  traffic::VehicleState state = cbv.state;
  for (int row = 0; row < 32; ++row) {
    const Eigen::Vector2d aim(x + 0.02 * row, state.position.y() + 1.0);
    state.position += 0.1 * state.speed * (aim - state.position).normalized();
    plan.states.push_back(state);
  }
  return plan;
}

}  // namespace

/// The choice among eight plans that all hit, on a straight road.
void benchmarkChallenge(Figures& figures) {
  const map::RoadNetwork network = map::RoadNetwork::fromText(
      R"(<net><edge id="road"><lane id="road_0" index="0" speed="13.9" shape="0,0 400,0"/></edge></net>)",
      "road");
  const map::DrivableArea area(network);
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x <= 400; ++x) points.push_back({1.0 * x, 0.0, 0.0});
  const map::Route route(network, points, std::vector<map::LaneIndex>(points.size(), 0));
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles.resize(2);
  traffic::Vehicle& ego = snapshot.vehicles[0];
  ego.id = traffic::kEgoId;
  ego.role = traffic::VehicleRole::kEgo;
  ego.state.position = {100.0, 0.0};
  ego.state.speed = 8.0;
  traffic::Vehicle& cbv = snapshot.vehicles[1];
  cbv.id = "cbv";
  cbv.role = traffic::VehicleRole::kCbv;
  cbv.state.position = {123.0, -28.0};
  cbv.state.heading = 0.5 * core::kPi;
  cbv.state.speed = 10.0;
  std::vector<planning::ChallengePlan> plans;
  for (int i = 0; i < 8; ++i) plans.push_back(crossingPlan(cbv, 121.0 + 0.3 * i));
  std::vector<double> rounds;
  for (int round = 0; round < 201; ++round) {
    planning::Challenge challenge({network, area, 1, 0.05, 0.1, &route}, "medium");
    rounds.push_back(1e3 * cpuSecondsOf([&] {
                       challenge.startDecision(snapshot);
                       challenge.choose(cbv, plans);
                     }));
  }
  figures.push_back({"challenge_choice_of_8", median(rounds), "ms", "<=1"});
}

}  // namespace cdiff::benchmark
