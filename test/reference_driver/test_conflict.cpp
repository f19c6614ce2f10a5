// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <string>

#include "reference_driver/conflict.h"
#include "reference_driver/course.h"

namespace cdiff::reference_driver {
namespace {

using testing::carAcross;
using testing::carAhead;
using testing::ownAt;

TEST(Conflict, NamesItsKindByTheAngle) {
  const OwnMotion own = ownAt(8.0);
  const auto kind = [&](double along, double across, double offset) {
    SeenVehicle other = carAhead(10.0, along, offset);
    other.across_speed = across;
    return std::string(toText(conflictOf(own, own.speed, other).kind));
  };
  EXPECT_EQ(kind(5.0, 0.0, 0.0), "lead");
  EXPECT_EQ(kind(0.0, 0.0, 0.0), "lead");
  EXPECT_EQ(kind(5.0, -1.0, 3.5), "cut_in");
  EXPECT_EQ(kind(5.0, -5.0, 5.0), "merge");
  EXPECT_EQ(kind(0.5, -5.0, 5.0), "crossing");
  EXPECT_EQ(kind(-5.0, 0.2, 3.5), "oncoming");
  EXPECT_EQ(kind(-5.0, 0.2, 0.0), "oncoming");
}

// 20 m ahead of the bumper, 3 m/s slower: 6.67 s.
TEST(Conflict, OfALeadBeginsAtItsTimeToCollision) {
  const Conflict conflict = conflictOf(ownAt(8.0), 8.0, carAhead(20.0, 5.0));
  EXPECT_NEAR(conflict.gap, 20.0, 1e-9);
  EXPECT_NEAR(conflict.beside.begin, 20.0 / 3.0, 1e-9);
  EXPECT_TRUE(meets(conflict, 7.0, 0.0));
  EXPECT_FALSE(meets(conflict, 6.0, 0.0));
}

// The corridor reaches 0.9 + 2.25 = 3.15 m to each side of a crossing car's center, which is there
// from (20 - 3.15) / 8 = 2.11 s to 2.89 s; the driver is beside it from (22 - 3.15) / 8 to 3.14 s.
TEST(Conflict, OfACrossingCarIsWhenBothAreThere) {
  const Conflict conflict = conflictOf(ownAt(8.0), 8.0, carAcross(22.0, 20.0, 8.0));
  EXPECT_NEAR(conflict.in_corridor.begin, 2.106, 0.001);
  EXPECT_NEAR(conflict.in_corridor.end, 2.894, 0.001);
  EXPECT_NEAR(conflict.beside.begin, 2.356, 0.001);
  EXPECT_NEAR(conflict.beside.end, 3.144, 0.001);
  EXPECT_NEAR(conflict.stops_before, 64.0 / (2.0 * 16.85), 0.001);
  EXPECT_TRUE(meets(conflict, 4.0, 0.0));
  EXPECT_FALSE(meets(conflict, 2.0, 0.0));
}

// 1.5 s apart: it is out at 2.89 s, the driver comes at (34.3 - 3.15) / 8 = 3.89 s.
TEST(Conflict, CountsAMissByLessThanTheArrivalGap) {
  const Conflict conflict = conflictOf(ownAt(8.0), 8.0, carAcross(34.3, 20.0, 8.0));
  EXPECT_FALSE(meets(conflict, 4.0, 0.9));
  EXPECT_TRUE(meets(conflict, 4.0, 1.1));
}

}  // namespace
}  // namespace cdiff::reference_driver
