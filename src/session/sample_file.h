// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Samples of one quantity from a file, in the file's unit: one number a line, or the JSON that
/// `cdiff metric shapiro_wilk` reads.
#pragma once

#include <filesystem>
#include <vector>

namespace cdiff::session {

/// Lines: one finite number each; empty lines and what follows '#' are passed over. JSON (the file
/// begins with '{'): {"cases": [{"x": [...]}, ...]}, the samples of all cases together. Throws
/// InputError naming file, line (or case) and what was expected, also for a file without a sample.
std::vector<double> readSamples(const std::filesystem::path& file);

}  // namespace cdiff::session
