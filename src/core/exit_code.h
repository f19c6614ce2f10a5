// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

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

}  // namespace cdiff::core
