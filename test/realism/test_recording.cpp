// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "realism/recording.h"

namespace cdiff::realism {
namespace {

/// x = t^2 [m], heading 0: speed 2 t, acceleration 2 m/s^2.
Track accelerating(std::size_t states) {
  Track track;
  for (std::size_t i = 0; i < states; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    track.states.push_back({{t * t, 0.0}, 0.0, 0.0});
  }
  return track;
}

TEST(CentralMotion, IsExactForConstantAcceleration) {
  const Motion motion = centralMotion(accelerating(6));
  EXPECT_TRUE(std::isnan(motion.speed[0]));
  EXPECT_TRUE(std::isnan(motion.speed[5]));
  EXPECT_NEAR(motion.speed[1], 0.2, 1e-12);  // (.04 - 0) / .2
  EXPECT_NEAR(motion.speed[4], 0.8, 1e-12);  // (.25 - .09) / .2
  EXPECT_TRUE(std::isnan(motion.acceleration[1]));
  EXPECT_NEAR(motion.acceleration[2], 2.0, 1e-9);  // (.6 - .2) / .2
  EXPECT_NEAR(motion.acceleration[3], 2.0, 1e-9);
  EXPECT_TRUE(std::isnan(motion.acceleration[4]));
}

TEST(CentralMotion, TurnsTheShortWay) {
  // Headings 3.0, 3.1, -3.1, -3.0 [rad]: from 3.0 to -3.1 it is 2 pi - 6.1 = .1832, from 3.1 to
  // -3.0 the same; each over .2 s. The rate does not change, but only inner states have one.
  Track track;
  for (const double heading : {3.0, 3.1, -3.1, -3.0, -3.0 + 0.4})
    track.states.push_back({{0.0, 0.0}, heading, 0.0});
  const Motion motion = centralMotion(track);
  const double rate = (2.0 * M_PI - 6.1) / 0.2;
  EXPECT_NEAR(motion.yaw_rate[1], rate, 1e-9);
  EXPECT_NEAR(motion.yaw_rate[2], rate, 1e-9);
  EXPECT_NEAR(motion.yaw_rate[3], 0.5 / 0.2, 1e-9);  // -2.6 - (-3.1)
  EXPECT_NEAR(motion.yaw_acceleration[2], (2.5 - rate) / 0.2, 1e-9);
}

TEST(SmoothedDerivative, IsExactForQuadraticsUpToTheEnds) {
  Series values;
  for (int i = 0; i < 20; ++i) values.push_back(3.0 * (0.1 * i) * (0.1 * i) - 1.0 * (0.1 * i));
  const Series derivative = smoothedDerivative(values);
  ASSERT_EQ(derivative.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_NEAR(derivative[i], 6.0 * 0.1 * static_cast<double>(i) - 1.0, 1e-9) << i;
  EXPECT_TRUE(smoothedDerivative(Series(10, 1.0)).empty());
}

TEST(SmoothedDerivative, WeighsOneOutlierAsTheFilterDoes) {
  // A single 1 at k = -2 of the window: slope k / 110 per state of .1 s, -2 / 110 / .1 = -.1818.
  Series values(11, 0.0);
  values[3] = 1.0;
  EXPECT_NEAR(smoothedDerivative(values)[5], -2.0 / 110.0 / 0.1, 1e-12);
}

TEST(SmoothedMotion, DifferentiatesPlacesAndFollowsTheMotion) {
  Track track = accelerating(31);
  for (TrackState& state : track.states) state.heading = 1.0;  // wrong on purpose
  const Motion motion = smoothedMotion(track);
  EXPECT_NEAR(motion.speed[15], 3.0, 1e-9);
  EXPECT_NEAR(motion.acceleration[15], 2.0, 1e-9);
  // The first moving state (> 1 m/s) gives its direction, 0, to those before it.
  EXPECT_NEAR(track.states[0].heading, 0.0, 1e-12);
  EXPECT_NEAR(motion.yaw_rate[15], 0.0, 1e-12);
}

TEST(SmoothedMotion, KeepsTheHeadingOfWhatNeverMoves) {
  Track track;
  track.states.assign(12, {{1.0, 2.0}, 0.7, 0.0});
  const Motion motion = smoothedMotion(track);
  EXPECT_EQ(track.states[5].heading, 0.7);
  EXPECT_EQ(motion.speed[5], 0.0);
  Track few = accelerating(10);
  EXPECT_TRUE(std::isnan(smoothedMotion(few).speed[5]));
}

}  // namespace
}  // namespace cdiff::realism
