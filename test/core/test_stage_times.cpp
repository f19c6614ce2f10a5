// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "core/stage_times.h"

namespace cdiff::core {
namespace {

/// Names of the stages that were measured, in alphabetical order.
std::string namesOf(const StageTimes& times) {
  std::string names;
  for (const auto& [name, seconds] : times.seconds()) names += name + " ";
  return names;
}

/// Passes at least a millisecond of wall time.
void passTime() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

TEST(StageTimes, TimeInsideAnotherStageCountsOnce) {
  StageTimes times;
  const auto begin = std::chrono::steady_clock::now();
  {
    const TimedStage outer("outer");
    passTime();
    for (int i = 0; i < 3; ++i) {
      const TimedStage inner("inner");
      passTime();
    }
  }
  const double all =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(namesOf(times), "inner outer ");
  // Each pause lasts 1 ms or more, and the parts are disjoint pieces of the whole.
  EXPECT_GE(times.seconds().at("outer"), 0.001);
  EXPECT_GE(times.seconds().at("inner"), 0.003);
  EXPECT_LE(times.seconds().at("outer") + times.seconds().at("inner"), all + 1e-9);
}

TEST(StageTimes, OnlyStagesOfItsThreadWhileItLivesCount) {
  { const TimedStage before("before"); }
  StageTimes times;
  std::thread([] { const TimedStage elsewhere("elsewhere"); }).join();
  { const TimedStage here("here"); }
  EXPECT_EQ(namesOf(times), "here ");
}

TEST(StageTimes, AStageThatThrowsEndsToo) {
  StageTimes times;
  try {
    const TimedStage outer("outer");
    const TimedStage inner("inner");
    throw std::runtime_error("a stage fails");
  } catch (const std::runtime_error&) {
  }
  { const TimedStage after("after"); }
  EXPECT_EQ(namesOf(times), "after inner outer ");
}

TEST(StageTimes, ASecondInTheSameThreadIsRefused) {
  const StageTimes times;
  EXPECT_THROW(StageTimes(), std::logic_error);
  const TimedStage still_measured("stage");
}

}  // namespace
}  // namespace cdiff::core
