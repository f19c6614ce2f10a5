// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/slurm/slurm_options.h"

namespace cdiff::evaluation {

/// A batch as Slurm gets it: one script, and an array of tasks for each part that fits into the
/// largest index of the cluster. Task I of T runs `cdiff worker RESULTS --part I/T`.
struct SlurmBatch {
  std::filesystem::path results;     ///< absolute, on a disk that all nodes see
  std::filesystem::path program;     ///< absolute path of `cdiff`
  std::string name;                  ///< of all its jobs
  std::size_t runs = 0;              ///< in the plan
  int jobs = 1;                      ///< sessions at a time in a task
  std::size_t largest_array = 1001;  ///< tasks of one array: MaxArraySize of the cluster
};

/// Folder of script and logs: RESULTS/slurm.
std::filesystem::path slurmFolder(const std::filesystem::path& results);

/// Text of the script; its argument is the number of its array's first task. Variables of this
/// process that decide results (E2E_CDIFF_ISA and others) are set in it.
std::string slurmScript(const SlurmBatch& batch, const SlurmOptions& options);

/// Arguments of sbatch, one list an array.
std::vector<std::vector<std::string>> sbatchArguments(const SlurmBatch& batch,
                                                      const SlurmOptions& options);

/// A text as one word of a shell.
std::string shellWord(const std::string& text);

}  // namespace cdiff::evaluation
