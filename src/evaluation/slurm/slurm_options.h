// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace cdiff::evaluation {

/// What `cdiff evaluate --engine slurm` asks of a cluster. An empty text leaves the site's default.
struct SlurmOptions {
  std::string partition;
  std::string account;
  std::string qos;
  std::string time;        ///< limit of a task, as sbatch takes it
  std::string memory;      ///< of a task, as sbatch takes it
  std::string constraint;  ///< features of nodes
  std::int64_t nice = 0;
  std::int64_t runs_per_task = 20;      ///< runs of one array task
  std::int64_t max_running = 0;         ///< tasks at a time; 0: no limit
  double poll = 20.0;                   ///< between two questions to Slurm [s]
  std::vector<std::string> setup;       ///< shell lines before the worker
  std::vector<std::string> extra_args;  ///< further arguments of sbatch

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for a text with a line break or another control character.
  void validate() const;
};

/// From the texts of `--slurm`, in their order: a YAML file, or "key=value". Throws InputError
/// naming file or text, key, and what was expected.
SlurmOptions slurmOptionsOf(const std::vector<std::string>& texts);

}  // namespace cdiff::evaluation
