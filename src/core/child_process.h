// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

namespace cdiff::core {

/// A process under way, as whoever waits for it sees it: a child of ours (GuardedProcess) or of a
/// server of ours (ForkServer).
class ChildProcess {
 public:
  virtual ~ChildProcess() = default;
  /// Whether it has ended; never waits.
  virtual bool ended() = 0;
  /// Sends a signal to its process group; does nothing when it has ended.
  virtual void signal(int number) = 0;
  /// Its exit code, or 128 + the signal that ended it; -1 while it runs.
  virtual int exitCode() = 0;
};

}  // namespace cdiff::core
