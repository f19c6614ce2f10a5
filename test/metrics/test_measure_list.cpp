// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "metrics/metric_registry.h"

namespace cdiff::metrics {
namespace {

TEST(MeasureList, IsInTheDocumentationWordByWord) {
  const std::string page = core::readFile(core::shareFolder() / "docs" / "metrics.md", "page");
  for (const MeasureDefinition& definition : measureDefinitions()) {
    EXPECT_NE(page.find(definition.definition), std::string::npos) << definition.name;
    EXPECT_NE(page.find(definition.rift_compat), std::string::npos) << definition.name;
  }
  EXPECT_NE(page.find(measureList()), std::string::npos)
      << "put the output of `cdiff metric definitions` into docs/metrics.md";
}

TEST(MeasureList, HasASectionPerMeasure) {
  const std::string list = measureList();
  const std::string section =
      "### `cbv_collisions`\n\nCollisions of CBVs; count; of CBVs; no direction; count over the km "
      "of CBVs; "
      "`/cbv/collisions`\n\n";
  EXPECT_NE(list.find(section), std::string::npos);
}

}  // namespace
}  // namespace cdiff::metrics
