// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

using test::cbv;

/// The metrics by RIFT's definitions, with decisions 0.1 s apart.
class RiftMeasures {
 public:
  void observeEgo(double speed, const std::optional<double>& time_to_collision,
                  const std::optional<double>& approach_time = {}) {
    const traffic::TrafficSnapshot snapshot = test::snapshot(0, {test::ego(0, 0, speed)});
    MetricTick tick{snapshot, nullptr, snapshot.ego()};
    tick.interaction.rift_ttc = time_to_collision;
    tick.interaction.rift_act = approach_time;
    interaction_.observe(tick);
  }
  void observeCbvs(const std::vector<CbvSighting>& cbvs) {
    motion_.observeCbvs(cbvs);
    rates_.observeCbvs(cbvs);
  }
  /// A contact between decisions, in which this CBV takes part.
  void countCollision(const std::string& id) {
    const traffic::TrafficSnapshot snapshot = test::snapshot(1, {});
    MetricTick tick{snapshot};
    tick.contacts.push_back({"", {id}, ""});
    rates_.observe(tick);
  }
  Measure at(const std::string& key) {
    const std::string measure = "rift_compat_" + key;
    for (test::MetricUnderTest* metric : {&interaction_, &motion_, &rates_}) {
      if (metric->has(measure)) return metric->at(measure);
    }
    ADD_FAILURE() << key << " is no measure of RIFT";
    return {};
  }

 private:
  test::MetricUnderTest interaction_{"rift_interaction"};
  test::MetricUnderTest motion_{"rift_motion"};
  test::MetricUnderTest rates_{"rift_rates"};
};

TEST(RiftMeasures, AreAbsentWithAReasonWithoutCbv) {
  RiftMeasures measures;
  for (const char* key : {"speed_shapiro_wilk", "acceleration_shapiro_wilk",
                          "speed_wasserstein_mps", "off_road_rate_percent", "collisions_per_km"}) {
    EXPECT_FALSE(measures.at(key).value.has_value()) << key;
    EXPECT_EQ(measures.at(key).reason, "no CBV was driven") << key;
  }
  EXPECT_FALSE(measures.at("ttc_2d_s").value.has_value());
  EXPECT_FALSE(measures.at("ttc_2d_s").reason.empty());
}

TEST(RiftMeasures, BinTimesBelowFiveSecondsAtThreeToTenMetersPerSecond) {
  RiftMeasures rift;
  rift.observeEgo(5.0, 1.2);   // bin 1 to 1.5: 1.25
  rift.observeEgo(5.0, 2.5);   // bin 2 to 2.5: 2.25
  rift.observeEgo(5.0, 5.0);   // not below 5 s
  rift.observeEgo(3.0, 0.3);   // bin 2.5 to 3 of the ego's speed: not reported
  rift.observeEgo(10.0, 0.3);  // speed not below the last edge
  rift.observeEgo(5.0, std::nullopt);
  // Mean (1.25 + 2.25) / 2 = 1.75, variance 0.5^2 = 0.25.
  EXPECT_DOUBLE_EQ(*rift.at("ttc_2d_s").value, 1.75);
  EXPECT_DOUBLE_EQ(*rift.at("ttc_2d_variance_s2").value, 0.25);
  EXPECT_EQ(rift.at("ttc_2d_s").n, 2U);
}

TEST(RiftMeasures, CountEarlySamplesAgainAtEveryTick) {
  // Speeds 1, 3.5, 7 in bins with midpoints 0.75, 3.5, 7, counted 3, 2 and 1 times: mean (2.25 + 7
  // + 7) / 6 = 65/24 = 2.7083; E[mid^2] = (1.6875 + 24.5 + 49) / 6 = 12.53125, variance 5.19618;
  // distance sqrt((8.5 - 2.7083)^2 + 5.19618) = 6.2241.
  RiftMeasures rift;
  for (const double speed : {1.0, 3.5, 7.0}) {
    const auto vehicle = cbv("a", 0, 0, speed);
    rift.observeCbvs({{&vehicle, false}});
  }
  const auto measure = rift.at("speed_wasserstein_mps");
  EXPECT_NEAR(*measure.value, 6.2241, 5e-5);
  EXPECT_EQ(measure.n, 3U);
}

TEST(RiftMeasures, GiveThePublishedValueOfARamp) {
  // 0 to 10 m/s over 40 s at 10 Hz: S-WD 5.65 and mean 3.38 (4.51 and 5.00 if every sample counted
  // once).
  RiftMeasures rift;
  for (int i = 0; i < 400; ++i) {
    const auto vehicle = cbv("a", 0, 0, 10.0 * i / 399.0);
    rift.observeCbvs({{&vehicle, false}});
  }
  EXPECT_NEAR(*rift.at("speed_wasserstein_mps").value, 5.65, 5e-3);
  EXPECT_NEAR(*rift.at("speed_mean_mps").value, 3.38, 5e-3);
  EXPECT_EQ(rift.at("speed_wasserstein_mps").target, "8.5 m/s for all (30 km/h in RIFT's bins)");
}

TEST(RiftMeasures, RepeatJerksThatStartAtZero) {
  // |a| 0.5, 0.7: jerks 5 and 2 m/s^3 in bins (4, 6] and (0, 2] with midpoints 5 and 1, the first
  // counted twice: mean 11/3; E[mid^2] = 51/3 = 17, variance 17 - 121/9 = 32/9.
  RiftMeasures rift;
  for (const double acceleration : {0.5, 0.7}) {
    auto vehicle = cbv("a", 0, 0, 1.0);
    vehicle.acceleration = acceleration;
    rift.observeCbvs({{&vehicle, false}});
  }
  EXPECT_NEAR(*rift.at("jerk_mean_mps3").value, 11.0 / 3.0, 1e-12);
  EXPECT_NEAR(*rift.at("jerk_std_mps3").value, std::sqrt(32.0 / 9.0), 1e-12);
  EXPECT_EQ(rift.at("jerk_mean_mps3").n, 2U);
  // Accelerations in the bins (0.25, 0.5] twice and (0.5, 0.75]: (2 x 0.375 + 0.625) / 3.
  EXPECT_NEAR(*rift.at("acceleration_mean_mps2").value, 1.375 / 3.0, 1e-12);
  EXPECT_NEAR(*rift.at("acceleration_std_mps2").value, 0.25 * std::sqrt(2.0) / 3.0, 1e-12);
}

TEST(RiftMeasures, CallTheFirstDecisionUncomfortableWhereItsJerkIs) {
  // 0 to 0.9 m/s^2 in 0.1 s: 9 m/s^3 at the first decision, 0 at the second.
  RiftMeasures rift;
  auto vehicle = cbv("a", 0, 0, 1.0);
  vehicle.acceleration = 0.9;
  rift.observeCbvs({{&vehicle, false}});
  rift.observeCbvs({{&vehicle, false}});
  EXPECT_DOUBLE_EQ(*rift.at("uncomfortable_rate_percent").value, 50.0);
}

TEST(RiftMeasures, SumTheReachedProgress) {
  RiftMeasures rift;
  for (const double x : {0.0, 3.0, 7.0}) {
    const auto first = cbv("a", x, 0, 5.0);
    const auto second = cbv("b", -x, 20, 5.0);
    rift.observeCbvs({{&first, false}, {&second, false}});
  }
  EXPECT_DOUBLE_EQ(*rift.at("reached_progress_m").value, 14.0);
  EXPECT_EQ(rift.at("reached_progress_m").n, 2U);
}

TEST(RiftMeasures, BinApproachTimesLikeTimesToCollision) {
  RiftMeasures rift;
  rift.observeEgo(5.0, std::nullopt, 1.2);  // 1.25
  rift.observeEgo(5.0, 2.0, 4.9);           // 4.75
  rift.observeEgo(2.0, 2.0, 0.1);           // too slow
  EXPECT_DOUBLE_EQ(*rift.at("act_s").value, 3.0);
  EXPECT_DOUBLE_EQ(*rift.at("act_variance_s2").value, 1.75 * 1.75);
  EXPECT_EQ(rift.at("ttc_2d_s").n, 1U);
}

TEST(RiftMeasures, EndALifeWhenTheRoleEnds) {
  // First life: one tick at 1 m/s. Then a tick without CBV. Second life: one tick at 7 m/s. Nothing
  // is repeated: midpoints 0.75 and 7: mean 3.875, variance 3.125^2; sqrt(4.625^2 + 3.125^2)
  // = 5.5818. Nothing moved in a life.
  RiftMeasures rift;
  const auto slow = cbv("a", 0, 0, 1.0);
  const auto fast = cbv("a", 9, 0, 7.0);
  rift.observeCbvs({{&slow, false}});
  rift.observeCbvs({});
  rift.observeCbvs({{&fast, false}});
  EXPECT_NEAR(*rift.at("speed_wasserstein_mps").value, 5.5818, 5e-5);
  EXPECT_EQ(rift.at("collisions_per_km").reason, "no CBV moved");
}

TEST(RiftMeasures, UseTheMagnitudeOfAcceleration) {
  // Braking 0.6 and turning 4 m/s x 0.2 rad/s = 0.8: magnitude 1.0 lies in the bin 0.75 to 1, like
  // 0.9 straight on. Signed (-0.6) or without the lateral part (0.6) it would lie in another bin
  // and, beside a second vehicle's 2.2, W would differ.
  auto turning = cbv("a", 0, 0, 4.0);
  turning.acceleration = -0.6;
  turning.yaw_rate = 0.2;
  auto accelerating = cbv("b", 0, 0, 4.0);
  accelerating.acceleration = 2.2;
  RiftMeasures rift;
  rift.observeCbvs({{&turning, false}, {&accelerating, false}});
  auto straight = cbv("a", 0, 0, 4.0);
  straight.acceleration = 0.9;
  RiftMeasures expected;
  expected.observeCbvs({{&straight, false}, {&accelerating, false}});
  const auto key = "acceleration_shapiro_wilk";
  EXPECT_EQ(*rift.at(key).value, *expected.at(key).value);
}

TEST(RiftMeasures, CountAtMostOneCollisionPerLife) {
  // 100 m driven, one vehicle with two contacts: 1 / 0.1 km = 10.
  RiftMeasures rift;
  const auto begin = cbv("a", 0, 0, 5.0);
  const auto end = cbv("a", 100, 0, 5.0);
  rift.observeCbvs({{&begin, true}});
  rift.observeCbvs({{&end, false}});
  rift.countCollision("a");
  rift.countCollision("a");
  EXPECT_DOUBLE_EQ(*rift.at("collisions_per_km").value, 10.0);
  EXPECT_DOUBLE_EQ(*rift.at("off_road_rate_percent").value, 50.0);
}

TEST(RiftMeasures, SayWhenNoValueLiesInTheBins) {
  RiftMeasures rift;
  const auto vehicle = cbv("a", 0, 0, 20.0);
  rift.observeCbvs({{&vehicle, false}});
  EXPECT_EQ(rift.at("speed_shapiro_wilk").reason, "no value lies inside RIFT's bins");
  EXPECT_EQ(rift.at("speed_wasserstein_mps").reason, "no value lies inside RIFT's bins");
}

}  // namespace
}  // namespace cdiff::metrics
