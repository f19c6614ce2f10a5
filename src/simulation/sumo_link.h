// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <signal.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/guarded_process.h"
#include "core/scratch_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/sumo_simulator.h"

namespace cdiff::simulation {

// SUMO as a process, and the TraCI connection to it.

/// A TCP port that was free a moment ago.
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

/// A running `sumo` that waits for its one TraCI client: finds the program, gives it a port of its
/// own, waits until it listens there, and quotes its log when it fails. All times are seconds of
/// wall time.
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
  enum class Start { kListening, kPortTaken, kOtherClient };
  Start tryStart(const SumoCommand& command, const std::filesystem::path& program);

  LogFolder logs_;
  int port_ = 0;
  std::unique_ptr<core::GuardedProcess> process_;
};

/// One TraCI session with a SUMO process of our own: every call goes through `guarded`, which
/// bounds it in wall time [s] and turns every way to fail into a SimulatorError that quotes SUMO's
/// log; a SumoRefusal where SUMO ended by itself, or crashed while it loaded its input.
class SumoLink {
 public:
  /// Starts SUMO and connects. `call_timeout` bounds each guarded call.
  SumoLink(const SumoCommand& command, double call_timeout);
  /// Closes the session and ends SUMO.
  ~SumoLink();
  SumoLink(const SumoLink&) = delete;
  SumoLink& operator=(const SumoLink&) = delete;

  /// Runs calls of libtraci under the deadline. `what` says in errors what was tried ("step").
  template <class Call>
  auto guarded(const std::string& what, Call&& call) {
    const Guard guard(*this);
    try {
      select();
      return std::forward<Call>(call)();
    } catch (...) {
      fail(what);
    }
  }
  /// Runs a call inside a guarded one; returns false when SUMO refuses it and throws on when SUMO
  /// is lost.
  bool attempt(const std::function<void()>& call);

  const std::string& version() const { return version_; }
  int processId() const { return sumo_.process().id(); }

 private:
  /// Selects this session, holds signals back (an interrupted read would look like a lost SUMO) and
  /// sets the deadline.
  class Guard {
   public:
    explicit Guard(SumoLink& link);
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    SumoLink& link_;
    sigset_t previous_;
  };

  void connect();
  void select() const;
  [[noreturn]] void fail(const std::string& what);
  std::string lossText(const std::string& what, const std::string& reason);

  SumoProcess sumo_;
  double limit_;
  std::string label_;
  std::string version_;
  bool connected_ = false;
  bool loaded_ = false;  ///< network and demand
};

}  // namespace cdiff::simulation
