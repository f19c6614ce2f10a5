// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/driving_section.h"

#include <cmath>

#include "core/text.h"
#include "metrics/known_measures.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "record/session_text.h"

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

Markup chart(const std::string& title, const std::string& unit, const record::Histogram& cbv,
             const record::Histogram& background) {
  return histogramSvg(
      {title, unit, {{"bg", &background}, {"cbv c0", &cbv}}},
      sampleText("CBV", cbv, unit) + "; " + sampleText("background", background, unit));
}

Markup drivingLegend() {
  const auto item = [](const char* style, const char* text) {
    return legendItem(element("path", {{"class", style}, {"d", "M3 13V3H25V13"}}), text);
  };
  return pageLegend(item("bars cbv c0", "CBVs") + item("bars bg", "background vehicles"));
}

/// How even the speeds and accelerations of CBVs are, and what they are compared with.
std::string distributionText(const metrics::SessionMeasures& measures) {
  namespace known = metrics::known;
  const auto text = [&](const metrics::MeasureDefinition& definition) {
    return record::measureText(measures.at(definition), 3);
  };
  return "One value per vehicle and decision; ± is the standard deviation over them. Shapiro-Wilk "
         "W of CBVs: speed " +
         text(known::kSpeedShapiroWilk) + ", acceleration " +
         text(known::kAccelerationShapiroWilk) + ". Wasserstein distance of CBV speeds to " +
         measures.at(known::kSpeedWasserstein).target + ": " + text(known::kSpeedWasserstein) + ".";
}

}  // namespace

Markup drivingSection(const record::SessionResult& result) {
  const record::DrivingLog& log = result.driving;
  if (log.cbv().speed.n() + log.background().speed.n() == 0)
    return pageNote("No vehicle but the ego was seen at a decision.");
  const Markup charts =
      chart("Speed", "m/s", log.cbv().speed, log.background().speed) +
      chart("Acceleration", "m/s²", log.cbv().acceleration, log.background().acceleration);
  return drivingLegend() + element("div", {{"class", "charts"}}, "\n" + charts) + "\n" +
         pageNote(distributionText(result.measures));
}

}  // namespace cdiff::page
