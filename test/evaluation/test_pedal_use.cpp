// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/pedal_use.h"
#include "evaluation/run_records.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using dynamics::PedalUse;

/// A trace of the CBV "bg_1" at 8 m/s, where u_0 is 0.45: at ticks 2 to 6 driven by throttle 0,
/// 0.29, 0.4, 0.5 and by the brake; at tick 8, after a tick without it, by 0.4. Ego and background
/// do not count, and neither does the row at which SUMO last drove it.
constexpr const char* kTrace =
    "1,ego,ego,0,0,0,8,0.4,0,0\n1,bg_1,background,9,0,0,8,,,\n"
    "2,ego,ego,0,0,0,8,0.4,0,0\n2,bg_1,cbv,9,0,0,8,0,0,0\n"
    "3,bg_1,cbv,9,0,0,8,0.29,0,0\n"
    "4,bg_1,cbv,9,0,0,8,0.4,0,0\n"
    "5,bg_1,cbv,9,0,0,8,0.5,0.1,0\n"
    "6,bg_1,cbv,9,0,0,8,0,0,0.3\n"
    "8,bg_1,cbv,9,0,0,8,0.4,0,0\n";

fs::path sessionIn(const fs::path& folder) {
  fs::create_directories(folder);
  core::writeFileAtomically(folder / "session.yaml", "schema_version: 1\n");
  core::writeFileAtomically(folder / "trace.csv", std::string(record::kTraceHeader) + kTrace);
  return folder;
}

TEST(PedalUse, CountsWhatEachPedalDidAtItsSpeed) {
  const test::TemporaryFolder scratch;
  const auto counts = pedalCounts(sessionIn(scratch.path() / "session"));
  ASSERT_EQ(counts.count("session"), 1U);
  const PedalCounts& found = counts.at("session");
  EXPECT_EQ(found.ticks(), 5U);
  EXPECT_EQ(found.count(PedalUse::kCoasting), 2U);
  EXPECT_EQ(found.count(PedalUse::kNotch), 1U);
  EXPECT_EQ(found.count(PedalUse::kDriving), 1U);
  EXPECT_EQ(found.count(PedalUse::kBraking), 1U);
  EXPECT_EQ(found.throttles()[0], 1U);
  EXPECT_EQ(found.throttles()[5], 1U);   // 0.29
  EXPECT_EQ(found.throttles()[8], 1U);   // 0.4
  EXPECT_EQ(found.throttles()[10], 1U);  // 0.5
  EXPECT_EQ(found.meanAcceleration(PedalUse::kCoasting), 0.0);
  // The fit at 28.8 km/h and u = 0.4 changes 28.8 by -0.0813 km/h a tick: 0.451 m/s^2.
  EXPECT_NEAR(found.meanAcceleration(PedalUse::kNotch), -0.451, 0.001);
}

TEST(PedalUse, PrintsSharesAndHistogram) {
  const test::TemporaryFolder scratch;
  const std::string text = pedalMarkdown(pedalCounts(sessionIn(scratch.path() / "session")));
  for (const char* line : {"| pedals of CBVs | session |\n| --- | --- |\n| ticks | 5 |\n",
                           "| notch: throttle from 0.3 up that brakes | 20.0 % (-0.45 m/s^2) |\n",
                           "| coasting: throttle below 0.3, or 0 | 40.0 % (0.00 m/s^2) |\n",
                           "| 0.40 to 0.45 | 20.0 % |\n", "| 0.95 to 1.00 | 0.0 % |\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
}

TEST(PedalUse, AFolderWithoutTracesIsRefused) {
  const test::TemporaryFolder scratch;
  EXPECT_THROW(pedalCounts(scratch.path()), core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
