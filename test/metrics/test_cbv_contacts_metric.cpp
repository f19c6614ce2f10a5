// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;

traffic::Vehicle aTickBefore(traffic::Vehicle vehicle) {
  vehicle.state.position -= 0.05 * vehicle.state.velocity();
  return vehicle;
}

/// CBV a drives 50 m and then meets another vehicle of 4.8 m: contact at 4.8 m.
class CbvContactsMetric : public ::testing::Test {
 protected:
  using Values = std::vector<double>;
  /// Counts and rates after the two began to overlap.
  Values meet(const traffic::Vehicle& own, const traffic::Vehicle& other) {
    traffic::Vehicle start = own;
    start.state.position.x() -= 50.0;
    metrics_.observe(test::snapshot(0, {start}), nullptr);
    metrics_.observe(test::snapshot(1, {aTickBefore(own), aTickBefore(other)}), nullptr);
    auto last = test::snapshot(2, {own, other});
    last.contacts = {{own.id, other.id}};
    metrics_.observe(last, nullptr);
    const SessionMeasures measures = metrics_.measures();
    Values values;
    for (const char* name : {"cbv_contacts_struck_background", "cbv_contacts_by_background",
                             "cbv_contacts_with_cbv", "cbv_contacts_struck_background_per_km",
                             "cbv_contacts_by_background_per_km", "cbv_contacts_with_cbv_per_km"})
      values.push_back(std::round(1e6 * measures.at(name).value.value_or(-1.0)) / 1e6);
    return values;
  }

  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

// One contact in 50 m is 20 per km.
TEST_F(CbvContactsMetric, ACbvStrikesFromBehind) {
  EXPECT_EQ(meet(cbv("a", 100, 0, 6), background("v", 104.6, 0, 1)), (Values{1, 0, 0, 20, 0, 0}));
}

TEST_F(CbvContactsMetric, ACbvIsStruckFromBehind) {
  EXPECT_EQ(meet(cbv("a", 100, 0, 2), background("v", 95.4, 0, 8)), (Values{0, 1, 0, 0, 20, 0}));
}

TEST_F(CbvContactsMetric, TwoCbvsCountOnce) {
  // b drives 8 x 0.05 = 0.4 m as CBV, too: 1000 / 50.4.
  EXPECT_EQ(meet(cbv("a", 100, 0, 2), cbv("b", 95.4, 0, 8)), (Values{0, 0, 1, 0, 0, 19.84127}));
}

TEST_F(CbvContactsMetric, ContactsWithTheEgoAreTheEgos) {
  EXPECT_EQ(meet(cbv("a", 100, 0, 6), test::ego(104.6, 0, 1)), (Values{0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace cdiff::metrics
