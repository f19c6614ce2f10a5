// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "reference_driver/course.h"
#include "reference_driver/rss_driver.h"

namespace cdiff::reference_driver {
namespace {

using testing::carAcross;
using testing::carAhead;
using testing::ownAt;

constexpr double kSpeed = 30.0 / 3.6;

// To a standing car at 30 km/h: 8.333 + 1.75 + 11.833^2 / 8; with JRC's constants
// 6.25 + 0.844 + 10.583^2 / 12.
TEST(RssDriver, HasThePublishedFollowingDistance) {
  EXPECT_NEAR(rssFollowingDistance({}, kSpeed, 0.0), 27.59, 0.01);
  RssOptions jrc;
  jrc.response_time = 0.75;
  jrc.acceleration = 3.0;
  jrc.least_braking = jrc.hardest_braking = 6.0;
  EXPECT_NEAR(rssFollowingDistance(jrc, kSpeed, 0.0), 16.43, 0.01);
  EXPECT_NEAR(rssFollowingDistance({}, 10.0, 8.0), 10.0 + 1.75 + 13.5 * 13.5 / 8.0 - 4.0, 1e-9);
  EXPECT_EQ(rssFollowingDistance({}, 0.0, 30.0), 0.0);
}

// Own: 10 + 1.75 + 13.5^2 / 6; other, 2 s: 20 + 7 + 17^2 / 8.
TEST(RssDriver, AddsBothStoppingPathsHeadOn) {
  EXPECT_NEAR(rssOncomingDistance({}, 10.0, 10.0), 11.75 + 30.375 + 27.0 + 36.125, 1e-9);
}

// 0.1 + (0.1 + 0.025) + (2 v + 0.4 + (v + 0.4)^2 / 1.6) at v = 1.
TEST(RssDriver, KeepsMoreRoomBesideAVehicleThatComesNearer) {
  EXPECT_NEAR(rssLateralDistance({}, 1.0), 0.225 + 2.4 + 1.96 / 1.6, 1e-9);
  EXPECT_NEAR(rssLateralDistance({}, 0.0), 0.225 + 0.4 + 0.1, 1e-9);
}

TEST(RssDriver, BrakesAResponseTimeAfterTheDistanceIsLost) {
  RssDriver driver;
  const auto course = testing::drive(driver, ownAt(kSpeed), {carAhead(35.0, 0.0)}, 8.0);
  ASSERT_TRUE(course.brake_time.has_value());
  // 35 - 27.59 = 7.41 m at 8.33 m/s: lost after 0.89 s.
  EXPECT_NEAR(*course.brake_time, 0.90 + 1.0, 0.051);
  EXPECT_FALSE(course.touched);
}

TEST(RssDriver, KnowsWhoIsSafe) {
  const RssDriver driver;
  const OwnMotion own = ownAt(8.0);
  EXPECT_FALSE(driver.isUnsafe(own, carAhead(10.0, 8.0, 3.2)));  // beside, 1.4 m apart
  EXPECT_TRUE(driver.isUnsafe(own, carAhead(10.0, 8.0, 2.0)));
  EXPECT_FALSE(driver.isUnsafe(own, carAhead(-14.0, 12.0)));  // behind: that one's duty
  EXPECT_TRUE(driver.isUnsafe(own, carAhead(60.0, -8.0)));
  EXPECT_FALSE(driver.isUnsafe(own, carAhead(60.0, -8.0, 3.2)));
  EXPECT_TRUE(driver.isUnsafe(own, carAcross(12.0, 8.0, 8.0)));    // 64 / 9.7 > 4
  EXPECT_FALSE(driver.isUnsafe(own, carAcross(16.0, 8.0, 8.0)));   // it is out before
  EXPECT_FALSE(driver.isUnsafe(own, carAcross(18.0, 14.0, 8.0)));  // 64 / 21.7: it can stop
}

}  // namespace
}  // namespace cdiff::reference_driver
