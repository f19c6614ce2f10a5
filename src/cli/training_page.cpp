// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/training_page.h"

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/training_report.h"

namespace cdiff::cli {

namespace fs = std::filesystem;

fs::path writeTrainingPage(const fs::path& folder) {
  const fs::path curves = folder / "curves.csv";
  if (!core::isFile(curves)) {
    throw core::InputError("'" + folder.string() +
                           "' is no output folder of `cdiff train`: it has no curves.csv");
  }
  const fs::path card = folder / "model_card.md";
  const auto stages =
      page::readTrainingCurves(core::readFile(curves, "training curves"), curves.string());
  const fs::path page = folder / "training.html";
  const std::string title = fs::weakly_canonical(folder).filename().string();
  core::writeFileAtomically(
      page, page::trainingReport(title, stages,
                                 fs::exists(card) ? core::readFile(card, "model card") : ""));
  return page;
}

}  // namespace cdiff::cli
