// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "session/session_setup.h"

namespace cdiff::cli {

/// A session that may end or stop its process: by a plug-in, by SUMO or by an answer of SUMO.
struct WatchedRun {
  const session::SessionSetup& setup;
  std::filesystem::path folder;  ///< of the result
  bool overwrite = false;        ///< of an earlier result there
  bool quiet = false;            ///< no table
  /// Of one call of a planner, a metric or libsumo, wall time [s]; infinite where all are ours.
  double answer_timeout = 30.0;
  const std::atomic<bool>& stop;  ///< set by stop signals
};

/// Runs `session` in a copy of this process, and returns its exit code. Where the copy ends without
/// a result, or a call takes too long, this process writes the result, which names what was called.
/// A result that the copy had written stays; the exit code is 2 then. Called by `cdiff run`.
int runWatched(const WatchedRun& run, const std::function<int()>& session);

}  // namespace cdiff::cli
