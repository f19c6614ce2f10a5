// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Checkpoints and caches of the trainer: facts as JSON and named float32 tensors in one file, with
/// a SHA-256 at its end; written atomically.
#pragma once

#include <ATen/ATen.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cdiff::learning {

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

}  // namespace cdiff::learning
