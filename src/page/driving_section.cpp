// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/driving_section.h"

#include <cmath>

#include "core/markup.h"
#include "core/text.h"
#include "metrics/known_figures.h"
#include "page/pictures/charts.h"
#include "record/session_table.h"

namespace cdiff::page {
namespace {

std::string sampleText(const std::string& who, const record::Histogram& sample,
                       const std::string& unit) {
  if (sample.n() == 0) return who + ": none";
  std::string text =
      who + ": mean " + core::formatFixed(std::round(100.0 * *sample.mean()) / 100.0 + 0.0, 2);
  if (const auto deviation = sample.standardDeviation()) {
    text += " ± " + core::formatFixed(*deviation, 2);
  }
  return text + " " + unit + ", n = " + std::to_string(sample.n());
}

std::string chart(const std::string& title, const std::string& unit, const record::Histogram& cbv,
                  const record::Histogram& background) {
  return histogramSvg(
      {title, unit, {{"bg", &background}, {"cbv c0", &cbv}}},
      sampleText("CBV", cbv, unit) + "; " + sampleText("background", background, unit));
}

std::string legend() {
  const std::string sign = "<span class=\"item\"><svg viewBox=\"0 0 28 14\" aria-hidden=\"true\">";
  return "<p class=\"legend\">\n" + sign +
         "<path class=\"bars cbv c0\" d=\"M3 13V3H25V13\"/></svg>CBVs</span>\n" + sign +
         "<path class=\"bars bg\" d=\"M3 13V3H25V13\"/></svg>background vehicles</span>\n</p>\n";
}

}  // namespace

std::string drivingSection(const record::SessionResult& result) {
  const record::DrivingLog& log = result.driving;
  if (log.cbv().speed.n() + log.background().speed.n() == 0) {
    return "<p class=\"note\">No vehicle but the ego was seen at a decision.</p>\n";
  }
  const metrics::SessionMeasures& measures = result.measures;
  return legend() + "<div class=\"charts\">\n" +
         chart("Speed", "m/s", log.cbv().speed, log.background().speed) +
         chart("Acceleration", "m/s²", log.cbv().acceleration, log.background().acceleration) +
         "</div>\n<p class=\"note\">One value per vehicle and decision; ± is the standard "
         "deviation "
         "over them. Shapiro-Wilk W of CBVs: speed " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kSpeedShapiroWilk), 3)) +
         ", acceleration " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kAccelerationShapiroWilk), 3)) +
         ". Wasserstein distance of CBV speeds to background vehicles within 150 m of the ego: " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kSpeedWasserstein), 3)) +
         ".</p>\n";
}

}  // namespace cdiff::page
