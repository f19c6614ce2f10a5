// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/formulas/distributions.h"
#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

TEST(WassersteinDistanceToNormal, IsExactForFewSamples) {
  // One value at the mean: E|Z| = sqrt(2 / pi). Two at +-1: 2 (Phi(1) - 1/2 - phi(0) + 2 phi(1) -
  // 1 + Phi(1)) = 0.5353796. One far away: its distance to the mean.
  EXPECT_NEAR(*wassersteinDistanceToNormal({0.0}, 0.0, 1.0), std::sqrt(2.0 / M_PI), 1e-14);
  const double phi0 = 1.0 / std::sqrt(2.0 * M_PI);
  const double phi1 = phi0 * std::exp(-0.5);
  const double share = 0.5 * std::erfc(-1.0 / std::sqrt(2.0));
  EXPECT_NEAR(*wassersteinDistanceToNormal({1.0, -1.0}, 0.0, 1.0),
              2.0 * (share - 0.5 - phi0 + 2.0 * phi1 - (1.0 - share)), 1e-13);
  EXPECT_NEAR(*wassersteinDistanceToNormal({100.0}, 0.0, 1.0), 100.0, 1e-12);
}

TEST(WassersteinDistanceToNormal, ScalesAndShifts) {
  EXPECT_NEAR(*wassersteinDistanceToNormal({8.0}, 8.0, 2.0), 2.0 * std::sqrt(2.0 / M_PI), 1e-13);
  EXPECT_NEAR(*wassersteinDistanceToNormal({1.0, 4.0, 9.0}, 5.0, 2.0),
              2.0 * *wassersteinDistanceToNormal({-2.0, -0.5, 2.0}, 0.0, 1.0), 1e-13);
}

TEST(WassersteinDistanceToNormal, IsTheLimitOfLargeSamplesOfTheNormal) {
  // The normal by its 20000 middle quantiles, found by bisection of Phi. In each of 20000 steps of
  // F_n the triangles above and below Phi hold gap / (4 x 20000): about 8.5 / 80000 in all.
  std::vector<double> normal;
  for (int i = 0; i < 20000; ++i) {
    double low = -8.0;
    double high = 8.0;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      const bool below = 0.5 * std::erfc(-middle / std::sqrt(2.0)) < (i + 0.5) / 20000.0;
      (below ? low : high) = middle;
    }
    normal.push_back(low);
  }
  const std::vector<double> samples = {-1.5, -0.2, 0.1, 0.4, 2.5, 2.5};
  EXPECT_NEAR(*wassersteinDistanceToNormal(samples, 0.0, 1.0),
              *wassersteinDistance(samples, normal), 1.5e-4);
  EXPECT_NEAR(*wassersteinDistanceToNormal(normal, 0.0, 1.0), 8.5 / 80000.0, 2e-5);
}

TEST(WassersteinDistanceToNormal, TakesADeviationOfZeroAndRefusesNonsense) {
  EXPECT_NEAR(*wassersteinDistanceToNormal({7.0, 10.0}, 8.0, 0.0), 1.5, 1e-15);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(wassersteinDistanceToNormal({}, 0.0, 1.0).has_value());
  EXPECT_FALSE(wassersteinDistanceToNormal({nan}, 0.0, 1.0).has_value());
  EXPECT_FALSE(wassersteinDistanceToNormal({1.0}, nan, 1.0).has_value());
  EXPECT_FALSE(wassersteinDistanceToNormal({1.0}, 0.0, -1.0).has_value());
}

/// The distance of CBV speeds to the target, with a background vehicle beside the ego.
Measure distanceOf(const MetricsOptions& options, const std::vector<double>& speeds,
                   const std::vector<double>& background) {
  SessionMetricsOptions session;
  session.metrics = options;
  test::MetricUnderTest metric("speed_wasserstein", session);
  std::vector<traffic::Vehicle> vehicles = {test::ego(0, 0, 5)};
  for (const double speed : background) vehicles.push_back(test::background("b", 20, 0, speed));
  const traffic::TrafficSnapshot snapshot = test::snapshot(0, vehicles);
  std::vector<traffic::Vehicle> cbvs;
  for (const double speed : speeds) cbvs.push_back(test::cbv("a", 50, 0, speed));
  MetricTick tick{snapshot, nullptr, snapshot.ego()};
  for (const traffic::Vehicle& cbv : cbvs) tick.cbvs.push_back({&cbv});
  metric.observe(tick);
  return metric.at("speed_wasserstein_mps");
}

TEST(SpeedTarget, IsNamedBesideTheDistance) {
  MetricsOptions options;
  EXPECT_EQ(distanceOf(options, {4.0}, {}).reason, "no background vehicle within 150 m of the ego");
  EXPECT_DOUBLE_EQ(*distanceOf(options, {4.0, 6.0}, {5.0}).value, 1.0);
  EXPECT_EQ(distanceOf(options, {4.0}, {5.0}).target,
            "background vehicles within 150 m of the ego (n = 1)");

  options.speed_target = "normal";
  options.speed_target_deviation = 0.0;
  EXPECT_DOUBLE_EQ(*distanceOf(options, {4.0, 6.0}, {5.0}).value, 3.0);  // to 8 m/s, not to 5
  EXPECT_EQ(distanceOf(options, {4.0}, {5.0}).target,
            "normal distribution of mean 8 m/s and standard deviation 0 m/s");

  options.speed_target = "file";
  options.speed_target_file = "speeds.txt";
  options.speed_target_samples = {"7", "9.5"};
  EXPECT_DOUBLE_EQ(*distanceOf(options, {7.0, 9.0}, {5.0}).value, 0.25);
  EXPECT_EQ(distanceOf(options, {}, {5.0}).target, "file speeds.txt (n = 2)");
  EXPECT_EQ(distanceOf(options, {}, {5.0}).reason, "no CBV was driven");
}

TEST(MetricsOptions, RefuseAFileTargetWithoutFileAndBadSamples) {
  MetricsOptions options;
  options.speed_target = "file";
  EXPECT_THROW(options.validate(), core::InputError);
  options.speed_target_samples = {"1", "nan"};
  EXPECT_THROW(options.validate(), core::InputError);
  options.speed_target_samples = {"1", "-1"};
  EXPECT_THROW(options.validate(), core::InputError);
  options.speed_target_samples = {"1", "2"};
  EXPECT_NO_THROW(options.validate());
  options.speed_target_file = "speeds.txt";
  EXPECT_NO_THROW(options.validate());
  options.speed_target = "background";
  EXPECT_THROW(options.validate(), core::InputError);
}

}  // namespace
}  // namespace cdiff::metrics
