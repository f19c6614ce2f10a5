// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "core/markup.h"
#include "record/outcome.h"

namespace cdiff::page {

// Style sheets and scripts of the pages: the files in page/assets, written into each page so that
// it needs nothing else.

extern const core::Asset kReportStyle;  ///< of all pages
extern const core::Asset kReportScript;
extern const core::Asset kPanelSheetStyle;
extern const core::Asset kSampleSheetStyle;

// What HTML pages are made of: the document with its style sheets, headings, sections, the banner
// with an outcome, tables, legends.

using core::element;
using core::Markup;

/// Text of a self-contained page: `content` in <main>, then `end`. The `styles` follow the common
/// sheet.
std::string pageDocument(const std::string& title, const std::vector<const core::Asset*>& styles,
                         const Markup& content, const Markup& end = {});

/// The page's heading, a line in small letters, and what follows them.
Markup pageHeader(const std::string& title, const std::string& line, const Markup& rest = {});

/// A part of a page under a heading of its own.
struct PageSection {
  std::string title;
  Markup content;
};
/// Links to sections by their titles.
Markup pageContents(const std::vector<PageSection>& sections);
/// All of them, one below another.
Markup pageSections(const std::vector<PageSection>& sections);

/// A <section> with a heading, its id made of it; `style`: its class, or none.
Markup pageSection(const std::string& title, const Markup& content, const std::string& style = "");

/// The sign of an outcome and `headline`, in its colors, above `content`.
Markup pageBanner(record::Outcome outcome, const std::string& headline, const Markup& content);

/// A paragraph in soft color.
Markup pageNote(const std::string& text);

/// A time of the session [s] that the playback goes to on a click.
Markup timeLink(double seconds);
/// A text in which every "at 12.34 s" is such a link.
Markup linkedTimes(const std::string& text);

/// A word or two that open to more.
Markup pageFold(const Markup& summary, const Markup& content, const std::string& style = "");

/// A row of a legend: a picture of 28 x 14 pixels, and text.
Markup legendItem(const Markup& picture, const std::string& text);
/// The same with a line of a CSS class.
Markup legendLine(const std::string& style, const std::string& text);
/// Around such rows.
Markup pageLegend(const Markup& items);

/// Rows under a head; a column whose name starts with '#' holds numbers. Long words are broken by
/// the style sheet.
class HtmlTable {
 public:
  /// Without names: no head.
  explicit HtmlTable(const std::vector<std::string>& head);

  /// As many cells as the head has; `style`: a class, or none.
  void row(const std::vector<Markup>& cells, const std::string& style = {});
  Markup html() const;

 private:
  std::vector<bool> numeric_;
  Markup head_;
  Markup rows_;
};

}  // namespace cdiff::page
