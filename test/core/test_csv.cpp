// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/csv.h"

namespace cdiff::core {
namespace {

TEST(Csv, QuotesOnlyWhereItMust) {
  EXPECT_EQ(csvCell("plain text"), "plain text");
  EXPECT_EQ(csvCell("a,b"), "\"a,b\"");
  EXPECT_EQ(csvCell("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csvRow({"", "a", "", "b,c"}), ",a,,\"b,c\"\n");
}

// OWASP, "CSV Injection": = + - @, tab and carriage return begin a formula in a spreadsheet.
TEST(Csv, KeepsSpreadsheetsFromComputingTexts) {
  EXPECT_EQ(csvCell("=HYPERLINK(\"x\",1)"), "\"'=HYPERLINK(\"\"x\"\",1)\"");
  EXPECT_EQ(csvCell("+cmd"), "'+cmd");
  EXPECT_EQ(csvCell("-E1.2"), "'-E1.2");
  EXPECT_EQ(csvCell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csvCell("\t=1"), "'\t=1");
  EXPECT_EQ(csvRow({"-1.5", "+2", "-inf", "-1e-07", "a=b", "'quoted'"}),
            "-1.5,+2,-inf,-1e-07,a=b,'quoted'\n");
}

TEST(Csv, ReadsBackWhatItWrote) {
  const std::vector<std::string> cells = {"",   "a,b", "\"",   "\"\"x", "",       "1.5",  "-2",
                                          "=x", "'=x", "''-y", "'q'",   "-a,\"b", "-inf", ""};
  const std::string row = csvRow(cells);
  EXPECT_EQ(csvCells(row.substr(0, row.size() - 1)), cells);
  EXPECT_EQ(csvCells(""), std::vector<std::string>{""});
}

}  // namespace
}  // namespace cdiff::core
