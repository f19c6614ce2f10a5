// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "reference_driver/course.h"
#include "reference_driver/fuzzy_driver.h"

namespace cdiff::reference_driver {
namespace {

using testing::carAhead;
using testing::ownAt;

// v = 10, v_l = 5: d_unsafe = 7.5 + 100 / 12 - 25 / 14 = 14.05, d_safe = 7.5 + 12.5 - 1.786 + 2 =
// 20.21, on gap - 2.
TEST(FuzzyDriver, GradesTheGapBetweenUnsafeAndSafe) {
  EXPECT_EQ(proactiveSurrogate({}, 22.22, 10.0, 5.0), 0.0);
  EXPECT_EQ(proactiveSurrogate({}, 16.04, 10.0, 5.0), 1.0);
  EXPECT_NEAR(proactiveSurrogate({}, 2.0 + 0.5 * (14.048 + 20.214), 10.0, 5.0), 0.5, 1e-3);
}

// w = 0: 5 x 0.75 = 3.75, + 25 / 12 = 5.83 and + 25 / 8 = 6.875. w = -4: (10 - 1.5 - 5) 0.75 =
// 2.625, + 4 / 12 = 2.958 and + 4 / 8 = 3.125.
TEST(FuzzyDriver, GradesTheCriticalGapByTheAcceleration) {
  OwnMotion own = ownAt(10.0);
  EXPECT_EQ(criticalSurrogate({}, 8.88, own, 5.0), 0.0);
  EXPECT_EQ(criticalSurrogate({}, 7.83, own, 5.0), 1.0);
  EXPECT_NEAR(criticalSurrogate({}, 2.0 + 0.5 * (5.8333 + 6.875), own, 5.0), 0.5, 1e-3);
  own.acceleration = -6.0;
  EXPECT_EQ(criticalSurrogate({}, 5.13, own, 5.0), 0.0);
  EXPECT_EQ(criticalSurrogate({}, 4.95, own, 5.0), 1.0);
  EXPECT_EQ(criticalSurrogate({}, 1.0, own, 10.0), 0.0);
}

// At 8 m/s before a standing car it begins at d_safe = 6 + 8 + 2 on gap - 2: 18 m.
TEST(FuzzyDriver, BrakesGentlyWellBeforeAStandingCar) {
  FuzzyDriver driver;
  const auto course = testing::drive(driver, ownAt(8.0), {carAhead(26.0, 0.0)}, 12.0);
  ASSERT_TRUE(course.brake_time.has_value());
  EXPECT_NEAR(*course.brake_time, 1.0 + 0.75, 0.051);
  EXPECT_FALSE(course.touched);
}

}  // namespace
}  // namespace cdiff::reference_driver
