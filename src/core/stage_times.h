// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>

namespace cdiff::core {

/// Where the wall time of a thread's ticks goes [s], by the name of a stage. From its construction
/// on it measures the `TimedStage`s of the thread that made it; those of other threads do not
/// count. One at a time in a thread: the constructor throws std::logic_error where another lives.
class StageTimes {
 public:
  StageTimes();
  ~StageTimes();
  StageTimes(const StageTimes&) = delete;
  StageTimes& operator=(const StageTimes&) = delete;

  /// Seconds of each stage that has begun and ended, without the stages inside it: no time counts
  /// twice.
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  friend class TimedStage;
  std::map<std::string, double> seconds_;
  class TimedStage* innermost_ = nullptr;  ///< of the stages that run
};

/// A stage of a tick from its construction to its destruction. Costs a look at a pointer where its
/// thread has no StageTimes, which must not be made or end while a stage runs.
class TimedStage {
 public:
  /// `name` must outlive the stage.
  explicit TimedStage(const char* name);
  ~TimedStage();
  TimedStage(const TimedStage&) = delete;
  TimedStage& operator=(const TimedStage&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes* times_;  ///< nullptr: nobody measures
  const char* name_ = nullptr;
  TimedStage* outer_ = nullptr;
  Clock::time_point begin_;
  Clock::duration inside_{};  ///< of the stages within this one
};

/// Names a file in the environment that gets the times of a session's stages, a line "STAGE
/// SECONDS" each (`scripts/benchmark graph` reads it).
inline constexpr const char* kStagesVariable = "E2E_CDIFF_STAGES_FILE";
/// Measures this thread where the variable names a file; else nullptr.
std::unique_ptr<StageTimes> wantedStageTimes();
/// Writes that file; does nothing for nullptr. Throws InputError when it cannot be written.
void writeStageTimes(const StageTimes* times);

}  // namespace cdiff::core
