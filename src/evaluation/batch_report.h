// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/markup.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_table.h"

namespace cdiff::evaluation {

// What a finished batch is read by: tables/table_N.csv, tables/tables.md, figures/figure_N.csv and
// .svg, figures/trails.csv and .svg, index.html. All are functions of the folder's records and
// runs, and need nothing to run.

/// Writes them all, each file whole. The page of the matrix paper_tables shows the paper's tables
/// and figures; all others have them as files alone. Throws InputError naming the file for a folder
/// without records, a damaged record, summary or trace, and a file that cannot be written.
void writeBatchReport(const std::filesystem::path& results, const std::string& name);

/// Text of tables.md.
std::string tablesMarkdown(const std::vector<Table>& tables);

/// Text of index.html, self-contained: which system is the hardest for the ego, scenarios against
/// systems, the worst moments as links into reports, every run, tables and figures. `skipped`: what
/// the batch left out, a line each. Elements of class "wall-clock" hold all that depends on
/// wall-clock time.
std::string batchPage(const std::string& name, const std::vector<BatchRun>& runs,
                      const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const std::string& skipped = "");

/// File of a result folder with what its matrix left out, a line each.
inline constexpr const char* kSkippedFile = "left_out.txt";

// Style sheet and script of a batch's page: the files in evaluation/assets.

extern const core::Asset kBatchPageStyle;
extern const core::Asset kBatchPageScript;

}  // namespace cdiff::evaluation
