// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Weights of PPO that a test can compute by hand.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "planners/ppo/ppo_network.h"
#include "support/tensors.h"

namespace cdiff::test {

/// Every weight 0 but those of the last bias: the mean of the actor is (`acceleration`, `steer`)
/// whatever it sees.
inline planners::PpoActor::Weights constantPpo(float acceleration, float steer) {
  auto weights = uniformTensors(planners::PpoActor::tensors(), 0.0);
  weights.at("actor.last.bias").values = {acceleration, steer};
  return weights;
}

inline void writePpo(const std::filesystem::path& folder,
                     const planners::PpoActor::Weights& weights,
                     const std::string& format = planners::kPpo.format) {
  inference::SafetensorsFile file;
  file.metadata = {{"format", format}};
  file.tensors = weights;
  inference::writeSafetensors(folder / planners::kPpo.file, file, inference::TensorType::kF32);
}

}  // namespace cdiff::test
