// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <sched.h>

#include <cerrno>
#include <cmath>
#include <iostream>
#include <map>
#include <system_error>

#include "benchmark.h"
#include "decision_scene.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "planners/rift/rift_evaluator.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::benchmark {
namespace {

constexpr std::size_t kTraffic = 60;  // vehicles around
constexpr int kCbv = 3;               // that is planned; the first one is at PPO's goal
constexpr int kWarmUp = 20;           // decisions until the histories of vehicles are full
constexpr int kDecisions = 120;
constexpr int kEvaluations = 200;       // of a state's candidates
constexpr std::size_t kEvaluated = 20;  // vehicles that candidates may hit
constexpr std::size_t kLines = 3;       // of 12 candidates each

/// What the median decision may take [ms].
std::string latencyGoal(const std::string& planner) {
  static const std::map<std::string, std::string> goals = {
      {"diffusion", "<=50"}, {"pdm_lite", "<=0.3"}, {"plant", "<=2"},       {"pluto", "<=8"},
      {"ppo", "<=0.05"},     {"rift", "<=8"},       {"uniad_mini", "<=60"}, {"vad_mini", "<=60"}};
  const auto found = goals.find(planner);
  return found == goals.end() ? "" : found->second;
}

/// Keeps this thread, and those that it starts, on the core that it is on.
class OneCore {
 public:
  OneCore() {
    check(::sched_getaffinity(0, sizeof before_, &before_));
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
    check(::sched_setaffinity(0, sizeof one, &one));
  }
  ~OneCore() { ::sched_setaffinity(0, sizeof before_, &before_); }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;

 private:
  static void check(int result) {
    if (result == 0) return;
    throw std::system_error(errno, std::generic_category(), "cannot stay on one core");
  }
  cpu_set_t before_ = {};
};

/// Of one CBV, or of the ego where the planner drives egos alone, from what it is given to its
/// action; processor time [ms], ascending.
std::vector<double> decisionTimes(const planning::PlannerDescriptor& descriptor) {
  const bool cbv = descriptor.drives_cbv;
  const std::string& planner_name = descriptor.name;
  DecisionScene scene(cbv ? planner_name : "", kTraffic, cbv ? "" : planner_name);
  const auto planner = cbv ? scene.setup().makeCbvPlanner() : scene.setup().makeEgoPlanner();
  std::vector<double> times;
  for (int i = 0; i < kWarmUp + kDecisions; ++i) {
    scene.advance(descriptor.sees());
    const auto tasks = cbv ? scene.tasks(kCbv, 1) : scene.egoTask();
    std::string fault;
    const double seconds =
        cpuSecondsOf([&] { fault = planner->plan(scene.snapshot(), tasks).front().fault; });
    if (!fault.empty()) throw core::Error("planner '" + planner_name + "': " + fault);
    if (i >= kWarmUp) times.push_back(1e3 * seconds);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// How dense the scene is around the planned CBV.
double vehiclesNear() {
  constexpr double kNear = 50.0;  // [m]
  const DecisionScene scene("", kTraffic);
  const auto& vehicles = scene.snapshot().vehicles;
  const Eigen::Vector2d own = vehicles[kCbv + 1].state.position;
  const auto near = [&](const traffic::Vehicle& vehicle) {
    return (vehicle.state.position - own).norm() <= kNear;
  };
  return static_cast<double>(std::count_if(vehicles.begin(), vehicles.end(), near) - 1);
}

void addDecisions(Figures& figures) {
  for (const planning::PlannerDescriptor* planner : planners::registeredPlanners()) {
    try {
      const std::vector<double> times = decisionTimes(*planner);
      const std::string name = "latency_" + planner->name;
      figures.push_back({name + "_p50", median(times), "ms", latencyGoal(planner->name)});
      figures.push_back({name + "_p95", times[times.size() * 95 / 100], "ms", ""});
    } catch (const core::InputError& error) {
      std::cerr << "benchmark: planner '" << planner->name << "' is left out: " << error.what()
                << "\n";
    }
  }
}

/// Along a line at a speed of its own, a little to its side.
planners::PlutoTrajectory candidateOf(std::size_t line, std::size_t mode) {
  planners::PlutoTrajectory candidate;
  const double speed = 1.0 + static_cast<double>(mode);
  const double bend = 0.01 * (static_cast<double>(line) - 1.0);
  for (Eigen::Index i = 0; i < candidate.rows(); ++i) {
    const double x = 0.1 * speed * static_cast<double>(i + 1);
    const double turn = bend * x;
    candidate.row(i) << static_cast<float>(x), static_cast<float>(0.5 * turn * x),
        static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)),
        static_cast<float>(speed), 0.0F;
  }
  return candidate;
}

std::vector<const traffic::Vehicle*> nearestTo(const traffic::Vehicle& own,
                                               const DecisionScene& scene) {
  std::vector<const traffic::Vehicle*> others;
  for (const traffic::Vehicle& vehicle : scene.snapshot().vehicles) {
    if (vehicle.id != own.id) others.push_back(&vehicle);
  }
  const auto distance = [&](const traffic::Vehicle* vehicle) {
    return (vehicle->state.position - own.state.position).norm();
  };
  std::sort(others.begin(), others.end(),
            [&](const auto* a, const auto* b) { return distance(a) < distance(b); });
  others.resize(kEvaluated);
  return others;
}

std::vector<planners::RiftNeighbor> neighborsOf(const std::vector<const traffic::Vehicle*>& others,
                                                const session::SessionSetup& setup) {
  std::vector<planners::RiftNeighbor> neighbors;
  for (const traffic::Vehicle* other : others) {
    neighbors.push_back({planning::forecastMotion(*other, setup.network(), setup.options().vehicle,
                                                  planners::kRiftSteps),
                         other->dimensions});
  }
  return neighbors;
}

planners::RiftState stateOf(const traffic::Vehicle& own, const session::SessionSetup& setup) {
  const map::Route& route = setup.egoRoute();
  planners::RiftState state;
  state.pose = own.state.pose();
  state.speed = own.state.speed;
  state.lines = planners::referenceLines(setup.network(), route,
                                         route.path().project(own.state.position).arc_length,
                                         own.state, kLines);
  return state;
}

/// What RIFT's training simulates of a state: forecasts of the nearest vehicles, then 36 candidates
/// of 40 steps.
void addEvaluations(Figures& figures) {
  const DecisionScene scene("", kTraffic);
  const traffic::Vehicle& own = scene.snapshot().vehicles[kCbv + 1];
  const std::vector<const traffic::Vehicle*> others = nearestTo(own, scene);
  std::vector<planners::PlutoTrajectory> candidates;
  for (std::size_t i = 0; i < kLines * planners::kPlutoModes; ++i)
    candidates.push_back(candidateOf(i / planners::kPlutoModes, i % planners::kPlutoModes));
  planners::RiftState state = stateOf(own, scene.setup());
  const planners::RiftEvaluator evaluator(scene.setup().options().vehicle);
  planners::DrivableMask mask(scene.setup().drivableArea());
  std::vector<double> forecasts;
  std::vector<double> simulations;
  double sum = 0.0;
  for (int i = 0; i <= kEvaluations; ++i) {
    const double forecast =
        cpuSecondsOf([&] { state.neighbors = neighborsOf(others, scene.setup()); });
    const double simulation = cpuSecondsOf([&] {
      for (const double value : evaluator.returnsOf(state, candidates, mask)) sum += value;
    });
    if (i == 0) continue;  // makes the tiles of the mask
    forecasts.push_back(1e3 * forecast);
    simulations.push_back(1e3 * simulation);
  }
  if (!std::isfinite(sum)) throw core::Error("RIFT's evaluator gives returns that are not finite");
  figures.push_back({"rift_evaluator_36x40_p50", median(simulations), "ms", "<=0.3"});
  figures.push_back({"rift_forecasts_20_p50", median(forecasts), "ms", ""});
}

}  // namespace

void benchmarkLatency(Figures& figures) {
  const OneCore one_core;
  figures.push_back({"latency_vehicles_within_50_m", vehiclesNear(), "", ""});
  addDecisions(figures);
  addEvaluations(figures);
}

}  // namespace cdiff::benchmark
