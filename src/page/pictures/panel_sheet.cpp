// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/panel_sheet.h"

#include <algorithm>

#include "core/text.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"

namespace cdiff::page {
namespace {

using core::element;
using core::Markup;

// Sizes in pixels.
constexpr double kPanelMargin = 16.0;
constexpr double kLine = 20.0;        // of text
constexpr double kTitleShare = 0.66;  // a title's letters are half again as wide as a note's

double widthOf(const PanelSheet& sheet) {
  double width = 560.0;
  for (const auto& row : sheet.rows) {
    double own = 0.0;
    for (const Panel& panel : row) own += panel.width + kPanelMargin;
    width = std::max(width, own - kPanelMargin);
  }
  return width + 2.0 * kPanelMargin;
}

Markup panelSvg(const Panel& panel, double x, double y) {
  const Markup picture = element("svg",
                                 {{"x", x},
                                  {"y", y + kLine},
                                  {"width", panel.width},
                                  {"height", panel.height},
                                  {"viewBox", "0 0 " + svgPlace(panel.width, panel.height)}},
                                 "\n" + panel.content);
  return chartText("panel-title", x, y + 14.0, panel.title) + "\n" + picture + "\n";
}

/// Lines of words that fit into a width.
std::vector<std::string> wrapped(const std::string& text, double width) {
  constexpr double kLetter = 6.9;  // mean width of a letter of a note
  const std::size_t most = std::min(static_cast<std::size_t>(width / kLetter), kMostLineLetters);
  std::vector<std::string> lines(1);
  for (const std::string& word : core::splitText(text, ' ')) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

struct LineStyle {
  const char* name;  ///< CSS class
  double height;     ///< of a line
  double base;       ///< from its top to the foot of its letters
};
constexpr LineStyle kTitleLine{"sheet-title", kLine, 16.0};
constexpr LineStyle kNoteLine{"note", 0.8 * kLine, 13.0};

/// Lines of text from `y` down, which becomes their end.
Markup textLines(const LineStyle& style, const std::vector<std::string>& lines, double& y) {
  Markup svg;
  for (const std::string& line : lines) {
    svg += chartText(style.name, kPanelMargin, y + style.base, line) + "\n";
    y += style.height;
  }
  return svg;
}

Markup legendRows(const PanelSheet& sheet, double& y) {
  Markup svg;
  for (const auto& [style, text] : sheet.legend) {
    const std::string line = "M" + svgPlace(kPanelMargin, y + 9.0) + "h26";
    svg += element("path", {{"class", "key " + style}, {"d", line}}) +
           chartText("note", kPanelMargin + 34.0, y + 13.0, text) + "\n";
    y += kLine;
  }
  return svg;
}

Markup panelRows(const PanelSheet& sheet, double& y) {
  Markup svg;
  for (const auto& row : sheet.rows) {
    double x = kPanelMargin;
    double height = 0.0;
    for (const Panel& panel : row) {
      svg += panelSvg(panel, x, y);
      x += panel.width + kPanelMargin;
      height = std::max(height, panel.height);
    }
    y += height + kLine + kPanelMargin;
  }
  return svg;
}

/// The sheet's content; `y` becomes its height.
Markup contentOf(const PanelSheet& sheet, double& y) {
  Markup svg = textLines(kTitleLine, wrapped(sheet.title, kTitleShare * widthOf(sheet)), y);
  y += 0.4 * kLine;
  svg += legendRows(sheet, y);
  svg += panelRows(sheet, y);
  for (const std::string& note : sheet.notes) {
    svg += textLines(kNoteLine, wrapped(note, widthOf(sheet) - 2.0 * kPanelMargin), y);
    y += 0.2 * kLine;
  }
  return svg;
}

Markup sheetElement(const PanelSheet& sheet, std::vector<core::Attribute> attributes,
                    const Markup& style) {
  const double width = widthOf(sheet);
  double height = kPanelMargin;
  const Markup content = contentOf(sheet, height);
  height += kPanelMargin;
  const std::vector<core::Attribute> own = {
      {"width", width}, {"height", height},          {"class", "sheet"},
      {"role", "img"},  {"aria-label", sheet.title}, {"viewBox", "0 0 " + svgPlace(width, height)}};
  attributes.insert(attributes.end(), own.begin(), own.end());
  const std::string paper =
      "M0 0H" + core::shortNumber(width) + "V" + core::shortNumber(height) + "H0Z";
  return element("svg", attributes, "\n" + style + svgPath("paper", paper) + content);
}

}  // namespace

std::string systemStyle(std::size_t index) { return "s" + std::to_string(index % 8); }

Markup sheetSvg(const PanelSheet& sheet) { return sheetElement(sheet, {}, {}) + "\n"; }

std::string sheetFile(const PanelSheet& sheet) {
  return core::xmlDocument(sheetElement(sheet, {{"xmlns", "http://www.w3.org/2000/svg"}},
                                        core::styleElement({&kPanelSheetStyle})));
}

}  // namespace cdiff::page
