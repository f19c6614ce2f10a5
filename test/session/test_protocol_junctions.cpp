// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Red lights and stop signs as a session counts them in SUMO's networks; the lights against those
/// read along the ego route.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "metrics/session_metrics.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planners/registry.h"
#include "session/world.h"
#include "support/sumo_network.h"

namespace cdiff::session {
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

/// An ego that sees no light drives its route.
struct BlindDrive {
  explicit BlindDrive(const ScenarioOptions& options) : setup(options), passed(setup.egoRoute()) {
    metrics::SessionMetrics metrics(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute());
    const auto planner = setup.makeEgoPlanner();
    World world(setup);
    while (world.snapshot().status == traffic::SessionStatus::kRunning) {
      traffic::TrafficSnapshot snapshot = world.snapshot();
      passed.observe(snapshot);
      metrics.observe(snapshot, nullptr);
      snapshot.signals.clear();
      const std::vector<planning::PlanningTask> tasks = {
          {-1, snapshot.ego(), &setup.egoRoute(), 8.0}};
      world.advance(nullptr, snapshot.decision_tick ? planner->plan(snapshot, tasks)
                                                    : std::vector<planning::PlannedAction>());
    }
    metrics.observe(world.snapshot(), nullptr);
    measures = metrics.measures();
  }
  SessionSetup setup;
  PassedLights passed;
  metrics::SessionMeasures measures;
};

/// The main street's light with the network's program from a time on.
ScenarioOptions litScenario(double begin_time) {
  ScenarioOptions options = loadScenario("crossing_straight");
  options.demand = "none";
  options.lights = "program";
  options.begin_time = begin_time;
  return options;
}

TEST(ProtocolLights, CountsTheRedOnesThatAnEgoWithoutEyesRuns) {
  std::string all;
  for (const double begin_time : {0.0, 20.0, 40.0}) {
    const BlindDrive drive(litScenario(begin_time));
    const std::string& letters = drive.passed.letters;
    const auto red = std::count(letters.begin(), letters.end(), 'r');
    const metrics::Measure counted = drive.measures.at("ego_infraction_red_lights");
    EXPECT_EQ(*counted.value, static_cast<double>(red)) << letters;
    EXPECT_EQ(counted.n, letters.size());
    EXPECT_EQ(*drive.measures.at("ego_completion_percent").value, 100.0);
    EXPECT_NEAR(*drive.measures.at("ego_driving_score").value, 100.0 * std::pow(0.7, red), 1e-9);
    all += letters;
  }
  EXPECT_NE(all.find('r'), std::string::npos) << "the test needs a red light, saw " << all;
  EXPECT_NE(all.find_first_of("gG"), std::string::npos) << "and a green one, saw " << all;
}

/// Over a junction of a type from the south, the road with less priority, or from the west.
metrics::Measure stopSigns(const std::string& type, const std::string& from, bool obeyed) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeSumoNetwork(
      folder,
      "<node id=\"w\" x=\"-100\" y=\"0\"/><node id=\"e\" x=\"100\" y=\"0\"/><node id=\"s\" x=\"0\" "
      "y=\"-100\"/><node id=\"n\" x=\"0\" y=\"100\"/><node id=\"c\" x=\"0\" y=\"0\" type=\"" +
          type + "\"/>",
      "<edge id=\"west\" from=\"w\" to=\"c\" priority=\"5\"/><edge id=\"east\" from=\"c\" to=\"e\" "
      "priority=\"5\"/><edge id=\"south\" from=\"s\" to=\"c\" priority=\"1\"/><edge id=\"north\" "
      "from=\"c\" to=\"n\" priority=\"1\"/>");
  ScenarioOptions options;
  options.cbv_planner = "pdm_lite";
  options.network = made.file.string();
  options.demand = "none";
  options.route.edges = {from, from == "south" ? "north" : "east"};
  options.route.start_offset = 20.0;
  options.route.start_speed = 5.0;
  options.max_cbv = 0;
  options.planner_options.of<planners::PdmLiteOptions>().obey_stop_signs = obeyed;
  const BlindDrive drive(options);
  EXPECT_EQ(*drive.measures.at("ego_completion_percent").value, 100.0) << type << " from " << from;
  return drive.measures.at("ego_infraction_stop_signs");
}

TEST(ProtocolStopSigns, AreThoseOfStopJunctions) {
  for (const auto& [type, from, signs] :
       {std::tuple("priority_stop", "south", 1U), std::tuple("priority_stop", "west", 0U),
        std::tuple("allway_stop", "south", 1U), std::tuple("allway_stop", "west", 1U),
        std::tuple("priority", "south", 0U)}) {
    const metrics::Measure found = stopSigns(type, from, false);
    EXPECT_EQ(*found.value, signs) << type << " from " << from;
    EXPECT_EQ(found.n, signs) << type << " from " << from;
    const metrics::Measure obeyed = stopSigns(type, from, true);
    EXPECT_EQ(*obeyed.value, 0.0) << type << " from " << from;
    EXPECT_EQ(obeyed.n, signs) << type << " from " << from;
  }
}

}  // namespace
}  // namespace cdiff::session
