// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What the writer exports, read by our own importer and played without a simulator.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "exchange/openscenario_writer.h"
#include "exchange/recorded_session.h"
#include "record/result_folder.h"
#include "storyboard/scenario_reader.h"
#include "storyboard/traffic_stage.h"

namespace cdiff::exchange {
namespace {

constexpr double kStep = 0.05;          // [s]
constexpr double kMostDistance = 0.05;  // [m]

class Reimport : public testing::Test {
 protected:
  storyboard::Scenario exported() const {
    const std::string file = session_.path("again.xosc").string();
    core::writeFileAtomically(file, openScenarioText(readScene(session_.folder(), {0.0, {}, "all"}),
                                                     "crossing.net.xml", ExportedEgo::kTrajectory));
    return storyboard::readScenario(file, false);
  }
  test::RecordedSession session_;
};

TEST_F(Reimport, EveryVehicleIsWhereTheTraceHasIt) {
  const storyboard::Scenario scenario = exported();
  const auto network =
      map::RoadNetwork::fromText(core::readFile(scenario.network, "network"), "crossing");
  const map::LaneGraph graph(network);
  const storyboard::Places places(graph, std::nullopt);
  storyboard::TrafficStage stage(scenario, places, {});
  storyboard::Storyboard board(scenario, stage);
  std::map<std::uint64_t, std::vector<record::TraceRow>> rows;
  for (const record::TraceRow& row : record::readTrace(session_.folder() / "trace.csv"))
    rows[row.tick].push_back(row);
  stage.begin();
  std::size_t compared = 0;
  std::set<std::string> seen;
  for (std::uint64_t tick = 0; tick <= test::RecordedSession::kLastTick; ++tick) {
    for (const record::TraceRow& row : rows[tick]) {
      // An entity that is added appears with the step after its trigger, 0.05 s later.
      if (tick > 0 && seen.insert(row.id).second) continue;
      seen.insert(row.id);
      ASSERT_TRUE(stage.present(row.id)) << row.id << " at " << tick;
      const traffic::VehicleState state = stage.actor(row.id).state();
      EXPECT_LT((state.position - row.position).norm(), kMostDistance) << row.id << " " << tick;
      EXPECT_LT(std::abs(core::angleDifference(state.heading, row.heading)), 0.01) << row.id;
      ++compared;
    }
    const double time = static_cast<double>(tick) * kStep;
    board.update(time);
    EXPECT_EQ(board.over(), tick == test::RecordedSession::kLastTick);
    stage.advance(time + kStep, kStep);
  }
  EXPECT_GT(compared, 200U);  // the ego alone has 101 rows
}

}  // namespace
}  // namespace cdiff::exchange
