// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// SUMO in this process: one session at a time, one after another, and as SUMO in a process.
#include <gtest/gtest.h>
#include <unistd.h>

#include "e2e_cdiff/core/exceptions.h"
#include "simulation/crossing_world.h"

namespace cdiff {
namespace {

using simulation::SumoSession;
using simulation::SumoSimulator;

class InProcessLink : public testing::Test {
 protected:
  InProcessLink() : made_(test::makeCrossing(folder_, false)) {
    session_.network_file = made_.file;
    session_.link = "libsumo";
  }
  /// Where SUMO has a vehicle of its own after 2 s.
  double driven() const {
    SumoSimulator simulator({}, session_, made_.network);
    EXPECT_TRUE(simulator.addBackground("car", {"west", "east"}, 50.0, 0, 8.0, {}));
    for (int i = 0; i < 40; ++i) simulator.step({});
    EXPECT_EQ(simulator.vehicles().size(), 1U);
    return simulator.vehicles().front().state.position.x();
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
  SumoSession session_;
};

TEST_F(InProcessLink, RunsHereAsAProcessDoes) {
  const double here = driven();
  EXPECT_EQ(driven(), here) << "the second session of this process";
  session_.link = "libtraci";
  EXPECT_EQ(driven(), here);
}

TEST_F(InProcessLink, HasOneSessionAtATime) {
  {
    SumoSimulator first({}, session_, made_.network);
    EXPECT_EQ(first.processId(), ::getpid());
    EXPECT_EQ(first.version().substr(0, 4), "SUMO");
    EXPECT_THROW(SumoSimulator({}, session_, made_.network), core::SimulatorError);
    first.step({});
  }
  SumoSimulator({}, session_, made_.network).step({});
}

}  // namespace
}  // namespace cdiff
