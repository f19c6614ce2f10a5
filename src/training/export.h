// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Writes the trained model with what it was trained on and how well it does.
#pragma once

#include <map>
#include <string>

#include "training/stage.h"
#include "training/stage_runner.h"

namespace cdiff::training {

/// encoder.safetensors, denoiser.safetensors (F16), training.json and model_card.md in the output
/// folder. `results` are the stages that ran or lie in checkpoints.
void exportModel(const TrainingState& state, const std::map<std::string, StageResult>& results);

}  // namespace cdiff::training
