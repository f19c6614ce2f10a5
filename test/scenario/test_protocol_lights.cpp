// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Red lights as a session counts them, against SUMO's lights read along the ego route.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/metrics/session_metrics.h"
#include "e2e_cdiff/planning/planner_factory.h"
#include "e2e_cdiff/scenario/world.h"

namespace cdiff::scenario {
namespace {

/// Letters that the lights of the route showed when the ego's tail passed them.
class PassedLights {
 public:
  explicit PassedLights(const map::Route& route) : route_(route) {}
  void observe(const traffic::TrafficSnapshot& snapshot) {
    const traffic::Vehicle& ego = *snapshot.ego();
    const double tail =
        route_.path().project(ego.state.position).arc_length - 0.8 * 0.5 * ego.dimensions.length;
    for (const map::Route::Signal& signal : route_.signals()) {
      if (tail_ >= signal.arc_length || tail < signal.arc_length) continue;
      for (const traffic::SignalState& light : snapshot.signals) {
        if (light.id == signal.id) letters += light.state[static_cast<std::size_t>(signal.link)];
      }
    }
    tail_ = tail;
  }
  std::string letters;

 private:
  const map::Route& route_;
  double tail_ = -1e9;
};

/// The main street's light with the network's program from a time on; the ego sees no light.
struct BlindDrive {
  explicit BlindDrive(double begin_time) : setup(options(begin_time)), passed(setup.egoRoute()) {
    metrics::SessionMetrics metrics(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute());
    const auto planner = planning::makePlanner("pdm_lite", {}, setup.planningContext());
    World world(setup);
    while (world.snapshot().status == traffic::SessionStatus::kRunning) {
      traffic::TrafficSnapshot snapshot = world.snapshot();
      passed.observe(snapshot);
      metrics.observe(snapshot, nullptr);
      snapshot.signals.clear();
      const std::vector<planning::PlanningTask> tasks = {
          {-1, snapshot.ego(), &setup.egoRoute(), 8.0, nullptr}};
      world.advance(nullptr, snapshot.decision_tick ? planner->plan(snapshot, tasks)
                                                    : std::vector<planning::PlannedAction>());
    }
    metrics.observe(world.snapshot(), nullptr);
    measures = metrics.measures();
  }
  static ScenarioOptions options(double begin_time) {
    ScenarioOptions options = loadScenario("crossing_straight");
    options.demand = "none";
    options.lights = "program";
    options.begin_time = begin_time;
    return options;
  }
  SessionSetup setup;
  PassedLights passed;
  metrics::SessionMeasures measures;
};

TEST(ProtocolLights, CountsTheRedOnesThatAnEgoWithoutEyesRuns) {
  std::string all;
  for (const double begin_time : {0.0, 20.0, 40.0}) {
    const BlindDrive drive(begin_time);
    const std::string& letters = drive.passed.letters;
    const auto red = std::count(letters.begin(), letters.end(), 'r');
    const metrics::Measure& counted = drive.measures.infractions.at("red_lights");
    EXPECT_EQ(*counted.value, static_cast<double>(red)) << letters;
    EXPECT_EQ(counted.n, letters.size());
    EXPECT_EQ(drive.measures.route_completion_percent, 100.0);
    EXPECT_NEAR(drive.measures.driving_score, 100.0 * std::pow(0.7, red), 1e-9);
    all += letters;
  }
  EXPECT_NE(all.find('r'), std::string::npos) << "the test needs a red light, saw " << all;
  EXPECT_NE(all.find_first_of("gG"), std::string::npos) << "and a green one, saw " << all;
}

}  // namespace
}  // namespace cdiff::scenario
