// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>

#include "learning/stage_runner.h"
#include "learning/task.h"

namespace cdiff::learning {

// Writes the trained model with what it was trained on and how well it does.

/// The weight files (F16), training.json and model_card.md in the output folder. `results` are the
/// stages that ran or lie in checkpoints. Throws InputError for a file that cannot be written.
void writeModel(const TrainingRun& run, const TrainedModel& model,
                const std::map<std::string, StageResult>& results);

}  // namespace cdiff::learning
