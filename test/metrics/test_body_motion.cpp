// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "metrics/formulas/body_motion.h"
#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

traffic::Vehicle moving(const std::string& id, double speed, double acceleration,
                        double yaw_rate = 0.0) {
  traffic::Vehicle vehicle = test::cbv(id, 0, 0, speed);
  vehicle.acceleration = acceleration;
  vehicle.yaw_rate = yaw_rate;
  return vehicle;
}

/// The two metrics of how CBVs move, with decisions 0.1 s apart.
class ComfortMeasures {
 public:
  void observe(const std::vector<traffic::Vehicle>& vehicles) {
    std::vector<CbvSighting> sightings;
    for (const traffic::Vehicle& vehicle : vehicles) sightings.push_back({&vehicle});
    comfort_.observeCbvs(sightings);
    motion_.observeCbvs(sightings);
  }
  Measure uncomfortable() { return comfort_.at("cbv_uncomfortable_percent"); }
  Measure motion(const std::string& definition) { return motion_.at(definition); }

 private:
  test::MetricUnderTest comfort_{"cbv_comfort"};
  test::MetricUnderTest motion_{"cbv_motion"};
};

TEST(IsUncomfortable, HasNuPlansLimits) {
  EXPECT_FALSE(isUncomfortable({2.39, 4.88}, 8.36));
  EXPECT_FALSE(isUncomfortable({-4.04, -4.88}, -8.36));
  EXPECT_TRUE(isUncomfortable({2.40, 0.0}, 0.0));
  EXPECT_TRUE(isUncomfortable({-4.05, 0.0}, 0.0));
  EXPECT_TRUE(isUncomfortable({0.0, 4.89}, 0.0));
  EXPECT_TRUE(isUncomfortable({0.0, -4.89}, 0.0));
  EXPECT_TRUE(isUncomfortable({0.0, 0.0}, 8.37));
  EXPECT_TRUE(isUncomfortable({0.0, 0.0}, -8.37));
  EXPECT_FALSE(isUncomfortable({0.0, 0.0}, std::nullopt));
}

TEST(ComfortMeasures, TakesLateralAccelerationFromYawRate) {
  // 6 m/s x 0.5 rad/s = 3 m/s^2 across, 4 braking: magnitude 5.
  ComfortMeasures comfort;
  comfort.observe({moving("a", 6.0, -4.0, 0.5)});
  EXPECT_DOUBLE_EQ(*comfort.motion("cbv_acceleration_mean_mps2").value, 5.0);
  // 10 m/s x 0.489 rad/s is the lateral limit.
  ComfortMeasures turning;
  turning.observe({moving("a", 10.0, 0.0, 0.489), moving("b", 10.0, 0.0, 0.4889)});
  EXPECT_DOUBLE_EQ(*turning.uncomfortable().value, 50.0);
}

TEST(ComfortMeasures, TakesJerkBetweenDecisionsOfOneVehicle) {
  // |a|: 1, 1.5, 1.2 for a -> jerk +5 and -3 m/s^3 at 0.1 s; b appears once and has none.
  ComfortMeasures comfort;
  comfort.observe({moving("a", 5.0, 1.0)});
  comfort.observe({moving("a", 5.0, -1.5), moving("b", 5.0, 0.0)});
  comfort.observe({moving("a", 5.0, 1.2)});
  EXPECT_EQ(comfort.motion("cbv_jerk_mean_mps3").n, 2U);
  EXPECT_NEAR(*comfort.motion("cbv_jerk_mean_mps3").value, 1.0, 1e-12);
  EXPECT_NEAR(*comfort.motion("cbv_jerk_std_mps3").value, std::sqrt(32.0),
              1e-9);  // +-4 about 1, n - 1 = 1
  EXPECT_NEAR(*comfort.motion("cbv_jerk_min_mps3").value, -3.0, 1e-12);
}

TEST(ComfortMeasures, StartsOverAfterAGap) {
  // A jump from 0 to 2 m/s^2 would be 20 m/s^3, but the vehicle was no CBV in between.
  ComfortMeasures comfort;
  comfort.observe({moving("a", 5.0, 0.0)});
  comfort.observe({});
  comfort.observe({moving("a", 5.0, 2.0)});
  EXPECT_FALSE(comfort.motion("cbv_jerk_mean_mps3").value.has_value());
  EXPECT_EQ(comfort.motion("cbv_jerk_mean_mps3").reason,
            "no CBV was driven for two decisions in a row");
  EXPECT_DOUBLE_EQ(*comfort.uncomfortable().value, 0.0);
  EXPECT_EQ(comfort.uncomfortable().n, 2U);
}

TEST(ComfortMeasures, JudgesJerk) {
  // 0 to 0.8 m/s^2 in 0.1 s is 8 m/s^3, 0.8 to 1.7 is 9: one of three decisions.
  ComfortMeasures comfort;
  for (const double acceleration : {0.0, 0.8, 1.7}) comfort.observe({moving("a", 5, acceleration)});
  EXPECT_NEAR(*comfort.uncomfortable().value, 100.0 / 3.0, 1e-9);
}

TEST(ComfortMeasures, GivesTheMeanOfARamp) {
  // 0 to 10 m/s over 400 decisions, each counted once: 5.00 (RIFT's counting gives 3.38).
  ComfortMeasures comfort;
  for (int i = 0; i < 400; ++i) comfort.observe({moving("a", 10.0 * i / 399.0, 0.25)});
  EXPECT_NEAR(*comfort.motion("cbv_speed_mean_mps").value, 5.0, 1e-9);
}

TEST(ComfortMeasures, LeavesOutValuesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ComfortMeasures comfort;
  comfort.observe({moving("a", nan, 0.0)});
  EXPECT_EQ(comfort.motion("cbv_speed_mean_mps").reason, "no CBV was driven");
  EXPECT_EQ(comfort.uncomfortable().n, 0U);
}

}  // namespace
}  // namespace cdiff::metrics
