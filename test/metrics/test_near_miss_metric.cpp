// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Near misses: an ego at x = 0 with 10 m/s behind another of the same length, 4.5 m.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

class NearMissMetric : public ::testing::Test {
 protected:
  /// At a time, `gap` m between the bumpers; the other drives `speed`.
  void see(double seconds, double gap, double speed, bool contact = false) {
    const auto tick = static_cast<std::uint64_t>(std::llround(seconds / 0.05));
    auto world = test::snapshot(tick, {test::ego(seconds, 0, own_speed_),
                                       test::background("v", seconds + 4.5 + gap, 0, speed)});
    if (contact) world.contacts = {{"ego", "v"}};
    metrics_.observe(world, nullptr);
  }
  double misses() const { return metrics_.measures().at("ego_near_misses").value.value_or(-1.0); }

  double own_speed_ = 10.0;
  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(NearMissMetric, AShortTimeToCollisionIsOne) {
  see(1.0, 8.0, 5.0);  // 8 m at 5 m/s: 1.6 s; 5 / (2 x 1.6) = 1.6 m/s^2
  EXPECT_EQ(misses(), 0.0);
  see(2.0, 7.0, 5.0);  // 1.4 s
  EXPECT_EQ(misses(), 1.0);
}

TEST_F(NearMissMetric, SoIsHardBrakingThatWouldBeNeeded) {
  own_speed_ = 14.0;
  see(1.0, 30.0, 0.0);  // 2.14 s; 14 / (2 x 2.14) = 3.27 m/s^2
  EXPECT_EQ(misses(), 0.0);
  see(2.0, 28.0, 0.0);  // 2.0 s; 14 / (2 x 2.0) = 3.5 m/s^2
  EXPECT_EQ(misses(), 1.0);
}

TEST_F(NearMissMetric, EpisodesLessThanASecondApartAreOne) {
  see(1.0, 7.0, 5.0);
  see(1.5, 20.0, 5.0);
  see(1.9, 7.0, 5.0);
  EXPECT_EQ(misses(), 1.0);
  see(3.0, 7.0, 5.0);
  EXPECT_EQ(misses(), 2.0);
}

TEST_F(NearMissMetric, AContactIsNoMiss) {
  see(1.0, 7.0, 5.0);
  see(1.5, 20.0, 5.0, true);
  EXPECT_EQ(misses(), 0.0);
  see(4.0, 7.0, 5.0);
  EXPECT_EQ(misses(), 1.0);
}

TEST_F(NearMissMetric, TheRateIsOverTheKmOfTheEgo) {
  see(0.0, 20.0, 5.0);
  see(10.0, 7.0, 5.0);  // 10 m on
  EXPECT_NEAR(*metrics_.measures().at("ego_near_misses_per_km").value, 100.0, 1e-9);
}

}  // namespace
}  // namespace cdiff::metrics
