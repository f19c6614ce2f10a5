// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <limits>
#include <thread>

#include "core/forked_work.h"
#include "core/program.h"

namespace cdiff::core {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
const std::atomic<bool> kNoStop{false};

TEST(ForkedWork, SaysWhatWasCalledAndHowFarItWas) {
  const WorkEnd end = runForked(
      [] {
        reachStage(WorkStage::kFolderTaken);
        const NamedCall call("metric", "mine");
        return ::raise(SIGABRT);
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
          ::raise(SIGABRT);
        }).join();
        return 0;
      },
      kNoLimit, kNoStop);
  EXPECT_EQ(end.kind, "planner") << "calls of two threads would mix";
}

TEST(ForkedWork, NoCallIsBlamedForASignalFromOutside) {
  for (const int signal : {SIGKILL, SIGXCPU, SIGINT}) {
    const WorkEnd end = runForked(
        [signal] {
          const NamedCall call("planner", "mine");
          ::signal(signal, SIG_DFL);
          return ::raise(signal);
        },
        kNoLimit, kNoStop);
    EXPECT_FALSE(end.exit_code.has_value());
    EXPECT_EQ(end.kind, "") << signal;
    EXPECT_EQ(end.interrupted, signal == SIGINT);
  }
}

TEST(ForkedWork, AProgramThatAStopSignalEndsIsInterrupted) {
  const WorkEnd end = runForked(
      [] {
        const NamedCall call("planner", "mine");
        ::_exit(ExitCode::kInterrupted);
        return 0;
      },
      kNoLimit, kNoStop);
  EXPECT_TRUE(end.interrupted);
  EXPECT_EQ(end.kind, "");
}

/// Goes on for ever in a call, and asks the process that waits to stop it: twice.
int goOnInACall(NamedCall::Limit limit) {
  const NamedCall call("planner", "endless", limit);
  for (;;) {
    ::kill(::getppid(), SIGINT);
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

TEST(ForkedWork, TheSecondStopEndsACallThatHasNoLimit) {
  const WorkEnd end = runForked([] { return goOnInACall(NamedCall::Limit::kWhenStopped); },
                                kNoLimit, catchStopSignals());
  EXPECT_TRUE(end.interrupted);
  EXPECT_EQ(end.name, "endless");
}

TEST(ForkedWork, TheSecondStopEndsWorkThatGoesOnBehindItsResult) {
  const WorkEnd end = runForked(
      [] {
        reachStage(WorkStage::kResultWritten);
        return goOnInACall(NamedCall::Limit::kNone);
      },
      kNoLimit, catchStopSignals());
  EXPECT_TRUE(end.interrupted);
  EXPECT_EQ(end.stage, WorkStage::kResultWritten);
  EXPECT_EQ(end.kind, "") << "the call that went on may go on";
}

TEST(ForkedWork, WhatBeginsLongAfterAStopHasItsTime) {
  const WorkEnd end = runForked(
      [] {
        ::kill(::getppid(), SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(10500));
        {
          const NamedCall call("metric", "late");
          std::this_thread::sleep_for(std::chrono::milliseconds(200));
        }
        reachStage(WorkStage::kResultWritten);
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        return 7;
      },
      kNoLimit, catchStopSignals());
  EXPECT_EQ(end.exit_code, 7);
}

TEST(ForkedWork, ACopyOfTheCopyNamesNothing) {
  const WorkEnd end = runForked(
      [] {
        const NamedCall call("planner", "mine");
        const pid_t copy = ::fork();
        if (copy == 0) {
          const NamedCall other("metric", "beside");
          ::_exit(0);
        }
        ::waitpid(copy, nullptr, 0);
        const pid_t killed = ::fork();
        if (killed == 0) {
          const NamedCall other("metric", "beside");
          ::raise(SIGKILL);
        }
        ::waitpid(killed, nullptr, 0);
        return ::raise(SIGABRT);
      },
      kNoLimit, kNoStop);
  EXPECT_EQ(end.name, "mine");
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
