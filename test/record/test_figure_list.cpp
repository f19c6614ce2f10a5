// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "metrics/metric_registry.h"
#include "record/metric_file.h"

namespace cdiff::record {
namespace {

TEST(FigureList, IsInTheDocumentationWordByWord) {
  const std::string page = core::readFile(core::shareFolder() / "docs" / "metrics.md", "page");
  for (const metrics::FigureDefinition& figure : metrics::figureDefinitions()) {
    EXPECT_NE(page.find(figure.definition), std::string::npos) << figure.name;
    EXPECT_NE(page.find(figure.rift_compat), std::string::npos) << figure.name;
  }
  EXPECT_NE(page.find(figureList()), std::string::npos)
      << "put the output of `cdiff metric definitions` into docs/metrics.md";
}

TEST(FigureList, HasASectionAFigure) {
  const std::string list = figureList();
  const std::string section =
      "### `cbv_collisions`\n\nCollisions of CBVs; count; of CBVs; no direction; "
      "`/cbv/collisions`\n\n";
  EXPECT_NE(list.find(section), std::string::npos);
}

}  // namespace
}  // namespace cdiff::record
