// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"
#include "support/network_text.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;
using test::ego;
using test::snapshot;

class SessionMetricsTest : public ::testing::Test {
 protected:
  TickMeasures observe(std::uint64_t tick, const std::vector<traffic::Vehicle>& vehicles) {
    return metrics_.observe(snapshot(tick, vehicles), nullptr);
  }
  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(SessionMetricsTest, GivesReasonsForAnEmptySession) {
  const SessionMeasures measures = metrics_.measures();
  EXPECT_EQ(*measures.at("ego_completion_percent").value, 0.0);
  EXPECT_EQ(*measures.at("ego_driving_score").value, 0.0);
  for (const char* name : {"ego_off_road_percent",
                           "cbv_off_road_percent",
                           "cbv_collisions_per_km",
                           "ttc_mean_s",
                           "ttc_min_s",
                           "speed_shapiro_wilk",
                           "acceleration_shapiro_wilk",
                           "speed_wasserstein_mps",
                           "cbv_speed_error_mps",
                           "cbv_closest_distance_m",
                           "cbv_minimum_distance_m",
                           "cbv_corner_off_road_percent",
                           "cbv_uncomfortable_percent",
                           "cbv_ego_collisions_per_km",
                           "cbv_contacts_struck_background_per_km",
                           "cbv_edge_distance_mean_m",
                           "cbv_edge_distance_p5_m",
                           "cbv_standing_free",
                           "cbv_standing_free_percent",
                           "cbv_wrong_way_percent",
                           "ego_contacts_braking_avoids_per_km",
                           "ego_near_misses_per_km",
                           "ego_distance_m",
                           "ego_driving_score_under_attack",
                           "ttc_cbv_set_mean_s",
                           "ttc_following_percent",
                           "ttc_cbv_mean_s",
                           "ttc_lon_lat_mean_s",
                           "ttc_defined_percent",
                           "ttc_cbv_defined_percent",
                           "post_encroachment_mean_s",
                           "cbv_jerk_mean_mps3",
                           "speed_shapiro_wilk_p"}) {
    const Measure measure = measures.at(name);
    EXPECT_FALSE(measure.value.has_value());
    EXPECT_EQ(measure.n, 0U);
    EXPECT_FALSE(measure.reason.empty());
  }
  EXPECT_EQ(measures.at("speed_shapiro_wilk").reason, "no CBV was driven");
}

TEST_F(SessionMetricsTest, FollowsTheEgoAlongItsRoute) {
  for (std::uint64_t tick = 0; tick <= 5; ++tick) observe(tick, {ego(10.0 * tick, 0, 10)});
  EXPECT_NEAR(*metrics_.measures().at("ego_completion_percent").value, 50.0, 1e-9);
  EXPECT_NEAR(*metrics_.measures().at("ego_driving_score").value, 50.0, 1e-9);
  for (std::uint64_t tick = 6; tick <= 9; ++tick) observe(tick, {ego(10.0 * tick, 0, 10)});
  // 99.5 m of 100 m, 0.5 m from the end: complete by the protocol (99 %, 10 m).
  EXPECT_EQ(observe(10, {ego(99.5, 0, 10)}).route_completion_percent, 100.0);
  EXPECT_NEAR(*metrics_.measures().at("ego_driving_score").value, 100.0, 1e-9);
}

TEST_F(SessionMetricsTest, MeasuresTheEgosTimeOffTheRoad) {
  // The lane ends at y = 1.6: two of five ticks are off it.
  for (std::uint64_t i = 0; i < 3; ++i)
    EXPECT_FALSE(observe(i, {ego(10.0 * static_cast<double>(i), 0, 10)}).ego_off_road);
  EXPECT_TRUE(observe(3, {ego(30, 5, 10)}).ego_off_road);
  observe(4, {ego(40, 5, 10)});
  EXPECT_NEAR(*metrics_.measures().at("ego_off_road_percent").value, 40.0, 1e-9);
}

TEST_F(SessionMetricsTest, CountsACbvOnlyWhileItIsOne) {
  // Background at tick 0, CBV at ticks 1 to 4, background at 5. Decisions at 2 and 4. Off the road
  // at ticks 3 and 4 (y = 2). Chords between CBV ticks: 1 + hypot(1, 2) + 1.
  observe(0, {background("a", 50, 0, 1)});
  observe(1, {cbv("a", 51, 0, 2)});
  observe(2, {cbv("a", 52, 0, 3)});
  EXPECT_EQ(observe(3, {cbv("a", 53, 2, 4)}).cbv_off_road, 1U);
  observe(4, {cbv("a", 54, 2, 5)});
  EXPECT_EQ(observe(5, {background("a", 55, 2, 6)}).cbv_off_road, 0U);
  const SessionMeasures measures = metrics_.measures();
  EXPECT_EQ(*measures.at("cbv_count").value, 1U);
  EXPECT_EQ(*measures.at("cbv_decisions").value, 2U);
  EXPECT_NEAR(*measures.at("cbv_distance_m").value, 2.0 + std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(*measures.at("cbv_off_road_percent").value, 50.0, 1e-9);
  EXPECT_EQ(measures.at("cbv_off_road_percent").n, 4U);
  EXPECT_EQ(measures.at("speed_shapiro_wilk").reason, "n = 2, needs at least 3");
  // RIFT's rate knows decision ticks alone: off at one of two.
  EXPECT_NEAR(*measures.at("rift_compat_off_road_rate_percent").value, 50.0, 1e-9);
}

TEST_F(SessionMetricsTest, TakesTheNearestPassOfEveryCbv) {
  // While it is a CBV, a comes as near as hypot(3, 4) = 5 m (tick 1, between decisions), b as 20 m.
  // Nearer ticks at which a is background do not count.
  observe(0, {ego(0, 0, 5), cbv("a", 10, 0, 4), cbv("b", -30, 0, 4)});
  observe(1, {ego(0, 0, 5), cbv("a", 3, 4, 4), cbv("b", -20, 0, 4)});
  observe(2, {ego(0, 0, 5), background("a", 1, 0, 4), cbv("b", -25, 0, 4)});
  const SessionMeasures measures = metrics_.measures();
  EXPECT_NEAR(*measures.at("cbv_closest_distance_m").value, 12.5, 1e-12);
  EXPECT_EQ(measures.at("cbv_closest_distance_m").n, 2U);
  EXPECT_NEAR(*measures.at("cbv_minimum_distance_m").value, 5.0, 1e-12);
}

TEST_F(SessionMetricsTest, PassesOverACbvOnAnotherLevel) {
  auto below = cbv("a", 0, 0, 4);
  below.state.elevation = -5.0;
  observe(0, {ego(0, 0, 5), below});
  EXPECT_FALSE(metrics_.measures().at("cbv_minimum_distance_m").value.has_value());
  EXPECT_EQ(metrics_.measures().at("cbv_minimum_distance_m").reason, "the ego was never seen");
}

TEST_F(SessionMetricsTest, ComparesCbvSpeedsWithTheTarget) {
  // Target 8 m/s; decisions at ticks 0 and 2 see 5 and 10 m/s: (3 + 2) / 2.
  observe(0, {cbv("a", 50, 0, 5)});
  observe(1, {cbv("a", 51, 0, 100)});
  observe(2, {cbv("a", 52, 0, 10)});
  EXPECT_NEAR(*metrics_.measures().at("cbv_speed_error_mps").value, 2.5, 1e-12);
  EXPECT_EQ(metrics_.measures().at("cbv_speed_error_mps").n, 2U);
}

TEST(SpeedError, CapsTheTargetByTheLanesLimit) {
  // Target 20 m/s on a lane of 13.89 m/s: known by the lane's id at tick 0, by the place (1 m off
  // the centerline) at tick 2; 40 m off the road at tick 4 only the target is left.
  const test::StraightRoad road;
  SessionMetricsOptions options;
  options.target_speed = 20.0;
  options.network = &road.network;
  SessionMetrics metrics(options, road.drivable_area, road.route);
  auto on_lane = cbv("a", 50, 0, 13.89 + 1.0);
  on_lane.lane_id = "road_0";
  metrics.observe(snapshot(0, {on_lane}), nullptr);
  metrics.observe(snapshot(2, {cbv("a", 51, 1, 13.89 + 2.0)}), nullptr);
  EXPECT_NEAR(*metrics.measures().at("cbv_speed_error_mps").value, 1.5, 1e-12);
  metrics.observe(snapshot(4, {cbv("a", 51, 40, 11.0)}), nullptr);
  EXPECT_NEAR(*metrics.measures().at("cbv_speed_error_mps").value, 4.0, 1e-12);
}

TEST_F(SessionMetricsTest, SamplesSpeedsAndSignedAccelerationsAtDecisions) {
  // Decisions at ticks 0, 2, 4 see speeds 1, 2, 4: W = 27/28 (three values); accelerations -1, 0, 1
  // lie evenly: W = 1.
  const double speeds[] = {1, 50, 2, 60, 4};
  const double accelerations[] = {-1, 7, 0, 8, 1};
  for (std::uint64_t tick = 0; tick < 5; ++tick) {
    auto vehicle = cbv("a", 50, 0, speeds[tick]);
    vehicle.acceleration = accelerations[tick];
    observe(tick, {vehicle});
  }
  const SessionMeasures measures = metrics_.measures();
  EXPECT_NEAR(*measures.at("speed_shapiro_wilk").value, 27.0 / 28.0, 1e-12);
  EXPECT_NEAR(*measures.at("acceleration_shapiro_wilk").value, 1.0, 1e-12);
  EXPECT_EQ(measures.at("speed_shapiro_wilk").n, 3U);
}

TEST_F(SessionMetricsTest, ThinsOutMoreSamplesThanTheTestAllows) {
  for (std::uint64_t i = 0; i < 5001; ++i)
    observe(2 * i, {cbv("a", 50, 0, static_cast<double>(i % 13))});
  const Measure measure = metrics_.measures().at("speed_shapiro_wilk");
  EXPECT_TRUE(measure.value.has_value());
  EXPECT_EQ(measure.n, 2501U);  // samples 0, 2, ..., 5000
  EXPECT_EQ(measure.reason, "1 in 2 of 5001 samples taken");
}

TEST_F(SessionMetricsTest, ComparesSpeedsWithTheBackgroundNearTheEgo) {
  // CBV 4 and 6, background 5 and 5 within 150 m, 99 outside: every half moves by 1.
  const auto far = background("far", 150.1, 0, 99);
  observe(0, {ego(0, 0, 5), cbv("a", 50, 0, 4), background("b", 150, 0, 5), far});
  observe(1, {ego(0, 0, 5), cbv("a", 50, 0, 80), background("b", 150, 0, 70), far});
  observe(2, {ego(0, 0, 5), cbv("a", 50, 0, 6), background("b", 150, 0, 5), far});
  EXPECT_NEAR(*metrics_.measures().at("speed_wasserstein_mps").value, 1.0, 1e-12);
  EXPECT_EQ(metrics_.measures().at("speed_wasserstein_mps").n, 2U);
}

TEST_F(SessionMetricsTest, SaysWhenThereIsNoBackground) {
  observe(0, {ego(0, 0, 5), cbv("a", 50, 0, 4)});
  EXPECT_EQ(metrics_.measures().at("speed_wasserstein_mps").reason,
            "no background vehicle within 150 m of the ego");
}

TEST_F(SessionMetricsTest, TakesTimesToCollisionAtDecisions) {
  // Gaps 15.2 m, 10.2 m, 5.2 m at 10 m/s at ticks 0, 1, 2: decisions see 1.52 s and 0.52 s.
  EXPECT_NEAR(*observe(0, {ego(0, 0, 10), background("a", 20, 0, 0)}).ttc_2d, 1.52, 1e-12);
  EXPECT_NEAR(*observe(1, {ego(0, 0, 10), background("a", 15, 0, 0)}).ttc_2d, 1.02, 1e-12);
  const TickMeasures last = observe(2, {ego(0, 0, 10), background("a", 10, 0, 0)});
  EXPECT_NEAR(*last.nearest_distance, 5.2, 1e-12);
  const SessionMeasures measures = metrics_.measures();
  EXPECT_EQ(measures.at("ttc_mean_s").n, 2U);
  EXPECT_NEAR(*measures.at("ttc_mean_s").value, 1.02, 1e-12);
  EXPECT_NEAR(*measures.at("ttc_min_s").value, 0.52, 1e-12);
  EXPECT_NEAR(*measures.at("ttc_std_s").value, std::sqrt(0.5),
              1e-12);  // +-0.5 about the mean, n - 1 = 1
}

TEST_F(SessionMetricsTest, CountsCornersOffTheRoadOnTheVehiclesLevel) {
  // The lane ends at y = 1.6, half a width is 0.9: at y = 0.7 a corner is on its border, at 0.71
  // off it, at 1.7 the center too. 6 m above the road everything is off it.
  const double places[] = {0.0, 0.69, 0.71, 1.7};
  for (std::uint64_t tick = 0; tick < 4; ++tick) observe(tick, {cbv("a", 50, places[tick], 5)});
  EXPECT_NEAR(*metrics_.measures().at("cbv_off_road_percent").value, 25.0, 1e-9);
  EXPECT_NEAR(*metrics_.measures().at("cbv_corner_off_road_percent").value, 50.0, 1e-9);
  EXPECT_EQ(metrics_.measures().at("cbv_corner_off_road_percent").n, 4U);
}

// A lane of 3.2 m north along x = 50, 8 m above the lane east along y = 0. At y = 30 there is no
// road on the ground.
TEST(SessionMetricsOnABridge, MeasuresVehiclesOnTheirOwnLevel) {
  const map::RoadNetwork network =
      test::NetworkText()
          .edge("east", {"0,0 100,0"}, "a", "b", {3.2, 10.0, ""})
          .edge("bridge", {"50,-50,8 50,50,8"}, "c", "d", {3.2, 10.0, ""})
          .network();
  const map::DrivableArea area(network);
  const SessionMetricsOptions options;
  const map::Route route;
  const auto observed = [&](double x, double elevation) {
    SessionMetrics metrics(options, area, route);
    std::vector<traffic::Vehicle> vehicles = {ego(x, 30, 5), cbv("a", x, 30, 5)};
    for (traffic::Vehicle& vehicle : vehicles) {
      vehicle.state.elevation = elevation;
      vehicle.state.heading = 0.5 * core::kPi;
    }
    metrics.observe(snapshot(0, vehicles), nullptr);
    const SessionMeasures measures = metrics.measures();
    return std::vector<double>{*measures.at("ego_off_road_percent").value,
                               *measures.at("cbv_off_road_percent").value,
                               *measures.at("cbv_corner_off_road_percent").value};
  };
  EXPECT_EQ(observed(50.0, 8.0), (std::vector<double>{0.0, 0.0, 0.0}));
  EXPECT_EQ(observed(50.0, 0.0), (std::vector<double>{100.0, 100.0, 100.0}));
  // Half a lane is 1.6 m, half a vehicle 0.9 m: 1 m aside the corners are off the bridge, the
  // center is not.
  EXPECT_EQ(observed(51.0, 8.0), (std::vector<double>{0.0, 0.0, 100.0}));
}

TEST_F(SessionMetricsTest, DistinguishesCbvsFromAllVehicles) {
  // Decision 0: background 20 m ahead (1.52 s), CBV 30 m ahead (2.52 s). Decision 2: the CBV is in
  // the next lane. Decision 4: no CBV, nothing ahead.
  observe(0, {ego(0, 0, 10), cbv("c", 30, 0, 0), background("b", 20, 0, 0)});
  observe(2, {ego(0, 0, 10), cbv("c", 30, 3.5, 0), background("b", 20, 0, 0)});
  observe(4, {ego(0, 0, 10)});
  const SessionMeasures measures = metrics_.measures();
  EXPECT_EQ(measures.at("ttc_cbv_mean_s").n, 1U);
  EXPECT_NEAR(*measures.at("ttc_cbv_mean_s").value, 2.52, 1e-12);
  EXPECT_EQ(measures.at("ttc_cbv_std_s").reason, "n = 1, needs at least 2");
  EXPECT_NEAR(*measures.at("ttc_min_s").value, 1.52, 1e-12);
  EXPECT_NEAR(*measures.at("ttc_defined_percent").value, 200.0 / 3.0, 1e-9);
  EXPECT_NEAR(*measures.at("ttc_cbv_defined_percent").value, 50.0, 1e-9);
  EXPECT_EQ(measures.at("ttc_cbv_defined_percent").n, 2U);
  // In line the paper's wording agrees.
  EXPECT_NEAR(*measures.at("ttc_lon_lat_mean_s").value, 1.52, 1e-12);
  EXPECT_NEAR(*measures.at("ttc_lon_lat_defined_percent").value, 200.0 / 3.0, 1e-9);
}

TEST_F(SessionMetricsTest, GivesPAndTheTargetOfDistances) {
  const double speeds[] = {1, 0, 2, 0, 4};
  for (std::uint64_t tick = 0; tick < 5; tick += 2)
    observe(tick, {ego(0, 0, 1), cbv("a", 50, 0, speeds[tick]), background("b", 60, 0, 3)});
  const SessionMeasures measures = metrics_.measures();
  EXPECT_NEAR(*measures.at("speed_shapiro_wilk_p").value, 0.636886, 1e-6);
  EXPECT_EQ(measures.at("speed_shapiro_wilk_p").n, 3U);
  EXPECT_EQ(measures.at("acceleration_shapiro_wilk_p").reason, "all values are equal");
  EXPECT_EQ(measures.at("speed_wasserstein_mps").target,
            "background vehicles within 150 m of the ego (n = 3)");
}

TEST(SpeedTargetOfASession, IsTheOneAskedFor) {
  const test::StraightRoad road;
  SessionMetricsOptions options;
  options.metrics.speed_target = "file";
  options.metrics.speed_target_samples = {"10"};
  SessionMetrics metrics(options, road.drivable_area, road.route);
  metrics.observe(snapshot(0, {ego(0, 0, 5), cbv("a", 50, 0, 4), background("b", 60, 0, 4)}),
                  nullptr);
  EXPECT_DOUBLE_EQ(*metrics.measures().at("speed_wasserstein_mps").value, 6.0);
}

TEST_F(SessionMetricsTest, SurvivesValuesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  observe(0, {ego(nan, 0, nan), cbv("a", nan, 0, nan), background("b", 0, nan, nan)});
  observe(2, {ego(10, 0, 5), cbv("a", 50, 0, 4), background("b", 60, 0, 4)});
  const SessionMeasures measures = metrics_.measures();
  EXPECT_NEAR(*measures.at("ego_completion_percent").value, 10.0, 1e-9);
  EXPECT_EQ(*measures.at("cbv_decisions").value, 1U);
  EXPECT_NEAR(*measures.at("speed_wasserstein_mps").value, 0.0, 1e-12);
}

TEST(SessionMetricsWithoutRoute, CompletesNothing) {
  const test::StraightRoad road;
  const map::Route none;
  SessionMetrics metrics({}, road.drivable_area, none);
  EXPECT_EQ(metrics.observe(snapshot(0, {ego(5, 0, 5)}), nullptr).route_completion_percent, 0.0);
}

}  // namespace
}  // namespace cdiff::metrics
