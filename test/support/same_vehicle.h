// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Every field of a vehicle held against another's, to the last bit.
#pragma once

#include <gtest/gtest.h>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::test {

inline void expectSame(const traffic::Vehicle& found, const traffic::Vehicle& expected) {
  EXPECT_EQ(found.id, expected.id);
  EXPECT_EQ(found.role, expected.role);
  EXPECT_EQ(found.cbv_slot, expected.cbv_slot);
  EXPECT_EQ(found.state.position, expected.state.position);
  EXPECT_EQ(found.state.elevation, expected.state.elevation);
  EXPECT_EQ(found.state.heading, expected.state.heading);
  EXPECT_EQ(found.state.speed, expected.state.speed);
  EXPECT_EQ(found.dimensions.length, expected.dimensions.length);
  EXPECT_EQ(found.dimensions.width, expected.dimensions.width);
  EXPECT_EQ(found.dimensions.height, expected.dimensions.height);
  EXPECT_EQ(found.acceleration, expected.acceleration);
  EXPECT_EQ(found.yaw_rate, expected.yaw_rate);
  EXPECT_EQ(found.applied_action, expected.applied_action);
  EXPECT_EQ(found.lane_id, expected.lane_id);
}

}  // namespace cdiff::test
