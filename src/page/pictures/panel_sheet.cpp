// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/panel_sheet.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"
#include "page/pictures/charts.h"

namespace cdiff::page {
namespace {

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

std::string panelSvg(const Panel& panel, double x, double y) {
  const std::string size = "width=\"" + core::shortNumber(panel.width) + "\" height=\"" +
                           core::shortNumber(panel.height) + "\"";
  return chartText("panel-title", x, y + 14.0, panel.title) + "\n<svg x=\"" + core::shortNumber(x) +
         "\" y=\"" + core::shortNumber(y + kLine) + "\" " + size + " viewBox=\"0 0 " +
         core::shortNumber(panel.width) + " " + core::shortNumber(panel.height) + "\">\n" +
         panel.content + "</svg>\n";
}

/// Lines of words that fit into a width.
std::vector<std::string> wrapped(const std::string& text, double width) {
  constexpr double kLetter = 6.9;  // mean width of a letter of a note
  const auto most = static_cast<std::size_t>(width / kLetter);
  std::vector<std::string> lines(1);
  for (const std::string& word : core::splitText(text, ' ')) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

/// The sheet's content; `y` becomes its height.
std::string contentOf(const PanelSheet& sheet, double& y) {
  std::string svg;
  for (const std::string& line : wrapped(sheet.title, kTitleShare * widthOf(sheet))) {
    svg += chartText("sheet-title", kPanelMargin, y + 16.0, line) + "\n";
    y += kLine;
  }
  y += 0.4 * kLine;
  for (const auto& [style, text] : sheet.legend) {
    svg += "<path class=\"key " + style + "\" d=\"M" + core::shortNumber(kPanelMargin) + " " +
           core::shortNumber(y + 9.0) + "h26\"/>" +
           chartText("note", kPanelMargin + 34.0, y + 13.0, text) + "\n";
    y += kLine;
  }
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
  for (const std::string& note : sheet.notes) {
    for (const std::string& line : wrapped(note, widthOf(sheet) - 2.0 * kPanelMargin)) {
      svg += chartText("note", kPanelMargin, y + 13.0, line) + "\n";
      y += 0.8 * kLine;
    }
    y += 0.2 * kLine;
  }
  return svg;
}

std::string element(const PanelSheet& sheet, const std::string& attributes,
                    const std::string& style) {
  const double width = widthOf(sheet);
  double height = kPanelMargin;
  const std::string content = contentOf(sheet, height);
  height += kPanelMargin;
  const std::string size =
      "width=\"" + core::shortNumber(width) + "\" height=\"" + core::shortNumber(height) + "\" ";
  return "<svg " + attributes + size + "class=\"sheet\" role=\"img\" aria-label=\"" +
         core::escapeMarkup(sheet.title) + "\" viewBox=\"0 0 " + core::shortNumber(width) + " " +
         core::shortNumber(height) + "\">\n" + style + "<path class=\"paper\" d=\"M0 0H" +
         core::shortNumber(width) + "V" + core::shortNumber(height) + "H0Z\"/>\n" + content +
         "</svg>\n";
}

}  // namespace

const char kPanelSheetStyle[] = R"CSS(
.sheet { font-family: "DejaVu Sans", Roboto, sans-serif; }
.sheet path, .sheet circle { fill: none; stroke-linejoin: round; stroke-linecap: round; }
.sheet path.paper { fill: #ffffff; stroke: none; }
.sheet path.ground { fill: #eef1ec; stroke: #c9ced4; }
.sheet path.road { fill: #d3d7dc; fill-rule: evenodd; stroke: #a3a9b1; stroke-width: 1; }
.sheet path.road.other { opacity: .45; }
.sheet path.lane { stroke: #aeb4bc; stroke-width: .8; stroke-dasharray: 3 4; }
.sheet .vehicle path { stroke: #ffffff; stroke-width: .8; }
.sheet .vehicle.ego path { fill: #c62828; }
.sheet .vehicle.cbv path { fill: #7b1fa2; }
.sheet .vehicle.bg path { fill: #1f6fc4; }
.sheet .vehicle path.nose { fill: #ffffff; stroke: none; }
.sheet circle.interaction { stroke: #e00000; stroke-width: 2.5; }
svg.sheet text.name { stroke: none; }
.sheet path.plan { stroke: #111417; stroke-width: 2; stroke-dasharray: 6 4; }
.sheet path.driven { stroke: #7b1fa2; stroke-width: 3.5; }
.sheet path.key { stroke-width: 4; }
.sheet path.grid { stroke: #d9dde2; stroke-width: 1; }
.sheet path.series { stroke-width: 2; }
.sheet path.error { stroke: #1c2024; stroke-width: 1.2; }
.sheet path.bar { stroke: none; }
.sheet path.scale { stroke: #1c2024; stroke-width: 2; }
.sheet path.north { fill: #1c2024; stroke: none; }
.sheet text { fill: #1c2024; font-size: 12px; stroke: none; }
.sheet text.sheet-title { font-size: 16px; font-weight: 600; }
.sheet text.panel-title { font-size: 13px; font-weight: 600; }
.sheet text.tick, .sheet text.note { fill: #5d6670; }
.sheet text.end { text-anchor: end; }
.sheet text.middle { text-anchor: middle; }
.sheet path.s0 { stroke: #7b1fa2; } .sheet path.bar.s0 { fill: #7b1fa2; }
.sheet path.s1 { stroke: #e65100; } .sheet path.bar.s1 { fill: #e65100; }
.sheet path.s2 { stroke: #1f6fc4; } .sheet path.bar.s2 { fill: #1f6fc4; }
.sheet path.s3 { stroke: #2e7d32; } .sheet path.bar.s3 { fill: #2e7d32; }
.sheet path.s4 { stroke: #ad1457; } .sheet path.bar.s4 { fill: #ad1457; }
.sheet path.s5 { stroke: #00838f; } .sheet path.bar.s5 { fill: #00838f; }
.sheet path.s6 { stroke: #6d4c41; } .sheet path.bar.s6 { fill: #6d4c41; }
.sheet path.s7 { stroke: #757575; } .sheet path.bar.s7 { fill: #bdbdbd; }
)CSS";

std::string systemStyle(std::size_t index) { return "s" + std::to_string(index % 8); }

std::string sheetSvg(const PanelSheet& sheet) { return element(sheet, "", ""); }

std::string sheetFile(const PanelSheet& sheet) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
         element(sheet, "xmlns=\"http://www.w3.org/2000/svg\" ",
                 "<style>" + std::string(kPanelSheetStyle) + "</style>\n");
}

}  // namespace cdiff::page
