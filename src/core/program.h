// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <exception>
#include <string>
#include <vector>

namespace cdiff::core {

/// Exit codes of `cdiff`, of the nodes and of scripts/session.
struct ExitCode {
  static constexpr int kPassed = 0;         ///< also a session that is struck or not judged
  static constexpr int kVerdictFailed = 1;  ///< of a session: a rule of its verdict is not met
  static constexpr int kRunTimeError = 2;
  static constexpr int kBadInput = 3;
  static constexpr int kInterrupted = 130;
  static constexpr int kSignal = 128;  ///< plus the number of the signal that ended a process
};

// What the main functions of all programs share: standard streams that are open, signals that
// must not end the process in the middle of a write, and stop requests as a flag.

/// First statement of every main. Opens descriptors 0 to 2 on /dev/null where the caller closed
/// them, so that no file of ours gets one of these numbers and receives what is printed. Ignores
/// SIGPIPE and SIGXFSZ: a write to a closed pipe or beyond `ulimit -f` is an error with a message.
void prepareProgram();

/// Ignores a signal; a handler that someone set stays.
void ignoreSignal(int signal);

/// The signals that ask a program to stop in order: SIGINT, SIGTERM, and SIGHUP unless it is
/// ignored, as under nohup.
std::vector<int> stopSignals();

/// From now on the stop signals set the flag returned, instead of ending the process. Clears it.
const std::atomic<bool>& catchStopSignals();

/// Whether a stop signal was caught, or is blocked and waits to be taken.
bool stopRequested();

/// A system call's error as a text: its name, and for a file beyond `ulimit -f` the limit.
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

}  // namespace cdiff::core
