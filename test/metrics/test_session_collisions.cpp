// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;
using test::ego;

/// Ego at x = 0, CBVs a and b driving 100 m between ticks 0 and 1, then contacts at tick 2.
class SessionCollisions : public ::testing::Test {
 protected:
  SessionMeasures after(const std::vector<traffic::Contact>& contacts,
                        std::vector<traffic::Vehicle> last) {
    metrics_.observe(test::snapshot(0, {ego(0, 0, 5), cbv("a", 50, 0, 5), cbv("b", 60, 0, 5)}),
                     nullptr);
    metrics_.observe(test::snapshot(1, {ego(10, 0, 5), cbv("a", 100, 0, 5), cbv("b", 110, 0, 5)}),
                     nullptr);
    auto snapshot = test::snapshot(2, std::move(last));
    snapshot.contacts = contacts;
    metrics_.observe(snapshot, nullptr);
    return metrics_.measures();
  }
  const std::vector<traffic::Vehicle> present_{ego(10, 0, 5), cbv("a", 100, 0, 5),
                                               cbv("b", 110, 0, 5), background("c", 120, 0, 5)};
  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(SessionCollisions, BetweenEgoAndCbvCountForBoth) {
  // CBVs drove 100 m: 1 collision is 10 per km. Ego completed 10 % with one collision: 6.
  const SessionMeasures measures = after({{"a", "ego"}}, present_);
  EXPECT_EQ(*measures.at("ego_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_ego_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_moving_ego_collisions").value, 1U);
  EXPECT_NEAR(*measures.at("cbv_collisions_per_km").value, 10.0, 1e-9);
  EXPECT_EQ(measures.at("cbv_collisions_per_km").n, 2U);
  EXPECT_NEAR(*measures.at("cbv_ego_collisions_per_km").value, 10.0, 1e-9);
  EXPECT_NEAR(*measures.at("ego_driving_score").value, 6.0, 1e-9);
}

// 0.1 m/s and more is driving.
TEST_F(SessionCollisions, WithAStandingEgoAreCountedApart) {
  const SessionMeasures measures =
      after({{"a", "ego"}}, {ego(10, 0, 0.09), cbv("a", 15, 0, 5), cbv("b", 110, 0, 5)});
  EXPECT_EQ(*measures.at("cbv_ego_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_moving_ego_collisions").value, 0U);
  EXPECT_TRUE(measures.ego_contacts.at(0).with_cbv);
}

TEST_F(SessionCollisions, BetweenCbvAndBackgroundLeaveTheEgoAlone) {
  const SessionMeasures measures = after({{"a", "c"}}, present_);
  EXPECT_EQ(*measures.at("ego_collisions").value, 0U);
  EXPECT_EQ(*measures.at("cbv_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_ego_collisions").value, 0U);
  EXPECT_NEAR(*measures.at("cbv_collisions_per_km").value, 10.0, 1e-9);
  EXPECT_EQ(*measures.at("cbv_ego_collisions_per_km").value, 0.0);
}

TEST_F(SessionCollisions, BetweenEgoAndBackgroundLeaveTheCbvsAlone) {
  const SessionMeasures measures = after({{"c", "ego"}}, present_);
  EXPECT_EQ(*measures.at("ego_collisions").value, 1U);
  EXPECT_EQ(*measures.at("cbv_collisions").value, 0U);
}

TEST_F(SessionCollisions, BetweenTwoCbvsCountOnceButTwiceForRift) {
  // Decision ticks 0 and 2 lie 100 m of CBV route apart: 2 collided lives are 20 per km.
  const SessionMeasures measures = after({{"a", "b"}}, present_);
  EXPECT_EQ(*measures.at("cbv_collisions").value, 1U);
  EXPECT_NEAR(*measures.at("rift_compat_collisions_per_km").value, 20.0, 1e-9);
}

// The ego's partner stands first or second in a pair, by its id. The second contact is 20 m on and
// 0.05 s later: with another partner it is another collision, with the same one it would belong to
// the first.
TEST_F(SessionCollisions, OfTheEgoWithTwoPartnersAreTwo) {
  for (const auto& [first, second] :
       {std::pair<traffic::Contact, traffic::Contact>{{"a", "ego"}, {"c", "ego"}},
        {{"ego", "x"}, {"ego", "y"}}}) {
    SessionMetrics metrics({}, road_.drivable_area, road_.route);
    auto snapshot = test::snapshot(0, {ego(10, 0, 5)});
    snapshot.contacts = {first};
    metrics.observe(snapshot, nullptr);
    snapshot = test::snapshot(1, {ego(30, 0, 5)});
    snapshot.contacts = {second};
    metrics.observe(snapshot, nullptr);
    EXPECT_EQ(*metrics.measures().at("ego_collisions").value, 2U);
    EXPECT_EQ(*metrics.measures().at("ego_infraction_vehicle_collisions").value, 2.0)
        << first.first;
  }
}

TEST_F(SessionCollisions, CountForACbvThatTheContactRemoved) {
  const SessionMeasures measures = after({{"a", "c"}}, {ego(10, 0, 5), background("c", 120, 0, 5)});
  EXPECT_EQ(*measures.at("cbv_collisions").value, 1U);
}

TEST_F(SessionCollisions, OfAReleasedCbvAreNotIts) {
  const SessionMeasures measures =
      after({{"a", "c"}}, {ego(10, 0, 5), background("a", 100, 0, 5), background("c", 104, 0, 5)});
  EXPECT_EQ(*measures.at("cbv_collisions").value, 0U);
}

}  // namespace
}  // namespace cdiff::metrics
