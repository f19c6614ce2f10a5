// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/markup.h"

namespace cdiff::record {
namespace {

TEST(Markup, EscapesWhatXmlReads) {
  EXPECT_EQ(core::escapeMarkup("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(core::escapeMarkup("Zürich – 東京"), "Zürich – 東京");
  EXPECT_EQ(core::escapeMarkup("a\tb\nc"), "a\tb\nc");
}

TEST(Markup, ReplacesWhatXmlForbids) {
  EXPECT_EQ(core::escapeMarkup(std::string("a\0b\x1b", 4)), "a\uFFFDb\uFFFD");
  EXPECT_EQ(core::escapeMarkup("\xff"), "\uFFFD");            // no UTF-8
  EXPECT_EQ(core::escapeMarkup("\xc3"), "\uFFFD");            // cut off
  EXPECT_EQ(core::escapeMarkup("\xc0\xbc"), "\uFFFD\uFFFD");  // '<' in two bytes: overlong
  EXPECT_EQ(core::escapeMarkup("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");  // half of a surrogate pair
}

TEST(Markup, ShortNumbersHaveOneDecimalAtMost) {
  EXPECT_EQ(core::shortNumber(12.0), "12");
  EXPECT_EQ(core::shortNumber(12.34), "12.3");
  EXPECT_EQ(core::shortNumber(-0.04), "0");
}

}  // namespace
}  // namespace cdiff::record
