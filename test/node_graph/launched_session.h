// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A session in processes of its own, to stop or kill some of them: started by roslaunch or
/// scripts/session with a master on a free port, found again by a variable of their environment.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cdiff::test {

class LaunchedSession {
 public:
  LaunchedSession();
  /// Kills what is left.
  ~LaunchedSession();
  LaunchedSession(const LaunchedSession&) = delete;
  LaunchedSession& operator=(const LaunchedSession&) = delete;

  /// roslaunch of session.launch with `arguments`; results go to results().
  void launch(const std::string& arguments);
  /// Any command of bash, in the session's environment.
  void start(const std::string& command);

  /// Process of a node, or of SUMO ("sumo") or the master ("rosmaster"); waits for it up to 20 s of
  /// wall time, 0 when it never comes.
  pid_t process(const std::string& name) const;
  /// Sends a signal to that process, and remembers when. False when there is none.
  bool signal(const std::string& name, int number);
  /// The same for what was started itself.
  void signalLaunch(int number);
  /// Waits until what was started has sourced its environment and is scripts/session (20 s).
  bool isScript() const;
  /// Waits until a file of the result folder is there (20 s).
  bool hasFile(const std::string& name) const;
  /// Waits until the session has had some ticks: 4 KiB of the trace are written (20 s).
  bool hasTicks() const;
  /// Waits for the end of what was started, at most `limit` seconds after the last signal; answers
  /// how many it took, or `limit`.
  double endAfter(double limit);
  int exitStatus() const { return exit_status_; }
  /// Command lines of processes of the session that live still, up to 2 s after the end.
  std::string leftovers() const;

  std::filesystem::path results() const { return folder_ / "results"; }
  nlohmann::json summary() const;
  /// Source and text of the last fault of the summary; empty when there is none.
  std::string fault() const;
  /// Content of results/exit_code; empty when there is none.
  std::string exitCode() const;
  std::string log() const;
  /// Wall time from the last signal to the first error with this text, by the stamp that ROS
  /// prints before it [s]; NaN where there is none.
  double errorAfter(const std::string& text) const;
  const std::filesystem::path& folder() const { return folder_; }
  int port() const { return port_; }

 private:
  struct Process {
    pid_t id;
    std::string command;
  };
  std::vector<Process> processes() const;
  void noteSignal();

  std::filesystem::path folder_;
  int port_;
  pid_t launch_ = 0;
  int exit_status_ = -1;
  double signaled_at_ = 0.0;       ///< steady clock [s]
  double signaled_at_wall_ = 0.0;  ///< system clock [s]
};

}  // namespace cdiff::test
