// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Weights of PPO that a test can compute by hand.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "planners/ppo/ppo_network.h"

namespace cdiff::test {

/// Every weight 0 but those of the last bias: the mean of the actor is (`acceleration`, `steer`)
/// whatever it sees.
inline planners::PpoActor::Weights constantPpo(float acceleration, float steer) {
  planners::PpoActor::Weights weights;
  for (const inference::TensorShape& tensor : planners::PpoActor::tensors()) {
    std::size_t count = 1;
    for (const std::int64_t size : tensor.shape) count *= static_cast<std::size_t>(size);
    weights[tensor.name] = {tensor.shape, std::vector<float>(count, 0.0F)};
  }
  weights.at("actor.last.bias").values = {acceleration, steer};
  return weights;
}

inline void writePpo(const std::filesystem::path& folder,
                     const planners::PpoActor::Weights& weights,
                     const std::string& format = planners::PpoActor::kFormat) {
  inference::SafetensorsFile file;
  file.metadata = {{"format", format}};
  file.tensors = weights;
  inference::writeSafetensors(folder / planners::PpoActor::kFile, file,
                              inference::TensorType::kF32);
}

}  // namespace cdiff::test
