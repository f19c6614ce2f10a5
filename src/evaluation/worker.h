// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/lease.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// How a worker runs planned sessions: which program, how many at a time, how long each.
struct WorkerOptions {
  std::filesystem::path program = "/proc/self/exe";  ///< understands the runs' commands
  /// Arguments that make the program a server for sessions, which starts once and forks a child for
  /// each (core/fork_server.h); empty: the program starts afresh for each.
  std::vector<std::string> server = {};
  std::filesystem::path results;  ///< result folder of the batch
  int jobs = 1;                   ///< processes at a time
  double timeout = 600.0;         ///< wall time of one attempt [s]
  int retries = 1;                ///< further attempts where a process or its simulator died
  double grace = 20.0;            ///< to end in after an interrupt [s]
  core::LeaseTerms lease = {"cdiff evaluate"};  ///< what others see of it
  bool waits = false;            ///< for runs that others have, to take over what they leave behind
  bool compares_inputs = false;  ///< each run's scenario and files with its record's hashes
  /// Called after each run that has a result from now on, its own or that of another worker.
  std::function<void(const RunRecord&)> ended = {};
};

/// Folder of a batch's leases: RESULTS/.leases.
std::filesystem::path leaseFolder(const std::filesystem::path& results);

/// Folder of a batch for what hosts that fell silent had of runs which others took over: their
/// sessions may still write there, and nothing reads it.
inline constexpr const char* kLeftBehindFolder = ".left_behind";

/// Folder of a run: RESULTS/runs/ID.
std::filesystem::path runFolder(const std::filesystem::path& results, const std::string& id);

/// Runs planned runs in their order, each under a lease and only where its record says not_run or
/// interrupted. So workers of any number and host may share a plan, and a worker that starts again
/// goes on where it was. Once `stop` is true no run is started and those under way are interrupted.
/// A run whose inputs have changed ends with an error in its record. Throws InputError naming a
/// record that is absent or damaged.
void runPlanned(const std::vector<std::string>& ids, const WorkerOptions& options,
                const std::atomic<bool>& stop);

}  // namespace cdiff::evaluation
