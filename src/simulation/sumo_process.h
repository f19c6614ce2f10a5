// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A running `sumo` that waits for its one TraCI client: finds the program, gives it a port of its
/// own, waits until it listens there, and quotes its log when it fails. All times are seconds of
/// wall time.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/guarded_process.h"
#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::simulation {

/// A TCP port that nobody listened on a moment ago.
int freePort();

/// Whether a process holds the socket that listens on a TCP port. Reads the kernel's tables and
/// does not connect: SUMO would take the attempt for its only client.
bool listensOn(int process_id, int port);

/// A folder for SUMO's log: the given one (made when missing), or a temporary one that is removed
/// with the object.
class LogFolder {
 public:
  explicit LogFolder(const std::filesystem::path& wanted);
  std::filesystem::path errorLog() const { return path_ / "sumo_errors.log"; }
  std::filesystem::path output() const { return path_ / "sumo_output.log"; }

 private:
  std::unique_ptr<core::ScratchFolder> scratch_;  ///< where none is given
  std::filesystem::path path_;
};

/// SUMO ended by itself and says why in its error log, or crashed over what it was given: its own
/// words, without the files.
class SumoRefusal : public core::SimulatorError {
 public:
  using core::SimulatorError::SimulatorError;
};

/// How SUMO is started.
struct SumoCommand {
  std::string binary = "sumo";         ///< program name or file
  std::vector<std::string> arguments;  ///< without port, client count and error log
  std::filesystem::path log_folder;    ///< a temporary folder when empty
  double start_timeout = 20.0;         ///< until it listens [s]
  std::function<int()> choose_port =
      freePort;  ///< a port that another program took meanwhile is replaced, up to five times
};

class SumoProcess {
 public:
  /// Returns once SUMO listens. Throws InputError when the program is missing, SumoRefusal when it
  /// ends instead, and SimulatorError, quoting SUMO's log, when it does not listen in time.
  explicit SumoProcess(const SumoCommand& command);
  ~SumoProcess();

  int port() const { return port_; }
  core::GuardedProcess& process() { return *process_; }
  const core::GuardedProcess& process() const { return *process_; }
  /// The last lines of SUMO's error log (of its output when the log is empty), for an error text.
  std::string lastWords() const;
  /// SUMO's reason for having ended: the first sentence of its error log, or the assertion that
  /// failed; empty when it named none, runs, or was killed from outside.
  std::string refusal() const;

 private:
  enum class Start { kListening, kPortTaken };
  Start tryStart(const SumoCommand& command, const std::filesystem::path& program);

  LogFolder logs_;
  int port_ = 0;
  std::unique_ptr<core::GuardedProcess> process_;
};

}  // namespace cdiff::simulation
