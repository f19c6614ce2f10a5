// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/result_folder.h"
#include "support/temporary_folder.h"

namespace cdiff::record {
namespace {

traffic::Vehicle vehicle(const std::string& id, traffic::VehicleRole role, double x) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.state.position = {x, -2.5};
  vehicle.state.elevation = 77.0;
  vehicle.state.heading = 0.1;
  vehicle.state.speed = 1.0 / 3.0;
  return vehicle;
}

TEST(TraceWriter, WritesRowsInOrderWithShortestDecimals) {
  const test::TemporaryFolder scratch;
  core::OutputFolder output(scratch.path());
  TraceWriter writer(output);
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = 12;
  snapshot.vehicles = {vehicle("ego", traffic::VehicleRole::kEgo, 1e-7),
                       vehicle("bg,\"1\"", traffic::VehicleRole::kBackground, 100.0)};
  snapshot.vehicles.front().applied_action = traffic::ControlAction{0.5, -0.25, 0.0};
  writer.write(snapshot);
  writer.finish();
  EXPECT_EQ(core::readFile(scratch.path() / "trace.csv", "trace"),
            "tick,id,role,x,y,heading,speed,throttle,steer,brake\n"
            "12,ego,ego,1e-07,-2.5,0.1,0.3333333333333333,0.5,-0.25,0\n"
            "12,\"bg,\"\"1\"\"\",background,100,-2.5,0.1,0.3333333333333333,,,\n");
}

TEST(TraceWriter, HashIsThatOfTheFileBeyondOneBuffer) {
  const test::TemporaryFolder scratch;
  const auto file = scratch.path() / "trace.csv";
  core::OutputFolder output(scratch.path());
  TraceWriter writer(output);
  traffic::TrafficSnapshot snapshot;
  for (int i = 0; i < 50; ++i) {
    snapshot.vehicles.push_back(
        vehicle("v" + std::to_string(i), traffic::VehicleRole::kCbv, i / 3.0));
  }
  for (snapshot.tick = 0; snapshot.tick < 100; ++snapshot.tick) writer.write(snapshot);
  const std::string hash = writer.finish();
  const std::string content = core::readFile(file, "trace");
  EXPECT_GT(content.size(), std::size_t{1} << 17);
  EXPECT_EQ(std::count(content.begin(), content.end(), '\n'), 1 + 100 * 50);
  EXPECT_EQ(hash, core::sha256(content));
}

TEST(TraceWriter, LeavesNothingBehindWhenNotFinished) {
  const test::TemporaryFolder scratch;
  {
    core::OutputFolder output(scratch.path());
    TraceWriter writer(output);
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "trace.csv"));
    EXPECT_FALSE(std::filesystem::is_empty(scratch.path()));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(TraceWriter, ATraceThatIsNotOursIsNamedAndStays) {
  const test::TemporaryFolder scratch;
  const auto file = scratch.path() / "trace.csv";
  core::writeFileAtomically(file, "mine");
  core::OutputFolder output(scratch.path());
  try {
    TraceWriter writer(output);
    FAIL() << "a file of the user's was accepted";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
  }
  EXPECT_EQ(core::readFile(file, "trace"), "mine");
}

}  // namespace
}  // namespace cdiff::record
