// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/training_pages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/csv.h"
#include "core/text.h"
#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/sample_order.h"
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

namespace {

constexpr std::size_t kColumns = 5;
constexpr const char* kHeader = "stage,step,seconds,figure,value";
constexpr const char* kHeldOut = "held_out_";
constexpr const char* kEpisode = "episode_";  // of trainings that drive
constexpr const char* kStyles[] = {"ego", "bg", "c0 cbv", "c1 cbv", "c3 cbv"};

/// Held-out measures end in what they measure.
struct TrainingQuantity {
  const char* ending;
  const char* title;
  const char* unit;
};
constexpr TrainingQuantity kQuantities[] = {
    {"ade_m", "Held out: mean displacement", "m"},
    {"fde_m", "Held out: last displacement", "m"},
    {"speed_mps", "Held out: speed", "m/s"},
    {"heading_rad", "Held out: heading", "rad"},
    {"throttle", "Held out: throttle", ""},
    {"steer", "Held out: steer", ""},
    {"brake", "Held out: brake", ""},
};

bool startsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

TrainingStage& stageNamed(std::vector<TrainingStage>& stages, const std::string& name) {
  for (TrainingStage& stage : stages) {
    if (stage.name == name) return stage;
  }
  stages.push_back({name, 0, 0.0, {}});
  return stages.back();
}

void addRow(const std::vector<std::string>& cells, std::vector<TrainingStage>& stages) {
  TrainingStage& stage = stageNamed(stages, cells[0]);
  stage.steps = std::stol(cells[1]);
  stage.seconds = std::stod(cells[2]);
  stage.curves[cells[3]].emplace_back(stage.seconds, std::stod(cells[4]));
}

Markup curveLegend(const std::vector<std::pair<std::string, std::string>>& items) {
  if (items.size() < 2) return {};
  Markup rows;
  for (const auto& [style, text] : items) rows += legendLine("series " + style, text);
  return element("div", {{"class", "legend"}}, rows) + "\n";
}

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  while (!name.empty() && name.back() == ' ') name.pop_back();
  return name.empty() ? "all" : name;
}

/// One chart of the named curves; empty where there are none.
Markup curveChart(const TrainingStage& stage, const std::string& title, const std::string& unit,
                  const std::vector<std::pair<std::string, std::string>>& named) {
  if (named.empty()) return {};
  Chart chart;
  chart.title = title;
  chart.unit = unit;
  chart.duration = stage.seconds;
  chart.least_top = 1e-6;
  chart.own_time = true;
  std::vector<std::pair<std::string, std::string>> items;
  for (const auto& [measure, text] : named) {
    const std::string style = kStyles[items.size() % std::size(kStyles)];
    chart.series.push_back({style, stage.curves.at(measure)});
    items.emplace_back(style, text);
  }
  return element("div", {}, chartSvg(chart) + curveLegend(items)) + "\n";
}

/// Measures of the stage that satisfy a test, with the words of their names that `shown` leaves.
template <class Matches, class Shown>
std::vector<std::pair<std::string, std::string>> measuresOf(const TrainingStage& stage,
                                                            Matches matches, Shown shown) {
  std::vector<std::pair<std::string, std::string>> named;
  for (const auto& [measure, curve] : stage.curves) {
    if (matches(measure)) named.emplace_back(measure, words(shown(measure)));
  }
  return named;
}

Markup heldOutCharts(const TrainingStage& stage) {
  Markup html;
  const std::size_t start = std::string(kHeldOut).size();
  for (const TrainingQuantity& quantity : kQuantities) {
    const std::string ending = quantity.ending;
    const auto matches = [&](const std::string& measure) {
      return startsWith(measure, kHeldOut) && core::endsWith(measure, ending);
    };
    const auto shown = [&](const std::string& measure) {
      return measure.substr(start, measure.size() - start - ending.size());
    };
    html += curveChart(stage, quantity.title, quantity.unit, measuresOf(stage, matches, shown));
  }
  return html;
}

Markup stageSection(const TrainingStage& stage) {
  const auto losses = [](const std::string& measure) { return startsWith(measure, "loss"); };
  const auto whole = [](const std::string& measure) { return measure; };
  const auto one = [&](const char* measure, const char* title, const char* unit) {
    return curveChart(stage, title, unit,
                      measuresOf(
                          stage, [&](const std::string& name) { return name == measure; }, whole));
  };
  const auto episodes = [&](const char* ending, const char* title) {
    const auto matches = [&](const std::string& measure) {
      const bool of_episodes = startsWith(measure, kEpisode) || startsWith(measure, kHeldOut);
      return of_episodes && core::endsWith(measure, ending);
    };
    return curveChart(stage, title, "", measuresOf(stage, matches, whole));
  };
  const Markup charts = episodes("_return", "Mean return of episodes") +
                        episodes("_share", "Share of episodes that end so") +
                        curveChart(stage, "Loss (running mean, and its terms at the time)", "",
                                   measuresOf(stage, losses, whole)) +
                        heldOutCharts(stage) + one("learning_rate", "Learning rate", "") +
                        one("gradient_norm", "Norm of the gradient before clipping", "") +
                        one("samples_per_second", "Pace", "samples/s") +
                        one("decisions_per_second", "Decisions collected and learned from", "1/s");
  const std::string note = std::to_string(stage.steps) + " steps in " +
                           core::formatFixed(stage.seconds, 0) +
                           " s; horizontally: seconds of training";
  return pageSection(words(stage.name),
                     pageNote(note) + element("div", {{"class", "charts"}}, "\n" + charts) + "\n");
}

}  // namespace

std::vector<TrainingStage> readTrainingCurves(const std::string& text, const std::string& source) {
  std::istringstream rows(text);
  std::string row;
  if (!std::getline(rows, row) || row != kHeader)
    throw core::InputError(source + ": line 1 is not '" + kHeader + "'");
  std::vector<TrainingStage> stages;
  for (int line = 2; std::getline(rows, row); ++line) {
    const std::vector<std::string> cells = core::csvCells(row);
    if (rows.eof()) break;  // without its line end
    try {
      if (cells.size() != kColumns) throw std::invalid_argument("columns");
      addRow(cells, stages);
    } catch (const std::logic_error&) {
      throw core::InputError(source + ": line " + std::to_string(line) + " is '" + row +
                             "', expected " + kHeader);
    }
  }
  if (stages.empty()) throw core::InputError(source + ": no measurement in it yet");
  return stages;
}

std::string trainingReport(const std::string& title, const std::vector<TrainingStage>& stages,
                           const std::string& card) {
  Markup html = pageHeader(
      title, "course of training; errors are of the averaged weights on held-out sessions");
  for (const TrainingStage& stage : stages) html += stageSection(stage);
  if (!card.empty()) html += pageSection("Model card", element("pre", {}, card) + "\n");
  return pageDocument(title + " – training", {}, html);
}

}  // namespace cdiff::page
