// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/guarded_process.h"
#include "simulation/sumo_link.h"

namespace cdiff::simulation {

// SUMO as a process, and the TraCI connection to it.

/// A TCP port that was free a moment ago.
int freePort();

/// Whether a process holds the socket that listens on a TCP port. Reads the kernel's tables and
/// does not connect: SUMO would take the attempt for its only client.
bool listensOn(int process_id, int port);

/// Another program connected to SUMO before this one; SUMO takes one client only.
class OtherClient : public core::SimulatorError {
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
  /// Before this program is its client: whether SUMO has another one, or ended over one.
  bool hasMetOtherClient() const;

 private:
  enum class Start { kListening, kPortTaken, kOtherClient };
  Start tryStart(const SumoCommand& command, const std::filesystem::path& program);

  LogFolder logs_;
  int port_ = 0;
  std::unique_ptr<core::GuardedProcess> process_;
};

/// A session with a SUMO process of our own through libtraci. Each guarded call is bounded in wall
/// time [s]; a SUMO that does not answer by then is ended.
class TraciLink : public SumoLink {
 public:
  /// Starts SUMO and connects. `call_timeout` bounds each guarded call. Throws OtherClient where
  /// another program was faster.
  TraciLink(const SumoCommand& command, double call_timeout);
  /// Closes the session and ends SUMO.
  ~TraciLink() override;

  int processId() const override { return sumo_.process().id(); }

 private:
  class Deadline;

  void connect();
  std::unique_ptr<Guard> guardCall() override;
  std::string lossText(const std::string& what, const std::string& reason) override;

  SumoProcess sumo_;
  double limit_;
  std::string label_;
  bool connected_ = false;
  bool loaded_ = false;  ///< network and demand
};

}  // namespace cdiff::simulation
