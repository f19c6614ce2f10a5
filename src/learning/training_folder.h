// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The output folder of a training: which checkpoints a stage starts from and which it writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "learning/task.h"

namespace cdiff::learning {

/// Checkpoint of a stage in the output folder.
std::filesystem::path checkpointPath(const std::string& output, const std::string& stage);
/// What a stage of the task, or `export`, begins with; nothing for `all`.
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
