// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "reference_driver/careful_driver.h"
#include "reference_driver/course.h"

namespace cdiff::reference_driver {
namespace {

using testing::carAcross;
using testing::carAhead;
using testing::Course;
using testing::drive;
using testing::ownAt;

constexpr double kSlow = 30.0 / 3.6;
constexpr double kFast = 60.0 / 3.6;

Course driven(const OwnMotion& own, const std::vector<SeenVehicle>& others, double seconds,
              const std::function<void(double, std::vector<SeenVehicle>&)>& change = {}) {
  CarefulDriver driver;
  return drive(driver, own, others, seconds, change);
}

// D(v) = 1.45 v + v^2 / 15.186 - 7.593 x 0.36 / 24. At 30 km/h: 12.083 + 4.573 - 0.114; at 50 km/h:
// 20.139 + 12.703 - 0.114. The time is 1.45 + v / 7.593.
TEST(CarefulDriver, StopsInTheRegulationsTimeAndDistance) {
  const CarefulDriverOptions options;
  EXPECT_NEAR(options.stoppingDistance(kSlow), 16.54, 0.01);
  EXPECT_NEAR(options.stoppingDistance(50.0 / 3.6), 32.73, 0.01);
  EXPECT_NEAR(options.stoppingTime(kSlow), 2.548, 0.001);
}

// It needs 1.45 v_r + v_r^2 / 2a - 0.114 = 8.056 + 2.033 - 0.114 = 9.97 m from the evidence on, at
// v_r = 20 km/h. The other comes nearer at 1.2 m/s: by 0.375 m within 0.35 s, in which 1.94 m of
// the gap are gone.
TEST(CarefulDriver, AnswersACutInFromTenMetersOnly) {
  const auto cutIn = [](double gap) {
    SeenVehicle other = carAhead(gap + 1.944, 40.0 / 3.6, 3.5);
    return driven(ownAt(kFast), {other}, 6.0, [](double, std::vector<SeenVehicle>& others) {
      others[0].across_speed = others[0].offset > 0.05 ? -1.2 : 0.0;
    });
  };
  const Course answered = cutIn(10.3);
  EXPECT_FALSE(answered.touched);
  ASSERT_TRUE(answered.brake_time.has_value());
  EXPECT_NEAR(*answered.brake_time, 0.35 + 1.15, 0.051);
  EXPECT_TRUE(cutIn(9.6).touched);
}

TEST(CarefulDriver, LeavesAVehicleAloneThatKeepsItsOffset) {
  SeenVehicle beside = carAhead(3.0, 40.0 / 3.6, 3.5);
  EXPECT_FALSE(driven(ownAt(kFast), {beside}, 5.0).brake_time.has_value());
  beside.across_speed = -0.05;  // 0.25 m within 5 s
  EXPECT_FALSE(driven(ownAt(kFast), {beside}, 5.0).brake_time.has_value());
}

// At 60 km/h both, the lead brakes with 8 m/s^2 and stands after 277.8 / 16 = 17.36 m; the driver
// needs 24.167 + 18.292 - 0.114 = 42.34 m: a gap of 24.98 m.
TEST(CarefulDriver, AnswersABrakingLeadFromTwentyFiveMetersOnly) {
  const auto braking = [](double gap) {
    SeenVehicle lead = carAhead(gap, kFast);
    lead.acceleration = -8.0;
    return driven(ownAt(kFast), {lead}, 6.0);
  };
  const Course answered = braking(25.6);
  EXPECT_FALSE(answered.touched);
  EXPECT_EQ(answered.own.speed, 0.0);
  EXPECT_NEAR(answered.gap, 0.6, 0.3);
  EXPECT_TRUE(braking(24.4).touched);
}

// Seen from afar, a standing car is a risk from a TTC of 2.5 s on: 20.8 m, of which 16.54 are
// needed. Behind a lead it is hidden: a cut-out that reveals it 14 m ahead cannot be answered.
TEST(CarefulDriver, SeesBehindALeadOnlyWhenItCutsOut) {
  SeenVehicle standing = carAhead(29.95, 0.0);
  EXPECT_FALSE(driven(ownAt(kSlow), {standing}, 8.0).touched);
  SeenVehicle lead = carAhead(8.0, kSlow);
  lead.id = 2;
  const auto revealed = [&](double gap) {
    return driven(ownAt(kSlow), {standing, lead}, 8.0,
                  [&](double time, std::vector<SeenVehicle>& others) {
                    const bool out = 29.95 - kSlow * time <= gap;
                    if (out) others[1].offset = 4.0;
                  });
  };
  EXPECT_FALSE(revealed(17.2).touched);
  EXPECT_TRUE(revealed(14.0).touched);
}

// The center 20 m beside the path at 8 m/s: it can stop before the corridor (half width 0.9 m +
// half length 2.25 m) with 3 m/s^2 up to 64 / 6 = 10.67 m, so until (20 - 3.15 - 10.67) / 8 = 0.77
// s.
TEST(CarefulDriver, BrakesForACrossingCarThatCanNoLongerYield) {
  const Course crossing = driven(ownAt(8.0), {carAcross(22.0, 20.0, 8.0)}, 6.0);
  ASSERT_TRUE(crossing.brake_time.has_value());
  EXPECT_NEAR(*crossing.brake_time, 1.15, 0.051);
  // It comes 4 s later: the driver is gone.
  EXPECT_FALSE(driven(ownAt(8.0), {carAcross(10.0, 32.0, 8.0)}, 3.0).brake_time.has_value());
}

// It could stop within half a meter, and is not expected to. It enters the corridor after 2.1 m.
TEST(CarefulDriver, BrakesForAPedestrianWhoCouldStillStop) {
  SeenVehicle walker = carAcross(30.0, 3.3, 1.1);
  walker.half_along = 0.2;
  walker.half_across = 0.3;
  const Course course = driven(ownAt(8.0), {walker}, 4.0);
  ASSERT_TRUE(course.brake_time.has_value());
  EXPECT_LT(*course.brake_time, 1.3);
  EXPECT_FALSE(course.touched);
}

TEST(CarefulDriver, LeavesACrossingCarAloneThatYields) {
  const auto yielding = [](double time, std::vector<SeenVehicle>& others) {
    // 3 m/s^2 from 8 m/s: 10.7 m, of 20 - 3.15; 1.5 would do after 0.7 s.
    others[0].across_speed = std::max(0.0, 8.0 - 3.0 * time);
  };
  EXPECT_FALSE(
      driven(ownAt(8.0), {carAcross(24.0, 20.0, 8.0)}, 4.0, yielding).brake_time.has_value());
}

TEST(CarefulDriver, BrakesForAnOncomingCarOnlyOverTheCenterLine) {
  EXPECT_FALSE(driven(ownAt(8.0), {carAhead(60.0, -8.0, 3.2)}, 4.0).brake_time.has_value());
  EXPECT_TRUE(driven(ownAt(8.0), {carAhead(60.0, -8.0, 1.0)}, 4.0).brake_time.has_value());
  SeenVehicle drifts = carAhead(60.0, -8.0, 3.2);
  drifts.across_speed = -0.2;  // over the line, 0.7 m from the corridor, after 3.5 s
  EXPECT_FALSE(driven(ownAt(8.0), {drifts}, 3.0).brake_time.has_value());
}

// At 45 degrees and 8 m/s both, it merges 16 m ahead.
TEST(CarefulDriver, BrakesForAMergingCar) {
  SeenVehicle merging = carAcross(16.0, 9.0, 4.0);
  merging.along_speed = 4.0;
  merging.half_along = merging.half_across = 0.5 * 0.7071 * (4.5 + 1.8);
  const Course course = driven(ownAt(8.0), {merging}, 4.0);
  EXPECT_TRUE(course.brake_time.has_value());
  EXPECT_FALSE(course.touched);
}

TEST(CarefulDriver, ReleasesTheBrakeOnceItIsClear) {
  CarefulDriver driver;
  OwnMotion own = ownAt(8.0);
  const SeenVehicle near = carAhead(12.0, 0.0);
  for (int i = 0; i < 24; ++i) {
    driver.brake(own, {near}, 0.05);
    own.time += 0.05;
  }
  EXPECT_TRUE(driver.perceives());
  EXPECT_GT(driver.brake(own, {near}, 0.05), 0.0);
  own.time += 0.05;
  EXPECT_EQ(driver.brake(own, {}, 0.05), 0.0);
  EXPECT_FALSE(driver.perceives());
}

TEST(CarefulDriver, WaitsLongerWhenItIsDelayed) {
  CarefulDriver driver;
  driver.delayBy(0.5);
  const Course course = drive(driver, ownAt(8.0), {carAhead(15.9, 0.0)}, 3.0);
  ASSERT_TRUE(course.brake_time.has_value());
  EXPECT_NEAR(*course.brake_time, 1.65, 1e-9);
}

// 7.593 / 0.6 = 12.655 m/s^3: 0.633 after 0.05 s. Where another drives, the pedal is not yet down.
TEST(CarefulDriver, PutsThePedalDownAnewWhereAnotherDroveOn) {
  BrakeRamp ramp;
  OwnMotion own = ownAt(8.0);
  double last = 0.0;
  for (int i = 0; i < 12; ++i) {
    last = ramp.press(7.593, 12.655, 0.05, own);
    own.acceleration = -last;
  }
  EXPECT_NEAR(last, 7.593 - 0.5 * 0.633, 0.01);
  own.acceleration = 0.0;
  EXPECT_NEAR(ramp.press(7.593, 12.655, 0.05, own), 0.5 * 0.633, 0.01);
}

// 1.0 s at 2 m/s, 1.6 s at 60 km/h, 1.3 s halfway, 2 m at least.
TEST(CarefulDriver, FollowsInTheRegulationsDistance) {
  EXPECT_NEAR(followingGap(2.0), 2.0, 1e-9);
  EXPECT_NEAR(followingGap(0.0), 2.0, 1e-9);
  EXPECT_NEAR(followingGap(0.5 * (2.0 + kFast)), 1.3 * 0.5 * (2.0 + kFast), 1e-9);
  EXPECT_NEAR(followingGap(kFast), 26.67, 0.01);
}

std::string refusalOf(const CarefulDriverOptions& options, double top_speed) {
  try {
    options.validate(top_speed, "careful_driver.");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CarefulDriver, RefusesWhatCannotBeDriven) {
  CarefulDriverOptions options;
  EXPECT_EQ(refusalOf(options, 20.0), "");
  options.delay = -0.1;
  EXPECT_EQ(refusalOf(options, 20.0),
            "key 'careful_driver.delay' is -0.1; expected a time of at least 0 s");
  options = {};
  options.horizon = 2.0;
  EXPECT_EQ(
      refusalOf(options, 20.0).rfind("key 'careful_driver.horizon' is 2; expected at least", 0),
      0U);
  EXPECT_TRUE(options.stopsFrom(4.0));
  EXPECT_FALSE(options.stopsFrom(5.0));  // 1.45 + 0.66 s
}

}  // namespace
}  // namespace cdiff::reference_driver
