// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/csv.h"

namespace cdiff::core {
namespace {

TEST(Csv, QuotesOnlyWhereItMust) {
  EXPECT_EQ(csvCell("plain text"), "plain text");
  EXPECT_EQ(csvCell("a,b"), "\"a,b\"");
  EXPECT_EQ(csvCell("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csvRow({"", "a", "", "b,c"}), ",a,,\"b,c\"\n");
}

TEST(Csv, ReadsBackWhatItWrote) {
  const std::vector<std::string> cells = {"", "a,b", "\"", "\"\"x", "", "1.5", ""};
  const std::string row = csvRow(cells);
  EXPECT_EQ(csvCells(row.substr(0, row.size() - 1)), cells);
  EXPECT_EQ(csvCells(""), std::vector<std::string>{""});
}

}  // namespace
}  // namespace cdiff::core
