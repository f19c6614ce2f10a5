// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/file.h"
#include "core/scratch_folder.h"
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

TEST(StageTimes, TheWantedFileHasALineForEachStage) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "stages";
  EXPECT_EQ(wantedStageTimes(), nullptr);
  ::setenv(kStagesVariable, file.c_str(), 1);
  {
    const auto times = wantedStageTimes();
    ASSERT_NE(times, nullptr);
    for (const char* name : {"reading", "moves"}) const TimedStage stage(name);
    writeStageTimes(times.get());
  }
  ::unsetenv(kStagesVariable);
  std::istringstream lines(readFile(file, "stages"));
  std::string first, second;
  double first_seconds = -1.0, second_seconds = -1.0;
  lines >> first >> first_seconds >> second >> second_seconds;
  EXPECT_EQ(first + " " + second, "moves reading");
  EXPECT_GE(first_seconds, 0.0);
  EXPECT_GE(second_seconds, 0.0);
}

}  // namespace
}  // namespace cdiff::core
