// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <iosfwd>

#include "learning/training_options.h"

namespace cdiff::learning {

// Trains a task in its stages. Each stage starts from the averaged weights of the checkpoints in
// the output folder.

/// Runs the stage, or all of them, and writes the model (weight files, `training.json`,
/// `model_card.md`) where its parts are whole. `stop`, set from another thread or a signal, ends it
/// after the current step with a checkpoint and core::Interrupted. Throws InputError for wrong
/// options, for data without samples or without a field that the task needs, and for an output
/// folder that holds a training of the stage unless it is to be resumed or overwritten.
void train(const Training& training, const std::atomic<bool>& stop, std::ostream& log);

}  // namespace cdiff::learning
