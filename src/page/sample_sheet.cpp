// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/sample_sheet.h"

#include <map>

#include "core/markup.h"
#include "core/text.h"
#include "diffusion/route_tokens.h"
#include "learning/samples/sample_order.h"
#include "page/page_head.h"
#include "record/logs/front_view_log.h"

namespace cdiff::page {
namespace {

constexpr double kAhead = 45.0;        // [m] shown
constexpr double kBehind = 5.0;        // [m] shown
constexpr double kAside = 20.0;        // [m] shown to each side
constexpr Eigen::Index kDotEvery = 8;  // rows: 0.8 s

constexpr const char* kPageStyle = R"CSS(
.samples { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: 14px; }
.sample { margin: 0; display: grid; grid-template-columns: 3fr 2fr; gap: 6px; align-items: start; }
.sample img { width: 100%; image-rendering: pixelated; border-radius: 4px; }
.sample svg { width: 100%; background: var(--ground); border: 1px solid var(--line);
  border-radius: 4px; }
.sample figcaption { grid-column: 1 / -1; color: var(--soft); font-size: .85rem; }
.sample path { fill: none; stroke-width: .5; }
.sample path.way { stroke: var(--goal); stroke-width: 1.6; opacity: .4; }
.sample path.driven { stroke: var(--c0); }
.sample circle { fill: var(--c0); }
.sample rect { fill: var(--text); opacity: .7; }
)CSS";

/// Body frame to the picture: forward is up, left is left.
std::string at(double x, double y) {
  return core::formatFixed(-y, 2) + " " + core::formatFixed(-x, 2);
}

std::string samplePath(const char* style, const std::vector<std::pair<double, double>>& points) {
  std::string data = "M0 0";
  for (const auto& [x, y] : points) data += "L" + at(x, y);
  return "<path class=\"" + std::string(style) + "\" d=\"" + data + "\"/>";
}

std::string sampleFromAbove(const learning::DrivingSample& sample) {
  std::vector<std::pair<double, double>> way;
  for (std::size_t i = 0; i + 1 < sample.route.size(); i += 2)
    way.emplace_back(diffusion::kRouteTokenScale * sample.route[i],
                     diffusion::kRouteTokenScale * sample.route[i + 1]);
  std::vector<std::pair<double, double>> driven;
  std::string dots;
  for (Eigen::Index t = 0; t < sample.rollout.rows(); ++t) {
    driven.emplace_back(sample.rollout(t, traffic::kRolloutX),
                        sample.rollout(t, traffic::kRolloutY));
    if ((t + 1) % kDotEvery != 0) continue;
    dots += "<circle r=\".7\" cx=\"" + core::formatFixed(-driven.back().second, 2) + "\" cy=\"" +
            core::formatFixed(-driven.back().first, 2) + "\"/>";
  }
  return "<svg role=\"img\" aria-label=\"from above\" viewBox=\"" + core::formatFixed(-kAside, 0) +
         " " + core::formatFixed(-kAhead, 0) + " " + core::formatFixed(2.0 * kAside, 0) + " " +
         core::formatFixed(kAhead + kBehind, 0) + "\">" + samplePath("way", way) +
         "<rect x=\"-1\" y=\"-2.2\" width=\"2\" height=\"4.4\"/>" + samplePath("driven", driven) +
         dots + "</svg>";
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

std::string figureOf(const learning::DrivingSample& sample) {
  return "<figure class=\"sample\"><img alt=\"front view\" src=\"" +
         record::pngDataUri(sample.image) + "\">" + sampleFromAbove(sample) + "<figcaption>" +
         core::escapeMarkup(captionOf(sample)) + "</figcaption></figure>\n";
}

std::string tableOf(const std::vector<CountRow>& counts) {
  std::string html = "<div class=\"scroll\"><table>\n";
  for (const CountRow& row : counts) {
    html += "<tr><td>" + core::escapeMarkup(row.name) + "</td><td>" +
            core::escapeMarkup(row.number) + "</td><td>" + core::escapeMarkup(row.share) +
            "</td></tr>\n";
  }
  return html + "</table></div>\n";
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
  std::string html =
      pageHead(title + " – samples", kPageStyle) + "<body>\n<main>\n<header>\n<h1>" +
      core::escapeMarkup(title) +
      "</h1>\n<p class=\"sub\">front view at planning time; from above, forward is up: the route "
      "green, the 3.2 s that were driven with a dot each 0.8 s</p>\n</header>\n<section>\n"
      "<h2>What was collected</h2>\n" +
      tableOf(counts) + "</section>\n";
  for (const auto& [kind, indices] : samplesByKind(dataset, count)) {
    html += "<section>\n<h2>" + core::escapeMarkup(kind) + "</h2>\n<div class=\"samples\">\n";
    for (const std::size_t index : indices) html += figureOf(dataset.sample(index));
    html += "</div>\n</section>\n";
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace cdiff::page
