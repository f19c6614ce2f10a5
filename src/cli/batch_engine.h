// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "evaluation/executor.h"
#include "evaluation/slurm/slurm_options.h"

namespace cdiff::cli {

// The engines of `cdiff evaluate` that run a plan elsewhere than in this process.

/// Throws InputError where Slurm is missing or does not answer, or the options are wrong.
void requireEngine(const std::string& engine, const evaluation::SlurmOptions& options);

/// Writes the script of the jobs, prints it and the commands that would submit it.
void printJobs(const evaluation::Executor& executor, const std::filesystem::path& results, int jobs,
               const evaluation::SlurmOptions& options);

/// Writes the script and submits it, all or nothing. Throws InputError where Slurm refuses.
void submitJobs(const evaluation::Executor& executor, const std::filesystem::path& results,
                int jobs, const evaluation::SlurmOptions& options);

/// Waits for the jobs of a batch whose plan lists these runs; says what goes on, also after a stop
/// signal. Gives whether no job is left that works on the plan.
bool followJobs(const std::vector<std::string>& ids, const std::filesystem::path& results,
                const evaluation::SlurmOptions& options, BatchProgress& progress);

}  // namespace cdiff::cli
