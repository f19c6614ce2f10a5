// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The output folder of a training: which checkpoints a stage starts from and which it writes.
#pragma once

#include <string>
#include <vector>

#include "training/trainer.h"

namespace cdiff::training {

/// Stages whose checkpoint gives `stage` its encoder, the best first; none where it begins anew.
std::vector<std::string> encoderSources(const std::string& stage);
/// The same of its denoiser.
std::vector<std::string> denoiserSources(const std::string& stage);

/// Throws InputError unless the folder has what the stage starts from, or `init` is given.
void requireSources(const TrainingOptions& options);
/// Throws InputError naming the file when the stage was trained in the folder already, or when a
/// model lies there alone, unless it is to be resumed or overwritten.
void requireFreeOutput(const TrainingOptions& options);
/// With `overwrite`: removes the checkpoint of the stage, and with stage `all` everything that a
/// training writes. Throws InputError naming the file that cannot be removed.
void removeEarlier(const TrainingOptions& options);

}  // namespace cdiff::training
