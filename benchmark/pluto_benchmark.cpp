// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "benchmark.h"
#include "e2e_cdiff/core/random.h"
#include "planners/pluto/pluto.h"
#include "planners/rift/rift_evaluator.h"
#include "planning/surrounding_vehicles.h"
#include "session/session_request.h"
#include "session/session_setup.h"

namespace cdiff::benchmark {
namespace {

constexpr int kVehicles = 24;      // near the planned one
constexpr int kDecisions = 120;    // of the planner
constexpr int kEvaluations = 200;  // of a state's candidates
constexpr int kEvaluated = 20;     // vehicles that candidates may hit
constexpr std::size_t kLines = 3;  // of 12 candidates each

/// What takes as long as trained weights do.
planners::PlutoModel randomWeights() {
  const core::RandomStream random(1, "benchmark weights");
  planners::PlutoModel model;
  for (const inference::TensorShape& shape : planners::plutoTensors(model.architecture)) {
    inference::Tensor tensor{shape.shape, {}};
    std::size_t count = 1;
    for (const std::int64_t size : shape.shape) count *= static_cast<std::size_t>(size);
    const double scale =
        std::sqrt(static_cast<double>(shape.shape[0]) / static_cast<double>(count));
    for (std::size_t i = 0; i < count; ++i) {
      const core::RandomKey key{core::hashText(shape.name), 0, 0};
      tensor.values.push_back(
          static_cast<float>(scale * random.normal(key, static_cast<std::uint32_t>(i))));
    }
    model.weights.emplace(shape.name, std::move(tensor));
  }
  return model;
}

/// A CBV among others on the ego route of a shipped scenario.
class Crowd {
 public:
  Crowd() : setup_(session::resolveRequest(request())) {
    for (int i = 0; i <= kVehicles; ++i) {
      traffic::Vehicle vehicle;
      const double s = 30.0 + 3.0 * i;
      const double heading = setup_.egoRoute().path().headingAt(s);
      vehicle.id = "vehicle " + std::to_string(i);
      vehicle.state.position =
          setup_.egoRoute().path().positionAt(s) +
          (i % 2 == 0 ? 3.5 : -3.5) * geometry::leftNormal(geometry::direction(heading));
      vehicle.state.heading = heading;
      vehicle.state.speed = 5.0;
      snapshot_.vehicles.push_back(vehicle);
    }
    snapshot_.vehicles[0].state.position = setup_.egoRoute().path().positionAt(30.0);
  }
  void advance() {
    snapshot_.tick += 2;
    snapshot_.time += 0.1;
    for (traffic::Vehicle& vehicle : snapshot_.vehicles)
      vehicle.state.position += 0.01 * vehicle.state.velocity();
  }
  std::vector<planning::PlanningTask> task() const {
    return {{0, &snapshot_.vehicles[0], &setup_.egoRoute(), 8.0}};
  }
  const session::SessionSetup& setup() const { return setup_; }
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }

 private:
  static session::SessionRequest request() {
    session::SessionRequest request;
    request.scenario = "crossing_straight";
    return request;
  }
  session::SessionSetup setup_;
  traffic::TrafficSnapshot snapshot_;
};

void addDecisions(Figures& figures, Crowd& crowd) {
  planners::PlutoPlanner planner({}, randomWeights(), crowd.setup().network(), 0.1);
  std::vector<double> times;
  for (int i = 0; i < kDecisions; ++i) {
    crowd.advance();
    const double seconds = secondsOf([&] { planner.plan(crowd.snapshot(), crowd.task()); });
    if (i > 20) times.push_back(1e3 * seconds);
  }
  std::sort(times.begin(), times.end());
  figures.push_back({"pluto_decision_p50", median(times), "ms", "<=8"});
  figures.push_back({"pluto_decision_p95", times[times.size() * 95 / 100], "ms", ""});
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

void addEvaluations(Figures& figures, const Crowd& crowd) {
  const traffic::Vehicle& own = crowd.snapshot().vehicles.front();
  std::vector<planners::PlutoTrajectory> candidates;
  for (std::size_t i = 0; i < kLines * planners::kPlutoModes; ++i)
    candidates.push_back(candidateOf(i / planners::kPlutoModes, i % planners::kPlutoModes));
  planners::RiftState state;
  state.pose = own.state.pose();
  state.speed = own.state.speed;
  state.lines = planners::referenceLines(crowd.setup().network(), crowd.setup().egoRoute(), 30.0,
                                         own.state, kLines);
  const dynamics::BicycleModelOptions& vehicle = crowd.setup().options().vehicle;
  std::vector<double> forecasts;
  for (int i = 0; i < kEvaluations; ++i) {
    state.neighbors.clear();
    forecasts.push_back(1e3 * cpuSecondsOf([&] {
                          for (std::size_t n = 1; n <= kEvaluated; ++n) {
                            const traffic::Vehicle& other = crowd.snapshot().vehicles[n];
                            state.neighbors.push_back(
                                {planning::forecastMotion(other, crowd.setup().network(), vehicle,
                                                          planners::kRiftSteps),
                                 other.dimensions});
                          }
                        }));
  }
  const planners::RiftEvaluator evaluator(vehicle);
  planners::DrivableMask mask(crowd.setup().drivableArea());
  std::vector<double> times;
  double sum = 0.0;
  for (int i = 0; i < kEvaluations; ++i) {
    const double seconds = cpuSecondsOf([&] {
      for (const double value : evaluator.returnsOf(state, candidates, mask)) sum += value;
    });
    if (i > 0) times.push_back(1e3 * seconds);  // the first makes the tiles of the mask
  }
  figures.push_back({"rift_evaluator_36x40_p50", sum == 0.0 ? 0.0 : median(times), "ms", "<=0.3"});
  figures.push_back({"rift_forecasts_20_p50", median(forecasts), "ms", ""});
}

}  // namespace

void benchmarkPluto(Figures& figures) {
  Crowd crowd;
  addDecisions(figures, crowd);
  addEvaluations(figures, crowd);
}

}  // namespace cdiff::benchmark
