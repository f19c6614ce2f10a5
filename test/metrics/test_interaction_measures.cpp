// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "metrics/formulas/ttc_2d.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::ego;

Interaction around(const std::vector<traffic::Vehicle>& vehicles, InteractionOptions options = {}) {
  const auto snapshot = test::snapshot(0, vehicles);
  return interactionOf(snapshot.vehicles.front(), snapshot, options);
}

TEST(InteractionOf, TakesMinimaOverVehicles) {
  // Gaps 15.2 m and 25.2 m at 10 m/s; the nearest box is 15.2 m away.
  const auto interaction = around(
      {ego(0, 0, 10), background("b", 30, 0, 0), background("a", 20, 0, 0)}, {60.0, 3600.0, true});
  EXPECT_NEAR(*interaction.ttc_2d, 1.52, 1e-12);
  EXPECT_NEAR(*interaction.rift_ttc, 1.52, 1e-12);
  EXPECT_NEAR(*interaction.nearest_distance, 15.2, 1e-12);
}

TEST(InteractionOf, TakesTheNearestBoxNotTheNearestCenter) {
  // Beside: 8 - 1.8 = 6.2 m. Ahead a truck of 12 m: 14 - 2.4 - 6 = 5.6 m.
  auto truck = background("truck", 14, 0, 0);
  truck.dimensions.length = 12.0;
  EXPECT_NEAR(*around({ego(0, 0, 0), background("a", 0, 8, 0), truck}).nearest_distance, 5.6,
              1e-12);
}

TEST(InteractionOf, IsEmptyForTheEgoAlone) {
  const auto interaction = around({ego(0, 0, 10)}, {60.0, 3600.0, true});
  EXPECT_FALSE(interaction.ttc_2d || interaction.rift_ttc || interaction.nearest_distance);
}

TEST(InteractionOf, LooksWithinTheRadius) {
  EXPECT_TRUE(around({ego(0, 0, 10), background("a", 60, 0, 0)}).ttc_2d.has_value());
  const auto far = around({ego(0, 0, 10), background("a", 60.01, 0, 0)});
  EXPECT_FALSE(far.ttc_2d.has_value());
  EXPECT_NEAR(*far.nearest_distance, 55.21, 1e-9);  // 60.01 - 4.8
}

TEST(InteractionOf, KeepsToTheEgosLevel) {
  auto bridge = background("bridge", 20, 0, 0);
  bridge.state.elevation = 6.0;
  const auto interaction = around({ego(0, 0, 10), bridge});
  EXPECT_FALSE(interaction.ttc_2d || interaction.nearest_distance);
}

TEST(InteractionOf, DropsTimesAboveTheLimit) {
  // 15.2 m at 0.001 m/s: 15200 s.
  EXPECT_FALSE(around({ego(0, 0, 10), background("a", 20, 0, 9.999)}).ttc_2d.has_value());
}

TEST(InteractionOf, PassesOverValuesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto interaction =
      around({ego(0, 0, 10), background("bad", 10, nan, 0), background("good", 20, 0, 0)});
  EXPECT_NEAR(*interaction.ttc_2d, 1.52, 1e-12);
  EXPECT_NEAR(*interaction.nearest_distance, 15.2, 1e-12);
  EXPECT_FALSE(around({ego(nan, 0, 10), background("a", 20, 0, 0)}).ttc_2d.has_value());
}

}  // namespace
}  // namespace cdiff::metrics
