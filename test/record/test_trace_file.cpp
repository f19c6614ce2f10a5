// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "e2e_cdiff/core/exceptions.h"
#include "record/result_folder.h"
#include "record/sample_session.h"
#include "support/temporary_folder.h"

namespace cdiff::record {
namespace {

std::string errorOf(const std::string& text) {
  const test::TemporaryFolder scratch;
  const auto file = scratch.path() / "trace.csv";
  std::ofstream(file) << text;
  try {
    readTrace(file);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TraceFile, ReadsBackWhatTheWriterWrote) {
  const test::TemporaryFolder scratch;
  core::OutputFolder output(scratch.path());
  TraceWriter writer(output);
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(53);
  snapshot.vehicles[2].id = "a,\"b\"\nc";
  writer.write(snapshot);
  writer.finish();
  const std::vector<TraceRow> rows = readTrace(scratch.path() / "trace.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].role, traffic::VehicleRole::kCbv);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const traffic::Vehicle& vehicle = snapshot.vehicles[i];
    EXPECT_EQ(rows[i].tick, 53U);
    EXPECT_EQ(rows[i].id, vehicle.id);
    EXPECT_EQ(rows[i].role, vehicle.role);
    EXPECT_EQ(rows[i].position, vehicle.state.position);  // to the last bit
    EXPECT_EQ(rows[i].heading, vehicle.state.heading);
    EXPECT_EQ(rows[i].speed, vehicle.state.speed);
    EXPECT_EQ(rows[i].action, vehicle.applied_action);
  }
  EXPECT_TRUE(rows[1].action);
}

TEST(TraceFile, NamesTheLineThatIsDamaged) {
  const std::string head = kTraceHeader;
  EXPECT_NE(errorOf("a,b\n").find("is no trace"), std::string::npos);
  EXPECT_EQ(errorOf(head), "");
  EXPECT_EQ(errorOf(head + "0,ego,ego,1,2,0,3,,,\n"), "");
  for (const char* line :
       {"0,ego,ego,1,2,0,3,,,", "0,ego,ego,1,2,0,nan,,,\n", "0,ego,bus,1,2,0,3,,,\n",
        "0,ego,ego,1,2\n", "0,ego,ego,1,2,0,3,0.5,,0\n", "0,ego,ego,1,2,0,3,0.5,0,x\n"}) {
    const std::string error = errorOf(head + "0,ego,ego,1,2,0,3,,,\n" + line);
    EXPECT_NE(error.find("trace.csv:3: no row of a trace"), std::string::npos) << line << error;
  }
  // An id over two lines counts as two; a quote that nothing closes is named where its row starts.
  const std::string two_lines = head + "0,\"a\nb\",ego,1,2,0,3,,,\n";
  EXPECT_NE(errorOf(two_lines + "x\n").find("trace.csv:4: "), std::string::npos);
  EXPECT_NE(errorOf(two_lines + "0,\"a,ego,1,2,0,3,,,\n").find("trace.csv:4: "), std::string::npos);
}

}  // namespace
}  // namespace cdiff::record
