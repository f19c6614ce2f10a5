// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/text.h"
#include "page/top_view.h"

namespace cdiff::page {
namespace {

std::string item(const std::string& picture, const std::string& text) {
  return "<span class=\"item\"><svg viewBox=\"0 0 28 14\" aria-hidden=\"true\">" + picture +
         "</svg>" + text + "</span>\n";
}

std::string lineItem(const std::string& style, const std::string& text) {
  return item("<path class=\"" + style + "\" d=\"M1 7H27\"/>", text);
}

std::string boxItem(const std::string& style, const std::string& text) {
  return item("<g class=\"vehicle " + style + "\" transform=\"translate(14 7)\"><path " +
                  "d=\"M-10 -4H10V4H-10Z\"/><path class=\"nose\" d=\"M3 -3L8 0L3 3Z\"/></g>",
              text);
}

}  // namespace

std::string topViewLegend(const MapCanvas& canvas) {
  std::string html =
      "<p class=\"legend\">\n" + boxItem("ego", "ego") + boxItem("cbv c0", "CBV") +
      boxItem("bg", "background") + lineItem("route", "ego route") +
      lineItem("trail ego", "driven by the ego") + lineItem("trail cbv c0", "driven as CBV") +
      lineItem("trail bg", "driven by background") +
      lineItem("planned cbv c0", "conflict-aware route") +
      item("<path class=\"conflict\" d=\"M9 2l10 10m0 -10l-10 10\"/>",
           "conflict point as selected") +
      item("<circle class=\"contact\" cx=\"14\" cy=\"7\" r=\"6\"/>", "contact") + "</p>\n";
  const double magnification = vehicleMagnification(canvas);
  if (magnification > 1.0) {
    html += "<p class=\"note\">Vehicles are drawn " + core::formatFixed(magnification, 1) +
            " times as large as they are.</p>\n";
  }
  return html;
}

}  // namespace cdiff::page
