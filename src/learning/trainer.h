// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <iosfwd>
#include <map>
#include <string>

#include "learning/stage_runner.h"
#include "learning/task.h"
#include "learning/training_options.h"

namespace cdiff::learning {

// Writes the trained model with what it was trained on and how well it does.

/// The weight files (F16), training.json and model_card.md in the output folder. `results` are the
/// stages that ran or lie in checkpoints. Throws InputError for a file that cannot be written.
void writeModel(const TrainingRun& run, const TrainedModel& model,
                const std::map<std::string, StageResult>& results);

// Trains a task in its stages. Each stage starts from the averaged weights of the checkpoints in
// the output folder.

/// Runs the stage, or all of them, and writes the model (weight files, `training.json`,
/// `model_card.md`) where its parts are whole. `stop`, set from another thread or a signal, ends it
/// after the current step with a checkpoint and core::Interrupted. Throws InputError for wrong
/// options, for data without samples or without a field that the task needs, and for an output
/// folder that holds a training of the stage unless it is to be resumed or overwritten.
void train(const Training& training, const std::atomic<bool>& stop, std::ostream& log);

}  // namespace cdiff::learning
