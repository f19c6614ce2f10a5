// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

// Texts of a batch's files: runs.csv (a row per planned run), summary.json (a cell per
// combination), junit.xml (a case per run), summary.md (a table of cells).

std::string runsCsv(const std::vector<RunRecord>& records);
std::string batchSummaryJson(const std::string& name, const std::vector<RunRecord>& records);
std::string batchJunitXml(const std::string& name, const std::vector<RunRecord>& records);
std::string batchMarkdown(const std::string& name, const std::vector<RunRecord>& records);

/// Writes all four, each whole.
void writeBatchFiles(const std::filesystem::path& results, const std::string& name,
                     const std::vector<RunRecord>& records);

}  // namespace cdiff::evaluation
