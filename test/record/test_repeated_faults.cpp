// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "record/repeated_faults.h"

namespace cdiff::record {
namespace {

TEST(RepeatedFaults, EqualOnesAreOneThatSaysHowOftenAndWhen) {
  std::vector<traffic::Fault> faults;
  for (std::uint64_t tick = 20; tick < 40; tick += 2)
    faults.push_back({tick, "ego:external", "too far left"});
  const std::vector<RepeatedFault> repeated = repeatedFaults(faults);
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_EQ(repeated[0].times, 10U);
  EXPECT_EQ(repeated[0].fault.tick, 20U);
  EXPECT_EQ(repeated[0].last_tick, 38U);
  EXPECT_EQ(repeated[0].text(), "too far left (10 times, ticks 20 to 38)");
}

TEST(RepeatedFaults, LastFaultStaysTheLast) {
  const std::vector<RepeatedFault> repeated =
      repeatedFaults({{1, "a", "x"}, {2, "b", "x"}, {3, "a", "y"}, {4, "a", "x"}});
  ASSERT_EQ(repeated.size(), 3U);
  EXPECT_EQ(repeated[0].fault.source, "b");
  EXPECT_EQ(repeated[0].text(), "x");
  EXPECT_EQ(repeated[2].fault.tick, 1U);
  EXPECT_EQ(repeated[2].last_tick, 4U);
  EXPECT_TRUE(repeatedFaults({}).empty());
}

}  // namespace
}  // namespace cdiff::record
