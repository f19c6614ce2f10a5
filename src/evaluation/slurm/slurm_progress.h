// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// What a wait for the jobs of a batch looks at, and whom it informs.
struct SlurmWait {
  std::filesystem::path results;
  std::string job_name;
  double poll = 20.0;                             ///< between two looks [s]
  std::function<void(const RunRecord&)> ended{};  ///< once for each run that has a result
  std::function<void()> unanswered{};             ///< once, where Slurm does not answer
};

/// Waits until each of these runs has a result, or no task is queued any more, or `stop` is true.
/// Gives the ids without a result. Each look reads a part of the records, and all once the queue is
/// empty: a shared disk may show files late. Throws InputError for a damaged record.
std::vector<std::string> waitForJobs(const std::vector<std::string>& ids, const SlurmWait& wait,
                                     const std::atomic<bool>& stop);

}  // namespace cdiff::evaluation
