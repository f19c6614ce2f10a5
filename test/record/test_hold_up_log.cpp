// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The ego on the street of record/crossing_streets.h: a tick is 0.05 s, and what it waits for is
// looked at each second and at the end.
#include <gtest/gtest.h>

#include "record/crossing_streets.h"
#include "record/logs/hold_up_log.h"

namespace cdiff::record {
namespace {

using traffic::SessionStatus;
using traffic::VehicleRole;

class HoldUps : public testing::Test {
 protected:
  /// The ego at x = 50 m, a vehicle that stands 10 m ahead of it and one far behind.
  traffic::TrafficSnapshot snapshot(std::uint64_t tick, double ego_speed,
                                    double other_speed) const {
    traffic::TrafficSnapshot now = test::snapshotWithEgo(tick, {50.0, 0.0, 0.0, ego_speed});
    now.vehicles.push_back(test::vehicle("ahead", {60.0}, role_));
    now.vehicles.back().lane_id = "west_0";
    now.vehicles.push_back(test::vehicle("behind", {20.0, 0.0, 0.0, other_speed}));
    return now;
  }
  /// Drives for a second, then stands until `last` while the one behind drives up to tick 60.
  const std::optional<HoldUp>& play(std::uint64_t last, SessionStatus status) {
    for (std::uint64_t tick = 0; tick <= last; ++tick) {
      traffic::TrafficSnapshot now = snapshot(tick, tick < 20 ? 8.0 : 0.0, tick <= 60 ? 5.0 : 0.0);
      if (tick == last) now.status = status;
      log_.observe(now);
    }
    return log_.found();
  }
  std::string text(SessionStatus status) const {
    return holdUpText(*log_.found(), streets_.setup(), status);
  }
  void expectIn(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
  }

  VehicleRole role_ = VehicleRole::kBackground;
  test::CrossingSetup streets_;
  HoldUpLog log_{streets_.setup()};
};

TEST_F(HoldUps, OfABlockedEgoIsWhoStandsAhead) {
  const std::optional<HoldUp>& found = play(100, SessionStatus::kBlocked);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->begin, 1.0, 1e-9);    // tick 20
  EXPECT_NEAR(found->seconds, 4.0, 1e-9);  // to tick 100
  EXPECT_TRUE(found->at_end);
  ASSERT_EQ(found->chain.waits.size(), 2U);
  EXPECT_EQ(found->chain.waits[0].obstacle, "ahead");
  EXPECT_NEAR(found->traffic_still.value_or(-1.0), 1.95, 1e-9);  // since tick 61
  EXPECT_TRUE(found->cbvs.empty());
  const std::string sentence = text(SessionStatus::kBlocked);
  for (const char* part :
       {"stood 4.0 s behind ahead", "had not moved for", "no CBV waits in this queue"})
    expectIn(sentence, part);
}

TEST_F(HoldUps, NameACbvOfTheQueue) {
  role_ = VehicleRole::kCbv;
  ASSERT_TRUE(play(100, SessionStatus::kBlocked));
  EXPECT_EQ(log_.found()->cbvs, std::vector<std::string>{"ahead"});
  expectIn(text(SessionStatus::kBlocked), "CBV with a part in it: ahead");
}

TEST_F(HoldUps, AreNoneOfASessionThatEndsOtherwise) {
  EXPECT_FALSE(play(100, SessionStatus::kCompleted));
}

TEST_F(HoldUps, OfATimeOutAreTheLongestStandstillAndTheTime) {
  play(100, SessionStatus::kRunning);  // stands for 4 s
  for (std::uint64_t tick = 101; tick <= 200; ++tick) {
    traffic::TrafficSnapshot now = snapshot(tick, 2.0, 5.0);  // then creeps behind the same
    if (tick == 200) now.status = SessionStatus::kTimedOut;
    log_.observe(now);
  }
  ASSERT_TRUE(log_.found());
  EXPECT_FALSE(log_.found()->at_end);
  EXPECT_NEAR(log_.found()->seconds, 4.0, 1e-9);
  EXPECT_NEAR(log_.found()->stood, 81 * 0.05, 1e-9);  // ticks 20 to 100
  EXPECT_NEAR(log_.found()->slow, 5.0, 1e-9);         // ticks 120, 140, ... 200
  EXPECT_EQ(log_.found()->held_behind, "ahead");
  // Before it at each look, the seconds 1 to 10, and for no longer than it stood and was slow.
  EXPECT_NEAR(log_.found()->held_behind_seconds, 81 * 0.05 + 5.0, 1e-9);
  const std::string sentence = text(SessionStatus::kTimedOut);
  for (const char* part : {"from 1.0 s on behind ahead", "s of this ahead was before it"})
    expectIn(sentence, part);
}

// Stands in ticks 20 to 59 and 90 to 119, and creeps at 0.8 m/s in the 30 ticks between.
TEST_F(HoldUps, CreepingIsStanding) {
  for (std::uint64_t tick = 0; tick <= 120; ++tick) {
    const double speed = tick < 20 ? 8.0 : (tick >= 60 && tick < 90 ? 0.8 : 0.0);
    traffic::TrafficSnapshot now = snapshot(tick, speed, 0.0);
    if (tick == 120) now.status = SessionStatus::kTimedOut;
    log_.observe(now);
  }
  ASSERT_TRUE(log_.found());
  EXPECT_TRUE(log_.found()->at_end);
  EXPECT_NEAR(log_.found()->seconds, 5.0, 1e-9);
  EXPECT_NEAR(log_.found()->crept, 1.5, 1e-9);
  EXPECT_NEAR(log_.found()->stood, 101 * 0.05, 1e-9);  // ticks 20 to 120
  expectIn(text(SessionStatus::kTimedOut), "stood 5.0 s (creeping for 1.5 s of it) behind ahead");
}

TEST_F(HoldUps, NameTheBackgroundTrafficAtTheEnd) {
  ASSERT_TRUE(play(100, SessionStatus::kBlocked));
  expectIn(text(SessionStatus::kBlocked), "ahead is background traffic");
}

TEST_F(HoldUps, WithAFreeRoadAreThePlannersOwn) {
  for (std::uint64_t tick = 0; tick <= 60; ++tick) {
    traffic::TrafficSnapshot now = test::snapshotWithEgo(tick, {50.0});
    if (tick == 60) now.status = SessionStatus::kBlocked;
    log_.observe(now);
  }
  ASSERT_TRUE(log_.found());
  EXPECT_FALSE(log_.found()->traffic_still);
  expectIn(text(SessionStatus::kBlocked), "its own planner, pdm_lite, held it");
}

TEST_F(HoldUps, OfATimeOutWithoutAStandstillAreTheTimeAlone) {
  for (std::uint64_t tick = 0; tick <= 40; ++tick) {
    traffic::TrafficSnapshot now = test::snapshotWithEgo(tick, {50.0, 0.0, 0.0, 8.0});
    if (tick == 40) now.status = SessionStatus::kTimedOut;
    log_.observe(now);
  }
  ASSERT_TRUE(log_.found());
  EXPECT_TRUE(log_.found()->chain.waits.empty());
  expectIn(text(SessionStatus::kTimedOut), "Nothing stopped the ego.");
}

}  // namespace
}  // namespace cdiff::record
