// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <signal.h>

#include <limits>
#include <thread>

#include "core/forked_work.h"

namespace cdiff::core {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
const std::atomic<bool> kNoStop{false};

TEST(ForkedWork, SaysWhatWasCalledAndHowFarItWas) {
  const WorkEnd end = runForked(
      [] {
        reachStage(WorkStage::kFolderTaken);
        const NamedCall call("metric", "mine");
        return ::raise(SIGKILL);
      },
      kNoLimit, kNoStop);
  EXPECT_FALSE(end.exit_code.has_value());
  EXPECT_EQ(end.kind, "metric");
  EXPECT_EQ(end.name, "mine");
  EXPECT_EQ(end.stage, WorkStage::kFolderTaken);
}

TEST(ForkedWork, GivesTheExitCodeOfWorkThatReturns) {
  const WorkEnd end = runForked(
      [] {
        reachStage(WorkStage::kResultWritten);
        return 7;
      },
      kNoLimit, kNoStop);
  EXPECT_EQ(end.exit_code, 7);
  EXPECT_EQ(end.stage, WorkStage::kResultWritten);
}

TEST(ForkedWork, AnotherThreadNamesNothing) {
  const WorkEnd end = runForked(
      [] {
        const NamedCall call("planner", "mine");
        std::thread([] { const NamedCall other("metric", "beside"); }).join();
        std::thread([] {
          const NamedCall other("metric", "beside");
          ::raise(SIGKILL);
        }).join();
        return 0;
      },
      kNoLimit, kNoStop);
  EXPECT_EQ(end.kind, "planner") << "calls of two threads would mix";
}

TEST(ForkedWork, EndsACallThatTakesTooLong) {
  const WorkEnd end = runForked(
      [] {
        const NamedCall call("planner", "endless");
        for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
        return 0;
      },
      0.1, kNoStop);
  EXPECT_FALSE(end.exit_code.has_value());
  EXPECT_EQ(end.name, "endless");
}

}  // namespace
}  // namespace cdiff::core
