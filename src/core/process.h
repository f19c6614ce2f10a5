// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace cdiff::core {

/// The file that a program name stands for: itself when it holds a slash, else the first of that
/// name in PATH. Throws InputError naming the program and the Debian package to install.
std::filesystem::path findProgram(const std::string& name, const std::string& package);

/// Our environment as "NAME=value", with this value of one variable.
std::vector<std::string> environmentWith(const std::string& name, const std::string& value);

/// "signal 11 (Segmentation fault)".
std::string signalText(int signal);

/// Where a child's standard streams lead. Descriptors are ours and stay open here.
struct ProcessStreams {
  std::filesystem::path log = {};  ///< of output and errors unless `output` is set; empty: as ours
  int input = -1;                  ///< descriptor to read from; -1: /dev/null
  int output = -1;                 ///< descriptor of output and errors
  bool append = true;  ///< to what the log holds; else it is created, with room for last words
};

/// What a program prints, kept in memory: its descriptor is that of ProcessStreams::output.
class ProcessOutput {
 public:
  ProcessOutput();
  ~ProcessOutput();
  ProcessOutput(const ProcessOutput&) = delete;
  ProcessOutput& operator=(const ProcessOutput&) = delete;
  int descriptor() const { return descriptor_; }
  /// The last bytes of what was printed so far, at most `most`.
  std::string end(std::size_t most = 4000) const;

 private:
  int descriptor_;
};

/// A child process in a process group of its own that never outlives us, even when we are killed,
/// and that is ended when a deadline [s of wall time] passes: the only way out of a blocking call
/// to a child that has frozen. Whatever of its group is left when it ends is ended, too.
class GuardedProcess {
 public:
  /// Starts `program`; exit code 127 when it cannot be executed. A guardian thread starts the child
  /// and lives as long as this object, because the kernel ends the child together with the thread
  /// that started it. `environment` holds "NAME=value"; empty: ours. Throws SimulatorError when the
  /// process cannot be made.
  GuardedProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const std::vector<std::string>& environment, const ProcessStreams& streams);
  /// Ends and reaps the child.
  ~GuardedProcess();
  GuardedProcess(const GuardedProcess&) = delete;
  GuardedProcess& operator=(const GuardedProcess&) = delete;

  int id() const { return id_; }
  /// Whether the child has ended; reaps it, never waits.
  bool ended();
  /// Waits until it has ended, at most `seconds`; returns whether it has.
  bool waitForEnd(double seconds);
  /// Sends a signal to its group; nothing where it has ended.
  void signal(int number);
  /// Ends and reaps the child.
  void kill();
  /// Its exit code, or 128 + the signal that ended it; -1 while it runs.
  int exitCode();
  /// The signal that ended it; 0 when none did, or while it runs.
  int endSignal();
  /// How it ended: "exit code 1", "signal 9 (Killed)", "still running".
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

// Many jobs, each a process of its own, a few at a time.

/// What one job runs.
struct ProcessJob {
  std::filesystem::path program;
  std::vector<std::string> arguments;  ///< without the program
  std::filesystem::path log = {};      ///< created; empty: its output goes where ours goes
};

/// How a job's process ended.
struct ProcessEnd {
  std::size_t job = 0;
  int exit_code = -1;        ///< 128 + signal when killed
  double seconds = 0.0;      ///< of wall time that it took
  bool timed_out = false;    ///< killed for the time-out
  bool interrupted = false;  ///< the jobs were being stopped
};

/// How many processes of a pool run at a time, and how long each may take [s of wall time].
struct PoolLimits {
  int at_a_time = 1;
  double timeout = std::numeric_limits<double>::infinity();  ///< of one process, wall time [s]
  double grace = std::numeric_limits<double>::infinity();    ///< to end in after a stop [s]
};

/// Callbacks of a pool: one prepares a job's process, the other takes its end.
struct PoolCalls {
  /// Prepares a job for the start of its process.
  std::function<ProcessJob(std::size_t job)> start;
  /// Takes its end; returns whether the job comes again, before the others.
  std::function<bool(const ProcessEnd& end)> ended;
};

/// Runs the jobs in their order and returns when all have ended. Once `stop` is true no process is
/// started and those under way get SIGINT. Throws SimulatorError when no process can be made; those
/// under way are killed then.
void runProcesses(std::deque<std::size_t> jobs, const PoolLimits& limits,
                  const std::atomic<bool>& stop, const PoolCalls& calls);

}  // namespace cdiff::core
