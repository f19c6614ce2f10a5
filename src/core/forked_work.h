// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace cdiff::core {

/// Kind of the calls to SUMO.
inline constexpr const char* kSimulatorCall = "simulator";

// Work in a copy of this process: where code of others crashes or hangs in it, this process lives
// on and says what that code was.

/// Says what of others is being called, as long as the object exists, to the process that waits
/// for this one (runForked). Nothing happens where none waits, and in other threads than the one
/// that began the work.
class NamedCall {
 public:
  /// What ends a call that goes on: nothing, a stop signal, or also the limit of the work.
  enum class Limit { kNone, kWhenStopped, kOfTheWork };
  /// `kind` and `name` say what is called ("metric", "ego_jerk").
  NamedCall(const char* kind, const std::string& name, Limit limit = Limit::kOfTheWork);
  /// The call that was going on before goes on.
  ~NamedCall();
  NamedCall(const NamedCall&) = delete;
  NamedCall& operator=(const NamedCall&) = delete;

 private:
  std::string before_;
  std::int64_t since_before_ = 0;
  Limit limit_before_ = Limit::kNone;
};

/// How far work has come that leaves a result in a folder.
enum class WorkStage { kNothing, kFolderTaken, kResultWritten };

/// Says that a stage is reached, to the process that waits for this one.
void reachStage(WorkStage stage);

/// How work in a copy of this process ended.
struct WorkEnd {
  WorkStage stage = WorkStage::kNothing;  ///< the last one that was reached
  std::optional<int> exit_code;  ///< what the work returned; absent where it did not return
  std::string how;  ///< it did not: "signal 11 (Segmentation fault)", "exit code 0", ...
  /// Of the call that was going on then; empty where there was none, or where it did not end the
  /// work.
  std::string kind;
  std::string name;           ///< of that call
  bool interrupted = false;   ///< a stop signal had come, or ended it
  bool from_outside = false;  ///< a signal ended it that no code of the process sends
};

/// How many threads this process has. A copy of it has one.
std::size_t threadCount();

/// Runs `work` in a copy of this process and waits for its end. This process must have one thread;
/// `work` must not throw. A named call that takes longer than `call_limit` [s of wall time] ends
/// the copy. Once `stop` is true the copy gets SIGINT, and a call that goes on for 10 s more ends
/// it; when `stop` is true again, half a second later or more, 1 s. The work after its result has
/// 70 and 10 s. The copy ends with this process. Throws SimulatorError when no process can be made.
WorkEnd runForked(const std::function<int()>& work, double call_limit,
                  const std::atomic<bool>& stop);

}  // namespace cdiff::core
