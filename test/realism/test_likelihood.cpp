// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "realism/likelihood.h"

namespace cdiff::realism {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A course with values of one feature only; the others have none at any step.
Course courseWith(Feature feature, const Series& values) {
  Course course;
  course.fill(Series(values.size(), kNone));
  course[feature] = values;
  return course;
}

std::optional<double> likelihoodOf(Feature feature, const Series& logged,
                                   const std::vector<Series>& simulated) {
  std::vector<Course> rollouts;
  for (const Series& values : simulated) rollouts.push_back(courseWith(feature, values));
  LikelihoodSums sums;
  addObject(courseWith(feature, logged), rollouts, sums);
  return sums[feature].likelihood();
}

TEST(Likelihood, WeightsOfAllFeaturesAddUpToOne) {
  double sum = 0.0;
  double without_map = 0.0;
  for (const FeatureDefinition& feature : featureDefinitions()) {
    sum += feature.weight;
    without_map += feature.of_map ? 0.0 : feature.weight;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(without_map, 0.65, 1e-12);
}

TEST(Likelihood, OfSpeedIsTheGeometricMeanOverSteps) {
  // Bins of 2.5 m/s from 0 to 25. Simulated over two rollouts: 1, 1 -> bin 0; 3 -> bin 1; 9 -> bin
  // 3. With .1 in each of 10 bins the total is 5. Logged: 2 -> bin 0: 2.1 / 5 = .42; 4 -> bin 1:
  // 1.1 / 5 = .22; 30 counts in the last bin: .1 / 5 = .02; the step without a value counts not.
  const auto likelihood =
      likelihoodOf(kLinearSpeed, {2.0, 4.0, 30.0, kNone}, {{1.0, 3.0, kNone}, {1.0, 9.0}});
  EXPECT_NEAR(likelihood.value(), std::cbrt(0.42 * 0.22 * 0.02), 1e-12);
}

TEST(Likelihood, OfEachHistogramHasItsBins) {
  // Two simulated values, one of them in the logged value's bin, and .1 in each bin:
  // 1.1 / (2 + .1 x bins) with 11 bins: 1.1 / 3.1, with 10: 1.1 / 3. The pairs stand on both sides
  // of a border of that bin.
  const double of_11 = 1.1 / 3.1;
  const double of_10 = 1.1 / 3.0;
  // Bin 5 of 11 over +-12 reaches from -1.0909 to 1.0909.
  EXPECT_NEAR(*likelihoodOf(kLinearAcceleration, {0.0}, {{1.09, 1.10}}), of_11, 1e-12);
  // Bin 5 of 11 over +-.628 reaches to .0571, over +-3.14 to .2855.
  EXPECT_NEAR(*likelihoodOf(kAngularSpeed, {0.0}, {{0.057, 0.058}}), of_11, 1e-12);
  EXPECT_NEAR(*likelihoodOf(kAngularAcceleration, {0.0}, {{0.285, 0.286}}), of_11, 1e-12);
  // Bin 1 of 10 over -5..40 reaches from -.5 to 4.
  EXPECT_NEAR(*likelihoodOf(kNearestObject, {1.0}, {{-0.49, -0.51}}), of_10, 1e-12);
  // The last bin over 0..5 s starts at 4.5.
  EXPECT_NEAR(*likelihoodOf(kTimeToCollision, {5.0}, {{4.51, 4.49}}), of_10, 1e-12);
  // Bin 3 of 10 over -20..40 reaches from -2 to 4.
  EXPECT_NEAR(*likelihoodOf(kRoadEdge, {0.0}, {{-1.9, -2.1}}), of_10, 1e-12);
}

TEST(Likelihood, OfAnIndicatorCountsRollouts) {
  // One of four rollouts collides at any step; .001 in each of two bins: 3.001 / 4.002 for a log
  // without a collision, 1.001 / 4.002 for one with.
  const std::vector<Series> rollouts = {{0, 0}, {0, 1}, {0, 0}, {0, 0}};
  for (const Feature feature : {kCollision, kOffRoad, kRedLight}) {
    EXPECT_NEAR(*likelihoodOf(feature, {0, 0}, rollouts), 3.001 / 4.002, 1e-12);
    EXPECT_NEAR(*likelihoodOf(feature, {1, 0}, rollouts), 1.001 / 4.002, 1e-12);
  }
  // The log is there at the first step only: no rollout collides then.
  EXPECT_NEAR(*likelihoodOf(kCollision, {0, kNone}, rollouts), 4.001 / 4.002, 1e-12);
  EXPECT_FALSE(likelihoodOf(kCollision, {kNone}, rollouts).has_value());
}

TEST(Likelihood, AveragesOverTheStepsOfAllObjects) {
  // Each object has its own histogram: .42 for the first (see above), 1.1 / 2 = .55 for the second
  // (one simulated value in the bin of the two logged ones).
  LikelihoodSums sums;
  addObject(courseWith(kLinearSpeed, {2.0}), {courseWith(kLinearSpeed, {1.0, 3.0, 1.0, 9.0})},
            sums);
  addObject(courseWith(kLinearSpeed, {6.0, 7.0}), {courseWith(kLinearSpeed, {6.5})}, sums);
  EXPECT_EQ(sums[kLinearSpeed].n, 3U);
  EXPECT_NEAR(sums[kLinearSpeed].likelihood().value(), std::cbrt(0.42 * 0.55 * 0.55), 1e-12);
}

TEST(Likelihood, MetaMetricOfIdenticalDataIsNearlyOne) {
  // 32 rollouts of 80 steps that are all the log: 2560 values in one bin. Histograms of 10 bins
  // give 2560.1 / 2561, those of 11 bins 2560.1 / 2561.1, indicators 32.001 / 32.002. Weights: 10
  // bins .30 (speed .05, nearest .1, time .1, edge .05); 11 bins .15; indicators .55.
  Course course;
  course.fill(Series(80, 0.0));
  LikelihoodSums sums;
  addObject(course, std::vector<Course>(32, course), sums);
  const double expected = 0.30 * 2560.1 / 2561.0 + 0.15 * 2560.1 / 2561.1 + 0.55 * 32.001 / 32.002;
  EXPECT_NEAR(metaMetric(likelihoodsOf(sums)).value(), expected, 1e-12);
  EXPECT_GT(expected, 0.9997);
}

TEST(Likelihood, MetaMetricScalesTheWeightsOfWhatIsThere) {
  Likelihoods likelihoods;
  EXPECT_FALSE(metaMetric(likelihoods).has_value());
  likelihoods[kLinearSpeed] = 0.5;  // weight .05
  likelihoods[kCollision] = 0.9;    // weight .25
  EXPECT_NEAR(metaMetric(likelihoods).value(), (0.05 * 0.5 + 0.25 * 0.9) / 0.30, 1e-12);
}

TEST(Likelihood, MeanPassesOverWhatIsAbsent) {
  Likelihoods first;
  Likelihoods second;
  first[kLinearSpeed] = 0.2;
  second[kLinearSpeed] = 0.4;
  second[kCollision] = 1.0;
  const Likelihoods mean = meanOf({first, second});
  EXPECT_NEAR(mean[kLinearSpeed].value(), 0.3, 1e-12);
  EXPECT_NEAR(mean[kCollision].value(), 1.0, 1e-12);
  EXPECT_FALSE(mean[kRoadEdge].has_value());
}

}  // namespace
}  // namespace cdiff::realism
