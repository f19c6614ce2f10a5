// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <vector>

#include "realism/pooled_realism.h"

namespace cdiff::cli {

// What `cdiff realism pooled` compares, from the files that it is given.

/// Recorded traffic from CSV files, folders of them, and bags of sessions (all vehicles; the site
/// is the bag's name). Throws InputError naming the file.
std::vector<realism::Recording> readLogs(const std::vector<std::filesystem::path>& files);

/// Courses by who drives: the CBVs of each session folder, those of each batch by variant, planner,
/// mode and profile; then all background vehicles. Throws InputError for a folder that is neither,
/// and where no CBV drove.
realism::PooledDrivers pooledDrivers(const std::vector<std::filesystem::path>& folders);

}  // namespace cdiff::cli
