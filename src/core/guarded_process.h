// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/child_process.h"
#include "core/file_descriptor.h"

namespace cdiff::core {

// Child processes: the program, its environment and streams, and GuardedProcess, which runs it.

/// The first program of a name (without slash) in PATH.
std::optional<std::filesystem::path> programInPath(const std::string& name);

/// The file that a program name stands for: itself when it holds a slash, else the first of that
/// name in PATH. Throws InputError naming the program and the Debian package to install.
std::filesystem::path findProgram(const std::string& name, const std::string& package);

/// This process's environment as "NAME=value" texts, with one variable set to `value`.
std::vector<std::string> environmentWith(const std::string& name, const std::string& value);

/// Name of a signal for messages: "signal 11 (Segmentation fault)"; who sent it where that is
/// known.
std::string signalText(int signal);

/// Where a child's standard streams lead. The descriptors belong to the caller and stay open here.
struct ProcessStreams {
  /// File for output and errors, unless `output` is given; empty: this process's own streams.
  std::filesystem::path log = {};
  int input = -1;      ///< descriptor of standard input; -1: /dev/null
  int output = -1;     ///< descriptor for output and errors; -1: see `log`
  bool append = true;  ///< append to the log; false: empty it and reserve room on the disk, so that
                       ///< last messages fit even if the disk fills up
};

/// Makes a process that was just forked the leader of a group of its own with these streams, no
/// other descriptor, no blocked signal and SIGINT not ignored. It is killed when the thread that
/// forked it in process `parent` ends. Only async-signal-safe calls.
void becomeChild(pid_t parent, const ProcessStreams& streams);

/// Reaps a child that leads a process group, and kills what is left of the group; without `wait`
/// only if it has ended. Its status as ::waitpid gives it (exit code 2 where another part of the
/// program reaped it), or nothing while it runs.
std::optional<int> reapGroup(pid_t leader, bool wait);

/// The exit code in a status of ::waitpid; 128 + the signal that ended the process.
int exitCodeOf(int status);

/// A file in memory that collects what a child prints; give its descriptor to
/// ProcessStreams::output.
class ProcessOutput {
 public:
  /// More than this is too long.
  static constexpr std::int64_t kMost = std::int64_t{64} << 20;  // [bytes]

  ProcessOutput();
  int descriptor() const { return descriptor_.get(); }
  /// Whether a child prints as if without end, which takes memory.
  bool isTooLong() const;
  /// The last `most` bytes, or fewer, of what was printed so far.
  std::string end(std::size_t most = 4000) const;

 private:
  FileDescriptor descriptor_;
};

/// A child process in a process group of its own that never outlives this process, even when this
/// process is killed, and that is killed when a deadline [s of wall time] passes: the only way out
/// of a blocking call to a child that has frozen. When it ends, the rest of its group is killed,
/// too. Used for SUMO, netconvert, ffmpeg and the sessions of a batch.
class GuardedProcess : public ChildProcess {
 public:
  /// Starts `program`; exit code 127 when it cannot be executed. A guardian thread starts the child
  /// and lives as long as this object, because the kernel ends the child together with the thread
  /// that started it. `environment` holds "NAME=value"; empty: this process's own. Throws
  /// SimulatorError when the process cannot be made.
  GuardedProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const std::vector<std::string>& environment, const ProcessStreams& streams);
  /// Ends and reaps the child.
  ~GuardedProcess() override;
  GuardedProcess(const GuardedProcess&) = delete;
  GuardedProcess& operator=(const GuardedProcess&) = delete;

  int id() const { return id_; }
  /// Whether the child has ended; reaps it, never waits.
  bool ended() override;
  /// Waits until it has ended, at most `seconds`; returns whether it has.
  bool waitForEnd(double seconds);
  /// The same; one whose output is too long is killed, and has not ended.
  bool waitForEnd(double seconds, const ProcessOutput& output);
  /// Sends a signal to its group; does nothing when it has ended.
  void signal(int number) override;
  /// Ends and reaps the child.
  void kill();
  /// Its exit code, or 128 + the signal that ended it; -1 while it runs.
  int exitCode() override;
  /// The signal that ended it; 0 when none did, or while it runs.
  int endSignal();
  /// How it ended: "exit code 1", "signal 11 (Segmentation fault)", "still running".
  std::string endText();

  /// From now on the child is killed once `seconds` have passed, unless the deadline is cleared
  /// before.
  void setDeadline(double seconds);
  void clearDeadline();
  /// Whether a deadline passed and the child was killed for it.
  bool deadlineMissed() const { return deadline_missed_.load(); }

 private:
  struct Image;  // what the child runs, laid out before the fork
  void guard(const Image& image);
  void publish(pid_t id, int error);
  bool reap(bool wait);

  std::atomic<std::int64_t> deadline_{0};  ///< steady clock [ns]; 0 means none
  std::atomic<bool> deadline_missed_{false};
  std::mutex mutex_;  ///< guards all members below
  std::condition_variable changed_;
  pid_t id_ = 0;
  int start_error_ = 0;
  bool started_ = false;
  bool reaped_ = false;
  int status_ = 0;
  bool stopping_ = false;
  std::thread guardian_;
};

}  // namespace cdiff::core
