// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/markup.h"

namespace cdiff::core {
namespace {

std::string markupOf(const std::string& text) { return Markup(text).str(); }

TEST(Markup, EscapesWhatXmlReads) {
  EXPECT_EQ(markupOf("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(markupOf("Zürich – 東京"), "Zürich – 東京");
  EXPECT_EQ(markupOf("a\tb\nc"), "a\tb\nc");
  EXPECT_EQ(markupOf("]]>"), "]]&gt;");
}

TEST(Markup, ReplacesWhatXmlForbids) {
  EXPECT_EQ(markupOf(std::string("a\0b\x1b", 4)), "a\uFFFDb\uFFFD");
  EXPECT_EQ(markupOf("\x01\x7f\r"), "\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(markupOf("\xc2\x85"), "\uFFFD");                  // U+0085
  EXPECT_EQ(markupOf("\xc2\xa0"), "\xc2\xa0");                // U+00A0, a space
  EXPECT_EQ(markupOf("\xef\xbf\xbf"), "\uFFFD");              // U+FFFF
  EXPECT_EQ(markupOf("\xff"), "\uFFFD");                      // no UTF-8
  EXPECT_EQ(markupOf("\xc3"), "\uFFFD");                      // cut off
  EXPECT_EQ(markupOf("\xc0\xbc"), "\uFFFD\uFFFD");            // '<' in two bytes: overlong
  EXPECT_EQ(markupOf("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");  // half of a surrogate pair
}

TEST(Markup, ReplacesMarksThatTurnTheDirection) {
  for (const char* mark :
       {"\u202A", "\u202B", "\u202C", "\u202D", "\u202E", "\u2066", "\u2067", "\u2068", "\u2069"})
    EXPECT_EQ(markupOf(mark), "\uFFFD");
  EXPECT_EQ(markupOf("\u2029\u202F\u2065\u206A"), "\u2029\u202F\u2065\u206A");  // their neighbors
  EXPECT_EQ(markupOf("שלום"), "שלום");
  EXPECT_EQ(markupOf("\U0001F600"), "\U0001F600");
}

TEST(Markup, ElementsEscapeAttributesAndText) {
  const std::string text = "a<b>\"&\x01";
  EXPECT_EQ(
      element("p", {{"class", text}, {"x", 1.25}, flag("hidden")}, text).str(),
      "<p class=\"a&lt;b&gt;&quot;&amp;\uFFFD\" x=\"1.3\" hidden>a&lt;b&gt;&quot;&amp;\uFFFD</p>");
  EXPECT_EQ(element("b", {}, text + element("i") + text).str(),
            "<b>a&lt;b&gt;&quot;&amp;\uFFFD<i></i>a&lt;b&gt;&quot;&amp;\uFFFD</b>");
  EXPECT_EQ(element("p", {}, element("b").str()).str(),
            "<p>&lt;b&gt;&lt;/b&gt;</p>");  // text again
}

TEST(Markup, ElementsWithoutContentEndAsTheirKindDoes) {
  EXPECT_EQ(element("img", {{"width", 640}}).str(), "<img width=\"640\">");
  EXPECT_EQ(element("path", {{"d", "M0 0"}}).str(), "<path d=\"M0 0\"/>");
  EXPECT_EQ(element("path", {}, "x").str(), "<path>x</path>");
  EXPECT_EQ(element("tbody").str(), "<tbody></tbody>");
}

TEST(Markup, JsonCannotEndItsScript) {
  const std::string script = jsonElement("id", "[\"</script><b>\u202E\"]").str();
  EXPECT_EQ(script,
            "<script type=\"application/json\" id=\"id\">"
            "[\"\\u003c/script>\\u003cb>\uFFFD\"]</script>\n");
}

TEST(Markup, LongTextsAreCutAtCharacters) {
  EXPECT_EQ(cutText("abc", 3), "abc");
  EXPECT_EQ(cutText("abcd", 3), "ab…");
  EXPECT_EQ(cutText("äöüß", 3), "äö…");
  EXPECT_EQ(cutText("\x01\x02", 2), "\uFFFD\uFFFD");
  EXPECT_EQ(cutText("", 3), "");
}

TEST(Markup, MarkdownStaysInItsCell) {
  EXPECT_EQ(markdownText("a|b\n<b>[x](y)"), "a\\|b &lt;b>\\[x](y)");
}

TEST(Markup, ShortNumbersHaveOneDecimalAtMost) {
  EXPECT_EQ(shortNumber(12.0), "12");
  EXPECT_EQ(shortNumber(12.34), "12.3");
  EXPECT_EQ(shortNumber(-0.04), "0");
}

}  // namespace
}  // namespace cdiff::core
