// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::evaluation {

// What is asked of Slurm's own commands. Its accounting is never asked: records say what was run.

/// Throws InputError naming the command and its package where sbatch, squeue, scancel or scontrol
/// is missing, and with Slurm's own words where its controller does not answer. Gives MaxArraySize.
std::size_t requireSlurm();

/// Submits one array and gives the id of its job. Throws InputError with sbatch's own words.
std::string submitJob(const std::vector<std::string>& arguments);

/// How many tasks of this user's jobs of this name are waiting or running; nothing where Slurm does
/// not answer.
std::optional<std::size_t> queuedTasks(const std::string& job_name);

/// Ends all jobs of this name. Throws InputError with scancel's own words.
void cancelJobs(const std::string& job_name);

/// Name of the jobs of a batch, in RESULTS/engine.json.
void writeJobName(const std::filesystem::path& results, const std::string& job_name,
                  const std::vector<std::string>& ids);
/// Whether the folder has one.
bool hasJobName(const std::filesystem::path& results);
/// Throws InputError where the folder has none.
std::string readJobName(const std::filesystem::path& results);

}  // namespace cdiff::evaluation
