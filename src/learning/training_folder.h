// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "learning/task.h"

namespace cdiff::learning {

/// Checkpoints and caches of the trainer: facts as JSON and named float32 tensors in one file, with
/// a SHA-256 at its end; written atomically.
struct Checkpoint {
  nlohmann::json facts = nlohmann::json::object();
  std::map<std::string, at::Tensor> tensors;  ///< on the CPU

  /// The tensor; throws InputError naming `source` when it is missing or not of this shape.
  const at::Tensor& tensor(const std::string& name, at::IntArrayRef shape,
                           const std::string& source) const;
};

/// Throws InputError naming the path (disk full, not writable).
void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);
/// Throws InputError naming the path and what is wrong.
Checkpoint readCheckpoint(const std::filesystem::path& path);

// The output folder of a training: which checkpoints a stage starts from and which it writes.

/// Checkpoint of a stage in the output folder.
std::filesystem::path checkpointPath(const std::string& output, const std::string& stage);
/// What a stage of the task, or `export`, starts with; nothing for `all`.
std::vector<PartSource> sourcesOf(const Task& task, const std::string& stage);

/// Throws InputError unless the folder has what the stage starts from, or `init` is given.
void requireSources(const Training& training);
/// Throws InputError naming the file when the stage was trained in the folder already, or when a
/// model lies there alone, unless it is to be resumed or overwritten.
void requireFreeOutput(const Training& training);
/// With `overwrite`: removes the checkpoint of the stage, and with stage `all` everything that a
/// training writes. Throws InputError naming the file that cannot be removed.
void removeEarlier(const Training& training);

}  // namespace cdiff::learning
