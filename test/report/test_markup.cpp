// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/report/markup.h"

namespace cdiff::report {
namespace {

TEST(Markup, EscapesWhatXmlReads) {
  EXPECT_EQ(escapeMarkup("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(escapeMarkup("Zürich – 東京"), "Zürich – 東京");
  EXPECT_EQ(escapeMarkup("a\tb\nc"), "a\tb\nc");
}

TEST(Markup, ReplacesWhatXmlForbids) {
  EXPECT_EQ(escapeMarkup(std::string("a\0b\x1b", 4)), "a\uFFFDb\uFFFD");
  EXPECT_EQ(escapeMarkup("\xff"), "\uFFFD");                      // no UTF-8
  EXPECT_EQ(escapeMarkup("\xc3"), "\uFFFD");                      // cut off
  EXPECT_EQ(escapeMarkup("\xc0\xbc"), "\uFFFD\uFFFD");            // '<' in two bytes: overlong
  EXPECT_EQ(escapeMarkup("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");  // half of a surrogate pair
}

TEST(Markup, ShortNumbersHaveOneDecimalAtMost) {
  EXPECT_EQ(shortNumber(12.0), "12");
  EXPECT_EQ(shortNumber(12.34), "12.3");
  EXPECT_EQ(shortNumber(-0.04), "0");
}

}  // namespace
}  // namespace cdiff::report
