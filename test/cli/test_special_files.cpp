// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Pipes, and links to a device without end, where a file is to be read: named at once, by every
// command. A command that waits or reads on is ended, which fails the test.
#include <sys/stat.h>

#include "cli/evaluate_command.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

/// What is put in the place of a file.
enum class Special { kPipe, kZeros };

class SpecialFiles : public test::EvaluateCommand {
 protected:
  SpecialFiles() { ::setenv("TMPDIR", scratch_.path().c_str(), 1); }
  ~SpecialFiles() override { ::unsetenv("TMPDIR"); }
  static void put(const fs::path& file, Special special) {
    fs::remove(file);
    if (special == Special::kPipe) {
      ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0) << file;
    } else {
      fs::create_symlink("/dev/zero", file);
    }
  }
  /// Exit code; 128 + the signal where it used all of its memory or processor time, or waited.
  int bounded(const Words& arguments) const {
    Words words = {"--cpu=20", "--as=6000000000", CDIFF_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    test::ProgramRun run("/usr/bin/prlimit", words, scratch_.path() / "output");
    run.setDeadline(60.0);
    return run.wait();
  }
  /// The command names each special file at `file` as bad input.
  void expectRefused(const fs::path& file, const Words& arguments) const {
    const bool was_file = fs::is_regular_file(file);
    const std::string content = was_file ? core::readFile(file, "file") : "";
    for (const Special special : {Special::kPipe, Special::kZeros}) {
      put(file, special);
      EXPECT_EQ(bounded(arguments), 3) << file << "\n" << output();
      expectOutput(file.filename().string());
    }
    fs::remove(file);
    if (was_file) std::ofstream(file) << content;
  }
};

TEST_F(SpecialFiles, AsCasesOfAMetric) {
  for (const char* metric : {"ttc_2d", "shapiro_wilk", "wasserstein"})
    expectRefused(folder("cases"), {"metric", metric, folder("cases")});
}

TEST_F(SpecialFiles, AsScenarioAndWhatItNames) {
  expectRefused(folder("mine.yaml"), {"validate", folder("mine.yaml")});
  for (const char* key : {"network", "demand", "guidance_profile", "metrics.speed_target_file"}) {
    const std::string file = folder("given.xml");
    expectRefused(file, {"run", "arterial_exit", "--set", std::string(key) + "=" + file,
                         "--results", folder("results")});
  }
  EXPECT_FALSE(fs::exists(folder("results")));
}

TEST_F(SpecialFiles, AsRouteFile) {
  expectRefused(folder("routes.xml"), {"run", "--bench2drive", folder("routes.xml"), "--route", "1",
                                       "--network", "roundabout", "--results", folder("results")});
}

TEST_F(SpecialFiles, InABatchAndItsMatrix) {
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n"
                                   "set: [protocol.time_limit=1]\n");
  const std::string batch = folder("batch");
  ASSERT_LE(cdiff({"evaluate", matrix, "--results", batch}), 1) << output();
  const fs::path run = fs::path(batch) / "runs/arterial_exit";
  for (const char* name : {"record.json", "summary.json", "trace.csv"}) {
    expectRefused(run / name, {"report", "--tables", batch});
    expectRefused(run / name, {"report", "--pedals", batch});
  }
  for (const char* name : {"record.json", "trace.csv"})
    expectRefused(run / name, {"evaluate", matrix, "--results", batch, "--resume"});
  const std::string traffic = folder("traffic.csv");
  const Words compare = {"realism", "pooled", batch, "--log", traffic, "--out", folder("realism")};
  expectRefused(traffic, compare);
  expectRefused(matrix, {"evaluate", matrix, "--results", folder("other")});
}

#ifdef E2E_CDIFF_WITH_ROS
TEST_F(SpecialFiles, AsBag) {
  expectRefused(folder("session.bag"),
                {"replay", folder("session.bag"), "--results", folder("results")});
}
#endif

}  // namespace
}  // namespace cdiff::cli
