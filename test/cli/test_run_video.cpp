// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "support/program_run.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

int exitCodeOf(const fs::path& program, const std::vector<std::string>& arguments,
               const fs::path& output) {
  return test::ProgramRun(program, arguments, output).wait();
}

/// One session of 3 simulated seconds into a folder of `scratch`.
std::vector<std::string> sessionIn(const fs::path& folder, const std::string& video) {
  return {"run",          "arterial_exit",         "--cbv-planner", "pdm_lite",
          "--set",        "protocol.time_limit=3", "--set",         "video=" + video,
          "--set",        "verdict.judge=false",   "--quiet",       "--results",
          folder.string()};
}

TEST(RunVideo, AnOptionOfTheScenarioGivesAVideoAndItsAbsenceNone) {
  const test::TemporaryFolder scratch;
  const fs::path folder = scratch.path() / "results";
  const fs::path output = scratch.path() / "output";
  ASSERT_EQ(exitCodeOf(CDIFF_PROGRAM, sessionIn(folder, "true"), output), 0)
      << core::readFile(output, "output");
  ASSERT_TRUE(fs::exists(folder / "session.mp4"));
  // Ticks 0, 2 ... 60 of 0.05 s, then two seconds with the verdict.
  exitCodeOf("/usr/bin/ffprobe",
             {"-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of",
              "csv=p=0", (folder / "session.mp4").string()},
             output);
  EXPECT_EQ(core::readFile(output, "output"), "51\n");
  const std::string trace = core::readFile(folder / "trace.csv", "trace");
  // Another session into the same folder, without a video: none is left, and the trace is the same.
  std::vector<std::string> again = sessionIn(folder, "false");
  again.push_back("--overwrite");
  ASSERT_EQ(exitCodeOf(CDIFF_PROGRAM, again, output), 0);
  EXPECT_FALSE(fs::exists(folder / "session.mp4"));
  EXPECT_EQ(core::readFile(folder / "trace.csv", "trace"), trace);
}

}  // namespace
}  // namespace cdiff::evaluation
