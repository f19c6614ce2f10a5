// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::cli {

// The table of a batch of Bench2Drive routes: a line per run, and counts over all.

/// In Markdown. Towns are read from the route file; the rest from each run's summary.json below
/// `results`.
std::string routeTable(const std::vector<evaluation::RunRecord>& records,
                       const std::string& bench2drive, const std::filesystem::path& results);

}  // namespace cdiff::cli
