// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <thread>

#include "core/file.h"
#include "core/process_pool.h"
#include "support/processes.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

/// Runs shell scripts and keeps how each ended last.
class ProcessPool : public testing::Test {
 protected:
  void run(const std::vector<std::string>& scripts, const PoolLimits& limits) {
    std::deque<std::size_t> jobs;
    for (std::size_t i = 0; i < scripts.size(); ++i) jobs.push_back(i);
    PoolCalls calls;
    calls.start = [&](std::size_t job) {
      ++starts_[job];
      return ProcessJob{"/bin/sh", {"-c", scripts[job]}};
    };
    calls.ended = [&](const ProcessEnd& end) {
      ends_[end.job] = end;
      return end.exit_code == kAgain && starts_[end.job] < 2;
    };
    runProcesses(jobs, limits, stop_, calls);
  }

  static constexpr int kAgain = 9;
  std::atomic<bool> stop_{false};
  std::map<std::size_t, int> starts_;
  std::map<std::size_t, ProcessEnd> ends_;
  test::TemporaryFolder scratch_;
};

TEST_F(ProcessPool, LeavesOutAJobThatGivesNothingToRun) {
  PoolCalls calls;
  calls.start = [&](std::size_t job) {
    ++starts_[job];
    return job == 1 ? std::nullopt : std::make_optional(ProcessJob{"/bin/true", {}});
  };
  calls.ended = [&](const ProcessEnd& end) {
    ends_[end.job] = end;
    return false;
  };
  runProcesses({0, 1, 2}, {}, stop_, calls);
  EXPECT_EQ(starts_, (std::map<std::size_t, int>{{0, 1}, {1, 1}, {2, 1}}));
  EXPECT_EQ(ends_.size(), 2U);
  EXPECT_EQ(ends_.count(1), 0U);
}

TEST_F(ProcessPool, RunsEveryJobAndKeepsItsExitCode) {
  PoolLimits limits;
  limits.at_a_time = 2;
  run({"exit 0", "exit 3", "kill -9 $$", "exit 9"}, limits);
  ASSERT_EQ(ends_.size(), 4U);
  EXPECT_EQ(ends_[0].exit_code, 0);
  EXPECT_EQ(ends_[1].exit_code, 3);
  EXPECT_EQ(ends_[2].exit_code, 128 + SIGKILL);
  EXPECT_EQ(starts_[1], 1);
  EXPECT_EQ(starts_[3], 2) << "it asked to come again";
}

TEST_F(ProcessPool, KillsWhatTakesTooLongWithAllThatItStarted) {
  const std::string number = (scratch_.path() / "process").string();
  PoolLimits limits;
  limits.timeout = 3.0;
  run({"sleep 60 & echo $! > " + number + "; wait"}, limits);
  EXPECT_TRUE(ends_[0].timed_out);
  EXPECT_FALSE(ends_[0].interrupted);
  EXPECT_EQ(ends_[0].exit_code, 128 + SIGKILL);
  EXPECT_GT(ends_[0].seconds, limits.timeout);
  EXPECT_LT(ends_[0].seconds, 30.0);
  // Whoever inherits a dead grandchild may take a moment to bury it.
  const pid_t grandchild = std::stoi(readFile(number, "process"));
  for (int i = 0; i < 500 && test::isAlive(grandchild); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(test::isAlive(grandchild));
}

TEST_F(ProcessPool, InterruptsWhatRunsAndStartsNoMore) {
  const std::string ready = (scratch_.path() / "ready").string();
  std::thread stopper([&] {
    while (!std::filesystem::exists(ready))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_ = true;
  });
  run({"trap 'exit 130' INT; touch " + ready + "; while :; do sleep 0.05; done", "exit 0"}, {});
  stopper.join();
  EXPECT_EQ(ends_[0].exit_code, 130);
  EXPECT_TRUE(ends_[0].interrupted);
  EXPECT_EQ(starts_.count(1), 0U);
}

TEST_F(ProcessPool, KillsWhatDoesNotEndInTimeAfterAStop) {
  const std::string ready = (scratch_.path() / "ready").string();
  std::thread stopper([&] {
    while (!std::filesystem::exists(ready))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_ = true;
  });
  PoolLimits limits;
  limits.grace = 0.2;
  run({"trap '' INT; touch " + ready + "; while :; do sleep 0.05; done"}, limits);
  stopper.join();
  EXPECT_EQ(ends_[0].exit_code, 128 + SIGKILL);
  EXPECT_FALSE(ends_[0].timed_out);
}

}  // namespace
}  // namespace cdiff::core
