// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "inference/safetensors.h"
#include "planners/pluto/pluto_architecture.h"

namespace cdiff::planners {

/// Weights of `pluto` or `rift` as a file holds them.
struct PlutoModel {
  PlutoArchitecture architecture;
  std::map<std::string, inference::Tensor> weights;
};

/// Whose weights a file holds: both planners have the same network.
struct PlutoKind {
  const char* planner;  ///< name of the planner and of its training task
  const char* file;     ///< in the folder of the weights
  const char* format;   ///< metadata key "format"
};
inline constexpr PlutoKind kPluto = {"pluto", "pluto.safetensors", "e2e_cdiff.pluto.1"};
inline constexpr PlutoKind kRift = {"rift", "rift.safetensors", "e2e_cdiff.rift.1"};

inline constexpr std::int64_t kPlutoFrequencies = 16;  ///< of each number of a pose

/// Names and shapes of the weights. Of two dimensions and more: `NAME.weight` of layers and
/// `table.NAME`, rows that are learned as they are.
std::vector<inference::TensorShape> plutoTensors(const PlutoArchitecture& architecture);
/// Whether a tensor belongs to the score head, the part that RIFT trains.
bool ofScoreHead(const std::string& tensor);

/// The file in `folder`. Throws InputError with the command that trains it where there is none.
std::filesystem::path plutoWeightFile(const PlutoKind& kind, const std::filesystem::path& folder);
/// Throws InputError naming the file and what is wrong: none, of another planner, of other sizes;
/// see readSafetensors.
PlutoModel readPlutoModel(const PlutoKind& kind, const std::filesystem::path& folder);
/// Metadata of the file.
std::map<std::string, std::string> plutoMetadata(const PlutoKind& kind,
                                                 const PlutoArchitecture& architecture);

}  // namespace cdiff::planners
