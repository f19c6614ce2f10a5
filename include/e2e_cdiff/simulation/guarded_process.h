// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A child process that never outlives us, even when we are killed, and that is ended when a
/// deadline [s of wall time] passes: the only way out of a blocking call to a child that has
/// frozen.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace cdiff::simulation {

class GuardedProcess {
 public:
  /// Starts `program` in a process group of its own, its output appended to `output`. A guardian
  /// thread starts the child and lives as long as this object, because the kernel ends the child
  /// together with the thread that started it. `environment` holds "NAME=value". Throws
  /// SimulatorError when the process cannot be made.
  GuardedProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const std::vector<std::string>& environment, const std::filesystem::path& output);
  /// Ends and reaps the child.
  ~GuardedProcess();
  GuardedProcess(const GuardedProcess&) = delete;
  GuardedProcess& operator=(const GuardedProcess&) = delete;

  int id() const { return id_; }
  /// Whether the child has ended; reaps it, never waits.
  bool ended();
  /// Waits until it has ended, at most `seconds`; answers whether it has.
  bool waitForEnd(double seconds);
  /// Ends and reaps the child.
  void kill();
  /// How it ended: "exit code 1", "signal 9", "still running".
  std::string endText();

  /// From now on the child is killed once `seconds` have passed, unless the deadline is cleared
  /// before.
  void setDeadline(double seconds);
  void clearDeadline();
  /// Whether a deadline passed and the child was killed for it.
  bool deadlineMissed() const { return deadline_missed_.load(); }

 private:
  struct Image;
  void guard(const Image& image);
  void publish(pid_t id, int error);
  bool reap(bool wait);

  std::atomic<std::int64_t> deadline_{0};  ///< steady clock [ns]; 0 means none
  std::atomic<bool> deadline_missed_{false};
  std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  pid_t id_ = 0;
  int start_error_ = 0;
  bool started_ = false;
  bool reaped_ = false;
  int status_ = 0;
  bool stopping_ = false;
  std::thread guardian_;
};

}  // namespace cdiff::simulation
