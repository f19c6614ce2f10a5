// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

namespace cdiff::cli {

// Writes the page of a training: `training.html` in its output folder.

/// Writes it from the folder's curves.csv and model card, and returns where. Throws InputError when
/// the folder holds no training.
std::filesystem::path writeTrainingPage(const std::filesystem::path& folder);

}  // namespace cdiff::cli
