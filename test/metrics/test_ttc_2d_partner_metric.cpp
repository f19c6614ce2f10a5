// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;
using test::ego;

/// The ego at 10 m/s at x = 20 on its route along y = 0. Boxes of 4.8 m x 1.8 m.
class Ttc2dPartnerMetric : public ::testing::Test {
 protected:
  void observe(std::vector<traffic::Vehicle> others) {
    others.insert(others.begin(), ego(20, 0, 10));
    metrics_.observe(test::snapshot(tick_, std::move(others)), nullptr);
    tick_ += 2;
  }
  static traffic::Vehicle heading(traffic::Vehicle vehicle, double degrees) {
    vehicle.state.heading = core::degreesToRadians(degrees);
    return vehicle;
  }
  double at(const char* name) const { return metrics_.measures().at(name).value.value_or(-1.0); }

  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
  std::uint64_t tick_ = 0;
};

TEST_F(Ttc2dPartnerMetric, TellsWhoSetsTheTime) {
  // Gaps of 20 - 4.8 = 15.2 m: 3.04 s at 5 m/s (following), 1.52 s to a standing vehicle, 0.76 s
  // at 20 m/s (oncoming: not following).
  observe({background("v", 40, 0, 5)});
  observe({cbv("a", 40, 0, 0), background("v", 60, 0, 5)});
  observe({heading(cbv("a", 40, 0, 10), 180), background("v", 60, 0, 5)});
  observe({heading(background("v", 40, 0, 10), 180)});
  observe({background("v", 10, 0, 5)});  // behind and slower: no time
  EXPECT_NEAR(at("ttc_following_percent"), 50.0, 1e-9);
  EXPECT_NEAR(at("ttc_following_cbv_percent"), 25.0, 1e-9);
  EXPECT_NEAR(at("ttc_cbv_share_percent"), 25.0, 1e-9);
  EXPECT_NEAR(at("ttc_background_share_percent"), 25.0, 1e-9);
  EXPECT_EQ(metrics_.measures().at("ttc_cbv_share_percent").n, 4U);
  EXPECT_NEAR(at("ttc_following_mean_s"), 0.5 * (3.04 + 1.52), 1e-9);
  EXPECT_NEAR(at("ttc_cbv_set_mean_s"), 0.76, 1e-9);
  EXPECT_NEAR(at("ttc_background_set_mean_s"), 0.76, 1e-9);
  // The mean of all is the mean of the three, weighted with their shares.
  EXPECT_NEAR(at("ttc_mean_s"), 0.5 * 2.28 + 0.25 * 0.76 + 0.25 * 0.76, 1e-9);
}

TEST_F(Ttc2dPartnerMetric, FollowingNeedsTheLaneAndItsDirection) {
  // Half a lane is 1.6 m. At y = 1.7 the boxes still overlap across (0.9 + 0.9).
  observe({background("v", 40, 1.5, 5)});
  EXPECT_EQ(at("ttc_following_percent"), 100.0);
  observe({background("v", 40, 1.7, 5)});
  EXPECT_NEAR(at("ttc_following_percent"), 50.0, 1e-9);
  observe({heading(background("v", 40, 0, 0), 44)});
  EXPECT_NEAR(at("ttc_following_percent"), 100.0 * 2 / 3, 1e-9);
  observe({heading(background("v", 40, 0, 0), 46)});
  EXPECT_NEAR(at("ttc_following_percent"), 50.0, 1e-9);
}

TEST_F(Ttc2dPartnerMetric, WhoComesFromBehindIsNotFollowed) {
  observe({background("v", 5, 0, 15)});  // 10.2 m at 5 m/s
  EXPECT_EQ(at("ttc_following_percent"), 0.0);
  EXPECT_EQ(at("ttc_background_share_percent"), 100.0);
  EXPECT_NEAR(at("ttc_background_set_mean_s"), 2.04, 1e-9);
}

TEST_F(Ttc2dPartnerMetric, IsAbsentWithoutATime) {
  observe({});
  const SessionMeasures measures = metrics_.measures();
  EXPECT_EQ(measures.at("ttc_following_percent").reason,
            "no vehicle was on a collision course with the ego");
  EXPECT_EQ(measures.at("ttc_cbv_set_mean_s").reason, "no such vehicle set the time to collision");
}

}  // namespace
}  // namespace cdiff::metrics
