// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "evaluation/child_process.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

ProcessJob shell(const std::string& script) { return {script, {"-c", script}}; }

TEST(ProcessPool, RunsEveryJobAndKeepsItsExitCode) {
  std::vector<ProcessJob> jobs = {shell("exit 0"), shell("exit 3"), shell("kill -9 $$")};
  std::size_t ended = 0;
  runProcesses("/bin/sh", jobs, 2, std::atomic<bool>(false), [&](const ProcessJob&) { ++ended; });
  EXPECT_EQ(ended, 3U);
  EXPECT_EQ(jobs[0].exit_code, 0);
  EXPECT_EQ(jobs[1].exit_code, 3);
  EXPECT_EQ(jobs[2].exit_code, 128 + 9);
}

TEST(ProcessPool, InterruptsWhatRunsAndStartsNoMore) {
  const test::TemporaryFolder scratch;
  const std::string ready = (scratch.path() / "ready").string();
  std::vector<ProcessJob> jobs = {
      shell("trap 'exit 130' INT; touch " + ready + "; while :; do sleep 0.05; done"),
      shell("touch " + (scratch.path() / "second").string())};
  std::atomic<bool> stop{false};
  std::thread stopper([&] {
    while (!std::filesystem::exists(ready))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop = true;
  });
  runProcesses("/bin/sh", jobs, 1, stop, [](const ProcessJob&) {});
  stopper.join();
  EXPECT_EQ(jobs[0].exit_code, 130);
  EXPECT_EQ(jobs[1].exit_code, -1);
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "second"));
}

}  // namespace
}  // namespace cdiff::evaluation
