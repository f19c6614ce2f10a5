// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "core/file_descriptor.h"
#include "core/guarded_process.h"

namespace cdiff::core {

// A server is a process that has started once and runs many jobs, each in a child that it forks:
// what the server has loaded, its children need not load again. Server and client speak over a
// socket, which is the server's standard input.

/// What a child does; its exit code.
using ForkedRun = std::function<int()>;
/// Makes what a child does from the arguments of a job. Runs in the server, so what it loads stays
/// there; does not throw, and starts no thread that lives on.
using ForkPreparation = std::function<ForkedRun(const std::vector<std::string>& arguments)>;

/// The server's side: forks a child for each job until the client closes the socket `control`, and
/// kills the child under way then. A child has a process group of its own, /dev/null as input and
/// the job's log as output, and dies with the server. Where the server has more than one thread a
/// fork would be unsafe: the child starts this program afresh then, with the job's arguments.
/// Returns an exit code.
int serveForks(int control, const ForkPreparation& prepare);

/// The client's side: one server, and the job that it runs at present.
class ForkServer : public ChildProcess {
 public:
  /// Starts `program` with `arguments`, which must call serveForks on standard input. Throws
  /// SimulatorError when no process or socket can be made.
  ForkServer(const std::filesystem::path& program, const std::vector<std::string>& arguments);

  /// Begins a job; the one before must have ended. `log`: file for its output, emptied; empty: the
  /// server's own streams. A server that is gone by then ends the job as it ended itself; one that
  /// cannot be told of the job (more than 128 KiB of arguments) is ended.
  void begin(const std::vector<std::string>& arguments, const std::filesystem::path& log);
  /// Whether the server is there for another job.
  bool serves() { return !process_->ended(); }
  /// Id of the server's process.
  int id() const { return process_->id(); }

  bool ended() override;
  /// To the job's process group. SIGKILL ends the server, too, while it still prepares the job.
  void signal(int number) override;
  int exitCode() override { return exit_code_; }

 private:
  void take(const std::string& message);

  FileDescriptor control_;
  std::unique_ptr<GuardedProcess> process_;
  bool forked_ = false;  ///< the job has a process
  bool ended_ = true;
  int exit_code_ = -1;
};

}  // namespace cdiff::core
