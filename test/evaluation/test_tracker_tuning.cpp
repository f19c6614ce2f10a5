// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "evaluation/tracking/tracker_tuning.h"

namespace cdiff::evaluation {
namespace {

using planning::PlanTrackerOptions;

/// 105 m along +x; from 5 m on, standing or at 8 m/s.
Track straightTrack(double start_speed) {
  Track track;
  track.kind = "straight";
  track.line = geometry::Polyline({{0.0, 0.0, 0.0}, {105.0, 0.0, 0.0}});
  track.start.position = {5.0, 0.3};
  track.start.speed = start_speed;
  return track;
}

core::RandomStream plans() { return {3, "tracker plans"}; }

TEST(Track, SpeedsUpHoldsAndStops) {
  // Stop at 100 m. 1 m/s^2: sqrt(2 x 1 x 8) = 4 m/s after 8 m; 8 m/s from 32 m on; 2 m/s^2: 16 m
  // before the stop it is 8 m/s, 4 m before it 4 m/s.
  const Track track = straightTrack(0.0);
  EXPECT_DOUBLE_EQ(track.speedAt(13.0), 4.0);
  EXPECT_DOUBLE_EQ(track.speedAt(60.0), 8.0);
  EXPECT_DOUBLE_EQ(track.speedAt(96.0), 4.0);
  EXPECT_DOUBLE_EQ(track.speedAt(101.0), 0.0);
  EXPECT_DOUBLE_EQ(track.speedAt(5.0), std::sqrt(2.0 * 0.02));  // so that it starts at all
  EXPECT_DOUBLE_EQ(straightTrack(8.0).speedAt(5.0), 8.0);
  EXPECT_DOUBLE_EQ(track.duration(), 95.0 / 8.0 + 8.0 + 4.0);
}

TEST(Track, APlanLeadsAlongTheLineFromWhereTheVehicleIs) {
  const Track track = straightTrack(8.0);
  traffic::VehicleState state = track.start;
  state.position = {20.0, 1.0};
  const Eigen::MatrixX2d plan = planOn(track, state, 20.0, plans(), 7);
  ASSERT_EQ(plan.rows(), 80);
  for (Eigen::Index row = 0; row < 40; ++row) {
    const double time = 0.1 * static_cast<double>(row + 1);
    EXPECT_NEAR(plan(row, 0), 8.0 * time, 1e-9);
    // Six deviations of e0 + e1 t: 0.3 + 0.6 t.
    EXPECT_NEAR(plan(row, 1), -1.0, 0.3 + 0.6 * time);
  }
  // Beside the line by a straight line.
  EXPECT_NEAR(plan(2, 1) - plan(1, 1), plan(1, 1) - plan(0, 1), 1e-9);
  EXPECT_NE(plan(1, 1), plan(0, 1));
}

TEST(DrawnTracks, AreThoseOfTheirSeedAndOfEveryKind) {
  const TuningTracks one(TuningOptions{5, 3});
  const TuningTracks same(TuningOptions{5, 3});
  ASSERT_EQ(one.tuning.size(), 3 * trackKinds().size());
  for (const std::string& kind : trackKinds()) EXPECT_EQ(ofKind(one.tuning, kind).size(), 3U);
  for (std::size_t i = 0; i < one.tuning.size(); ++i) {
    EXPECT_EQ(one.tuning[i].line.points(), same.tuning[i].line.points());
    EXPECT_NE(one.tuning[i].line.points(), one.held_out[i].line.points());
  }
}

TEST(Drive, MeasuresAVehicleThatDoesNotMove) {
  // It stands 0.3 m beside the line, at 0 m/s where sqrt(2 x 1 x 0.02) = 0.2 m/s are asked for.
  const NamedTracker stands{"stands", [] {
                              return [](double, const Eigen::MatrixX2d&) {
                                return traffic::ControlAction::failSafe();
                              };
                            }};
  const TrackingMeasures measures =
      drive({straightTrack(0.0)}, stands, dynamics::BicycleModel(), plans());
  EXPECT_NEAR(measures.lateral, 0.3, 1e-12);
  EXPECT_NEAR(measures.largest_lateral, 0.3, 1e-12);
  EXPECT_EQ(measures.off_road_percent, 0.0);
  EXPECT_EQ(measures.steer_change, 0.0);
  EXPECT_NEAR(measures.speed_error, 0.2, 1e-12);
  EXPECT_EQ(measures.unfinished_percent, 100.0);
  EXPECT_NEAR(measures.cost(), 0.3 + 0.1 * 0.2 + 0.1 * 100.0, 1e-12);
  EXPECT_EQ(measures.decisions, 477U);  // twice 11.875 + 12 s
}

TEST(Drive, CountsDecisionsWithACornerOffTheLane) {
  // 0.9 m beside the line a box of 1.8 m reaches to 1.8 m, beyond 1.75 m.
  Track track = straightTrack(0.0);
  track.start.position.y() = 0.9;
  const NamedTracker stands{"stands", [] {
                              return [](double, const Eigen::MatrixX2d&) {
                                return traffic::ControlAction::failSafe();
                              };
                            }};
  const dynamics::BicycleModel model;
  EXPECT_EQ(drive({track}, stands, model, plans()).off_road_percent, 100.0);
  track.start.position.y() = 0.84;
  EXPECT_EQ(drive({track}, stands, model, plans()).off_road_percent, 0.0);
}

// On tracks that nothing was tuned on.
TEST(TunedTracker, ErrsLessThanThePublishedOnLeftOutTracks) {
  const dynamics::BicycleModel model;
  for (const std::int64_t seed : {101, 102}) {
    const TuningTracks tracks(TuningOptions{seed, 6});
    const auto measured = [&](const PlanTrackerOptions& options) {
      return drive(tracks.held_out, planTracker("", options), model, tracks.random);
    };
    const TrackingMeasures tuned = measured({});
    const TrackingMeasures published = measured(PlanTrackerOptions::published());
    EXPECT_LT(tuned.lateral, 0.75 * published.lateral) << seed;
    EXPECT_LT(tuned.off_road_percent, 0.5 * published.off_road_percent) << seed;
    EXPECT_LT(tuned.cost(), published.cost()) << seed;
    EXPECT_EQ(tuned.unfinished_percent, 0.0) << seed;
  }
}

TEST(TunedTracker, IsWhatTheCommandFinds) {
  PlanTrackerOptions found = tuneTracker(TuningTracks({}), dynamics::BicycleModel());
  found.tracker = planning::kTunedTracker;
  EXPECT_EQ(core::dumpOptions(found), core::dumpOptions(PlanTrackerOptions()));
}

TEST(TuningTable, HasALinePerTrackerAndSet) {
  const TuningTracks tracks(TuningOptions{1, 1});
  const auto rows = {evaluateTracker(pdmLiteTracker(), tracks, dynamics::BicycleModel())};
  const std::string table = tuningTable(rows);
  EXPECT_NE(table.find("\n| pdm_lite | tuning | "), std::string::npos) << table;
  EXPECT_NE(table.find("\n| pdm_lite | held out | "), std::string::npos) << table;
  const std::string csv = tuningCsv(rows);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 + 5);
  EXPECT_NE(csv.find("\npdm_lite,held_out,roundabout,"), std::string::npos) << csv;
}

}  // namespace
}  // namespace cdiff::evaluation
