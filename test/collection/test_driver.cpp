// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "collection/driver.h"

namespace cdiff::collection {
namespace {

TEST(Driver, HasOneStyleInRangeOfItsOwn) {
  const CollectionOptions options;
  for (const char* id : {"a", "b"}) {
    const planners::DrivingStyle style = driverOf(options, 1, id).style;
    EXPECT_EQ(style.acceleration, driverOf(options, 1, id).style.acceleration);
    EXPECT_GE(style.acceleration, 1.5);
    EXPECT_LE(style.acceleration, 3.5);
    EXPECT_GE(style.deceleration, 2.0);
    EXPECT_LE(style.deceleration, 4.0);
  }
  const planners::DrivingStyle first = driverOf(options, 1, "a").style;
  EXPECT_NE(first.acceleration, driverOf(options, 1, "b").style.acceleration);
  EXPECT_NE(first.minimum_gap, driverOf(options, 1, "b").style.minimum_gap);
  EXPECT_NE(first.acceleration, driverOf(options, 2, "a").style.acceleration);
}

TEST(Driver, PublishedPedalsLeaveThePedalsToThePlanner) {
  CollectionOptions options;
  options.pedals = "published";
  EXPECT_FALSE(driverOf(options, 1, "a").style.even());
}

TEST(CollectionSetup, HasPdmLiteFollowAsEachDriverDoes) {
  const CollectionOptions options;
  session::ScenarioOptions scenario = session::loadScenario("crossing_left_turn");
  scenario.seed = 7;
  const auto setup = collectionSetup(scenario, options);
  const auto& pdm_lite = setup->options().planner_options.of<planners::PdmLiteOptions>();
  for (const char* id : {"ego", "bg_3"}) {
    const planners::DrivingStyle style = pdm_lite.styles(id);
    EXPECT_EQ(style.acceleration, driverOf(options, 7, id).style.acceleration);
    EXPECT_EQ(style.minimum_gap, driverOf(options, 7, id).style.minimum_gap);
  }
}

}  // namespace
}  // namespace cdiff::collection
