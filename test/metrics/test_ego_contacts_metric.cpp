// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;
using test::ego;

traffic::Vehicle aTickBefore(traffic::Vehicle vehicle) {
  vehicle.state.position -= 0.05 * vehicle.state.velocity();
  return vehicle;
}

/// The ego jumps 20 m, and then meets another of the same length: contact at 4.8 m.
class EgoContactsMetric : public ::testing::Test {
 protected:
  /// The ego at this speed, at x = 40, and the other begin to overlap.
  void meet(double ego_speed, const traffic::Vehicle& other) {
    const traffic::Vehicle own = ego(40, 0, ego_speed);
    traffic::Vehicle start = aTickBefore(own);
    start.state.position.x() -= 20.0;
    metrics_.observe(test::snapshot(0, {start}), nullptr);
    metrics_.observe(test::snapshot(1, {aTickBefore(own), aTickBefore(other)}), nullptr);
    auto last = test::snapshot(2, {own, other});
    last.contacts = {{"ego", other.id}};
    metrics_.observe(last, nullptr);
  }
  using Counts = std::vector<double>;
  Counts counts() const {
    const SessionMeasures measures = metrics_.measures();
    Counts values;
    for (const char* name :
         {"ego_contacts_struck_cbv", "ego_contacts_by_cbv", "ego_contacts_struck_background",
          "ego_contacts_by_background", "ego_contacts_standing", "ego_contacts_braking_avoids"})
      values.push_back(measures.at(name).value.value_or(-1.0));
    return values;
  }

  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(EgoContactsMetric, TheEgoStrikesFromBehind) {
  meet(6, cbv("v", 44.6, 0, 1));
  EXPECT_EQ(counts(), (Counts{1, 0, 0, 0, 0, 0}));
  // 20 m and 6 x 0.05 m: 1 contact in 20.3 m.
  const SessionMeasures measures = metrics_.measures();
  EXPECT_NEAR(*measures.at("ego_distance_m").value, 20.3, 1e-9);
  for (const char* name : {"ego_collisions_per_km", "ego_contacts_struck_cbv_per_km"})
    EXPECT_NEAR(*measures.at(name).value, 1000.0 / 20.3, 1e-9) << name;
  EXPECT_EQ(*measures.at("ego_contacts_by_cbv_per_km").value, 0.0);
}

TEST_F(EgoContactsMetric, ABackgroundVehicleIsStruckFromBehind) {
  meet(6, background("v", 44.6, 0, 1));
  EXPECT_EQ(counts(), (Counts{0, 0, 1, 0, 0, 0}));
  EXPECT_FALSE(metrics_.measures().ego_contacts.at(0).with_cbv);
}

TEST_F(EgoContactsMetric, ACbvStrikesFromBehind) {
  meet(2, cbv("v", 35.4, 0, 8));
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0, 0}));
  EXPECT_TRUE(metrics_.measures().ego_contacts.at(0).with_cbv);
}

TEST_F(EgoContactsMetric, ABackgroundVehicleStrikesAStandingEgo) {
  meet(0.05, background("v", 35.3, 0, 8));
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 1, 1, 0}));
  EXPECT_NEAR(*metrics_.measures().at("ego_contacts_standing_per_km").value, 1000.0 / 20.0025,
              1e-6);
}

TEST_F(EgoContactsMetric, AnEgoThatDrivesIntoWhatItSawCouldHaveAvoidedIt) {
  // Standing 60 m ahead of an ego at 8 m/s, as in test_braking_avoidance.cpp.
  const traffic::Vehicle other = background("v", 60, 0, 0);
  for (std::uint64_t tick = 0; tick <= 138; ++tick) {
    auto at = test::snapshot(tick, {ego(0.4 * static_cast<double>(tick), 0, 8), other});
    if (tick == 138) at.contacts = {{"ego", "v"}};  // at 55.2 m
    metrics_.observe(at, nullptr);
  }
  EXPECT_EQ(counts(), (Counts{0, 0, 1, 0, 0, 1}));
  const SessionMeasures measures = metrics_.measures();
  ASSERT_EQ(measures.ego_contacts.size(), 1U);
  EXPECT_TRUE(measures.ego_contacts.front().braking_avoids);
  EXPECT_NEAR(*measures.at("ego_contacts_braking_avoids_per_km").value, 1000.0 / 55.2, 1e-9);
}

TEST_F(EgoContactsMetric, GivesReasonsWithoutEgoAndWithoutMotion) {
  const SessionMeasures before = metrics_.measures();
  EXPECT_EQ(before.at("ego_distance_m").reason, "the ego was never seen");
  EXPECT_EQ(before.at("ego_collisions_per_km").reason, "the ego was never seen");
  EXPECT_EQ(*before.at("ego_contacts_by_cbv").value, 0.0);
  metrics_.observe(test::snapshot(0, {ego(5, 0, 0)}), nullptr);
  EXPECT_EQ(metrics_.measures().at("ego_collisions_per_km").reason, "the ego did not move");
}

TEST(ScoreUnderAttack, IsTheDrivingScoreOfAnAttack) {
  const test::StraightRoad road;
  const auto observed = [&](const char* mode) {
    SessionMetricsOptions options;
    options.mode = mode;
    SessionMetrics metrics(options, road.drivable_area, road.route);
    for (std::uint64_t tick = 0; tick <= 5; ++tick)
      metrics.observe(test::snapshot(tick, {ego(10.0 * static_cast<double>(tick), 0, 10)}),
                      nullptr);
    EXPECT_NEAR(*metrics.measures().at("ego_driving_score").value, 50.0, 1e-9);
    return metrics.measures().at("ego_driving_score_under_attack");
  };
  // Half of the route without an infraction.
  EXPECT_NEAR(observed("safety_critical").value.value_or(-1.0), 50.0, 1e-9);
  EXPECT_FALSE(observed("naturalistic").value.has_value());
  EXPECT_EQ(observed("naturalistic").reason, "the mode is naturalistic");
}

}  // namespace
}  // namespace cdiff::metrics
