// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/sample_sheet.h"

#include <map>

#include "core/text.h"
#include "diffusion/network/architecture.h"
#include "learning/samples/sample_order.h"
#include "page/assets.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "record/logs/cbv_log.h"

namespace cdiff::page {
namespace {

constexpr double kAhead = 45.0;        // [m] shown
constexpr double kBehind = 5.0;        // [m] shown
constexpr double kAside = 20.0;        // [m] shown to each side
constexpr Eigen::Index kDotEvery = 8;  // rows: 0.8 s

/// Body frame to the picture: forward is up, left is left.
std::string at(double x, double y) {
  return core::formatFixed(-y, 2) + " " + core::formatFixed(-x, 2);
}

Markup samplePath(const char* style, const std::vector<std::pair<double, double>>& points) {
  std::string data = "M0 0";
  for (const auto& [x, y] : points) data += "L" + at(x, y);
  return element("path", {{"class", style}, {"d", data}});
}

Markup wayOf(const learning::DrivingSample& sample) {
  std::vector<std::pair<double, double>> way;
  for (std::size_t i = 0; i + 1 < sample.route.size(); i += 2)
    way.emplace_back(diffusion::kRouteTokenScale * sample.route[i],
                     diffusion::kRouteTokenScale * sample.route[i + 1]);
  return samplePath("way", way);
}

/// The line that was driven, with dots.
Markup drivenOf(const learning::DrivingSample& sample) {
  std::vector<std::pair<double, double>> driven;
  Markup dots;
  for (Eigen::Index t = 0; t < sample.rollout.rows(); ++t) {
    driven.emplace_back(sample.rollout(t, traffic::kRolloutX),
                        sample.rollout(t, traffic::kRolloutY));
    if ((t + 1) % kDotEvery != 0) continue;
    dots += element("circle", {{"r", ".7"},
                               {"cx", core::formatFixed(-driven.back().second, 2)},
                               {"cy", core::formatFixed(-driven.back().first, 2)}});
  }
  return samplePath("driven", driven) + dots;
}

Markup sampleFromAbove(const learning::DrivingSample& sample) {
  const std::string box = core::formatFixed(-kAside, 0) + " " + core::formatFixed(-kAhead, 0) +
                          " " + core::formatFixed(2.0 * kAside, 0) + " " +
                          core::formatFixed(kAhead + kBehind, 0);
  const Markup vehicle =
      element("rect", {{"x", "-1"}, {"y", "-2.2"}, {"width", "2"}, {"height", "4.4"}});
  return element("svg", {{"role", "img"}, {"aria-label", "from above"}, {"viewBox", box}},
                 wayOf(sample) + vehicle + drivenOf(sample));
}

std::string captionOf(const learning::DrivingSample& sample) {
  const auto mean = [&](int column) {
    return core::formatFixed(sample.rollout.col(column).mean(), 2);
  };
  const double last = sample.rollout(sample.rollout.rows() - 1, traffic::kRolloutSpeed);
  return core::formatFixed(sample.speed, 1) + " → " + core::formatFixed(last, 1) +
         " m/s; mean throttle " + mean(traffic::kRolloutThrottle) + ", steer " +
         mean(traffic::kRolloutSteer) + ", brake " + mean(traffic::kRolloutBrake) +
         (sample.recovering ? "; recovering" : "");
}

Markup figureOf(const learning::DrivingSample& sample) {
  const Markup image =
      element("img", {{"alt", "front view"}, {"src", record::pngDataUri(sample.image)}});
  return element("figure", {{"class", "sample"}},
                 image + sampleFromAbove(sample) + element("figcaption", {}, captionOf(sample))) +
         "\n";
}

Markup tableOf(const std::vector<CountRow>& counts) {
  HtmlTable table({});
  for (const CountRow& row : counts) table.row({row.name, row.number, row.share});
  return table.html();
}

}  // namespace

std::vector<std::pair<std::string, std::vector<std::size_t>>> samplesByKind(
    const learning::DrivingDataset& dataset, std::size_t count) {
  std::map<std::string, std::vector<std::size_t>> all;
  for (std::size_t i = 0; i < dataset.size(); ++i)
    all[learning::balanceClass(dataset.withoutImage(i))].push_back(i);
  std::vector<std::pair<std::string, std::vector<std::size_t>>> chosen;
  for (const auto& [kind, indices] : all) {
    const std::size_t shown = std::min(count, indices.size());
    std::vector<std::size_t> some;
    for (std::size_t i = 0; i < shown; ++i) some.push_back(indices[i * indices.size() / shown]);
    chosen.emplace_back(kind + " (" + std::to_string(indices.size()) + ")", some);
  }
  return chosen;
}

std::string sampleSheet(const std::string& title, const std::vector<CountRow>& counts,
                        const learning::DrivingDataset& dataset, std::size_t count) {
  Markup html =
      pageHeader(title,
                 "front view at planning time; from above, forward is up: the route green, the 3.2 "
                 "s that were driven with a dot each 0.8 s") +
      pageSection("What was collected", tableOf(counts));
  for (const auto& [kind, indices] : samplesByKind(dataset, count)) {
    Markup figures = "\n";
    for (const std::size_t index : indices) figures += figureOf(dataset.sample(index));
    html += pageSection(kind, element("div", {{"class", "samples"}}, figures) + "\n");
  }
  return pageDocument(title + " – samples", {&kSampleSheetStyle}, html);
}

}  // namespace cdiff::page
