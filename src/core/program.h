// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace cdiff::core {

/// Exit codes of `cdiff`, of the nodes and of scripts/session.
struct ExitCode {
  static constexpr int kPassed = 0;         ///< also a session that is struck or not judged
  static constexpr int kVerdictFailed = 1;  ///< of a session: a rule of its verdict is not met
  static constexpr int kRunTimeError = 2;   ///< the program or SUMO failed
  static constexpr int kBadInput = 3;       ///< the user must change the input
  static constexpr int kReturned = 75;      ///< of a worker: stopped, and its run returned
  static constexpr int kInterrupted = 130;  ///< stopped by a stop signal
  static constexpr int kSignal = 128;       ///< plus the number of the signal that ended a process
};

// What the main functions of all programs share: open standard streams, no death by a signal in the
// middle of a write, stop requests as a flag, and errors as a text with an exit code.

/// To be called first in every main function. Opens descriptors 0 to 2 on /dev/null where the
/// caller closed them, so that no file of ours gets one of these numbers and receives what is
/// printed. Ignores SIGPIPE and SIGXFSZ: a write to a closed pipe or beyond `ulimit -f` is an error
/// with a message. Takes SIGCHLD back from a caller that ignores it. A stop signal ends the program
/// with a word and exit code 130, until catchStopSignals is called.
void prepareProgram();

/// Ignores a signal, unless it has a handler already.
void ignoreSignal(int signal);

/// The signals that ask a program to stop in an orderly fashion: SIGINT, SIGTERM, and SIGHUP unless
/// it is ignored, as under nohup.
std::vector<int> stopSignals();

/// Clears the returned flag, which from now on the stop signals set instead of ending the process.
const std::atomic<bool>& catchStopSignals();

/// Whether a stop signal was caught, or is blocked and waits to be taken.
bool stopRequested();

/// Text of the error number of a failed write; for a file beyond `ulimit -f` it names the limit.
std::string writeErrorText(int error);

/// What a program says, and how it exits, when an exception reaches its main function.
struct Failure {
  int exit_code = ExitCode::kRunTimeError;
  std::string text;  ///< for the user
};

/// The project's own errors keep their text. A path that the system refuses is bad input, named
/// with the system's reason; memory that ran out and errors of the standard library, which say
/// nothing to a user, are explained.
Failure failureOf(const std::exception& error);

/// The exit code that `call` gives. Where it throws, that of the failure, whose text is printed on
/// standard error.
int reportFailure(const std::function<int()>& call);

}  // namespace cdiff::core
