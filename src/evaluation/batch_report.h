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

/// Writes them all, each file whole. Throws InputError naming the file for a folder without
/// records, a damaged record, summary or trace, and a file that cannot be written.
void writeBatchReport(const std::filesystem::path& results, const std::string& name);

/// Text of tables.md.
std::string tablesMarkdown(const std::vector<Table>& tables);

/// Text of index.html: what failed first, every run with a link to its report, tables and figures;
/// self-contained. Elements of class "wall-clock" hold all that depends on wall-clock time.
std::string batchPage(const std::string& name, const std::vector<BatchRun>& runs,
                      const std::vector<Table>& tables, const std::vector<Figure>& figures);

// Style sheets of a batch's page: the files in evaluation/assets.

extern const core::Asset kBatchPageStyle;

}  // namespace cdiff::evaluation
