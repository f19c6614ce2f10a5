// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The rankings of egos as files and text.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/csv.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/batch_report.h"
#include "evaluation/separation/ego_ranking.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "page/pictures/panel_sheet.h"

namespace cdiff::evaluation {
namespace {

using core::element;
using core::Markup;

std::string fixedText(double value, int decimals) { return core::formatFixed(value, decimals); }

/// "12 / 3.4 km = 3.53 [1.82, 6.17]"; "5, no distance" of an ego that stood.
std::string rateText(const EgoFigures& ego) {
  if (ego.kilometers <= 0.0) return std::to_string(ego.contacts) + ", no distance";
  return std::to_string(ego.contacts) + " / " + fixedText(ego.kilometers, 2) +
         " km = " + fixedText(ego.per_km, 2) + " [" + fixedText(ego.per_km_interval.low, 2) + ", " +
         fixedText(ego.per_km_interval.high, 2) + "]";
}

std::string percentText(std::size_t count, std::size_t all) {
  if (all == 0) return "–";
  return fixedText(100.0 * static_cast<double>(count) / static_cast<double>(all), 0);
}

std::size_t countOf(const EgoFigures& ego, ContactKind kind) {
  const auto found = ego.kinds.find(kind);
  return found == ego.kinds.end() ? 0 : found->second;
}

/// What the order of the egos is worth, a sentence each.
std::vector<std::string> orderSentences(const EgoRanking& ranking) {
  std::vector<std::string> sentences;
  if (ranking.separation) {
    std::string text = std::string(kReferenceFamily.back()) + " minus " + kReferenceFamily.front() +
                       ": " + fixedText(*ranking.separation, 2) + " contacts per km";
    if (const auto& interval = ranking.separation_interval) {
      text += " [" + fixedText(interval->low, 2) + ", " + fixedText(interval->high, 2) + "]";
    }
    sentences.push_back(text + "; a session of the former has more contacts with probability " +
                        fixedText(*ranking.area_under_curve, 2));
  }
  if (ranking.odd_even) {
    sentences.push_back(
        "rank correlation of odd and even seeds: " + fixedText(*ranking.odd_even, 2) + " over " +
        std::to_string(ranking.egos.size()) + " egos");
  }
  sentences.insert(sentences.end(), ranking.remarks.begin(), ranking.remarks.end());
  return sentences;
}

/// Contacts per km of each ego, with its interval.
page::Panel barsOf(const EgoRanking& ranking) {
  double top = 1.0;
  for (const EgoFigures& ego : ranking.egos) top = std::max(top, ego.per_km_interval.high);
  const page::ChartAxes axes(0.0, static_cast<double>(ranking.egos.size()), 0.0, top);
  page::Panel panel;
  panel.title = "Contacts of the ego per km";
  panel.height = page::kChartHeight + 14.0;
  panel.content = axes.valueGrid() + "\n";
  for (std::size_t i = 0; i < ranking.egos.size(); ++i) {
    const EgoFigures& ego = ranking.egos[i];
    const auto left = static_cast<double>(i);
    const std::string bar = "M" + page::svgPlace(axes.x(left + 0.2), axes.y(0.0)) + "V" +
                            core::shortNumber(axes.y(ego.per_km)) + "H" +
                            core::shortNumber(axes.x(left + 0.8)) + "V" +
                            core::shortNumber(axes.y(0.0)) + "Z";
    const std::string error = "M" +
                              page::svgPlace(axes.x(left + 0.5), axes.y(ego.per_km_interval.low)) +
                              "V" + core::shortNumber(axes.y(ego.per_km_interval.high));
    panel.content += element("path", {{"class", "bar s0"}, {"d", bar}}) +
                     element("path", {{"class", "error"}, {"d", error}}) +
                     page::chartText("tick middle", axes.x(left + 0.5), page::kChartHeight - 9.0,
                                     std::to_string(i + 1)) +
                     "\n";
  }
  return panel;
}

page::PanelSheet sheetOf(const EgoRanking& ranking) {
  page::PanelSheet sheet;
  sheet.title = "Fewest contacts first";
  sheet.rows.push_back({barsOf(ranking)});
  for (std::size_t i = 0; i < ranking.egos.size(); ++i)
    sheet.notes.push_back(std::to_string(i + 1) + ". " + ranking.egos[i].ego + ": " +
                          rateText(ranking.egos[i]));
  return sheet;
}

Markup figureTable(const EgoRanking& ranking) {
  page::HtmlTable table({"Ego", "#Runs", "Contacts per km", "#Per minute", "#On a standing ego [%]",
                         "#From behind [%]", "#By one below 1 m/s [%]", "#Near misses per km",
                         "#Attacks withdrawn [% of decisions]", "#Stands [% of time]",
                         "#Route completion [%]", "#Driving score"});
  for (const EgoFigures& ego : ranking.egos) {
    const double near =
        ego.kilometers > 0.0 ? static_cast<double>(ego.near_misses) / ego.kilometers : 0.0;
    table.row({ego.ego, std::to_string(ego.runs), rateText(ego), fixedText(ego.per_minute, 2),
               percentText(ego.standing, ego.contacts),
               percentText(countOf(ego, ContactKind::kFromBehind), ego.contacts),
               percentText(ego.slow, ego.contacts), fixedText(near, 2),
               ego.withdrawn_percent ? fixedText(*ego.withdrawn_percent, 1) : "–",
               fixedText(ego.standing_percent, 1), fixedText(ego.completion_percent, 1),
               fixedText(ego.driving_score, 1)});
  }
  return table.html();
}

/// How often, with a link to the fastest impact, two seconds before it.
Markup failureCell(const EgoFigures& ego, ContactKind kind) {
  const std::size_t count = countOf(ego, kind);
  if (count == 0) return "0";
  const double start = std::max(0.0, ego.worst_seconds.at(kind) - 2.0);
  const std::string address = ego.worst.at(kind)->report + "#t=" + fixedText(start, 1);
  return std::to_string(count) + " " +
         element("a", {{"href", address}},
                 "worst: " + fixedText(ego.worst_speed.at(kind), 1) + " m/s");
}

Markup failureTable(const EgoRanking& ranking) {
  std::vector<std::string> head = {"Ego"};
  for (const ContactKind kind : kContactKinds) head.emplace_back(toText(kind));
  page::HtmlTable table(head);
  for (const EgoFigures& ego : ranking.egos) {
    std::vector<Markup> cells = {ego.ego};
    for (const ContactKind kind : kContactKinds) cells.push_back(failureCell(ego, kind));
    table.row(cells);
  }
  return table.html();
}

std::string shareOf(std::size_t count, std::size_t all) {
  const Interval interval = binomialInterval(count, all);
  return std::to_string(count) + " of " + std::to_string(all) + " = " + percentText(count, all) +
         " % [" + fixedText(100.0 * interval.low, 0) + ", " + fixedText(100.0 * interval.high, 0) +
         "]";
}

/// What other drivers would have avoided; nothing where nobody asked.
Markup avoidedTable(const EgoRanking& ranking) {
  page::HtmlTable table({"Ego", "Driver that takes over", "Others answer to it",
                         "Others as recorded", "... also half a second earlier and later"});
  bool any = false;
  for (const EgoFigures& ego : ranking.egos) {
    for (const auto& [driver, share] : ego.avoided) {
      any = true;
      std::vector<Markup> cells = {ego.ego, driver};
      for (const std::size_t count : share.avoided) cells.emplace_back(shareOf(count, share.asked));
      table.row(cells);
    }
  }
  return any ? table.html() : page::pageNote("Nobody asked: cdiff what_if FOLDER --all.");
}

Markup settingSection(const EgoRanking& ranking) {
  Markup sentences;
  for (const std::string& sentence : orderSentences(ranking))
    sentences += element("li", {}, sentence) + "\n";
  const Markup html =
      page::sheetSvg(sheetOf(ranking)) + element("ul", {}, "\n" + sentences) +
      figureTable(ranking) + element("h3", {}, "What each ego fails at") + failureTable(ranking) +
      element("h3", {}, "What other drivers would have avoided") + avoidedTable(ranking);
  return page::pageSection(ranking.setting, html);
}

}  // namespace

std::string writeEgoRanking(const std::vector<std::filesystem::path>& folders,
                            const std::string& name) {
  const std::filesystem::path base = std::filesystem::absolute(folders.front());
  std::vector<EgoRun> runs;
  std::set<std::filesystem::path> given;
  for (const std::filesystem::path& folder : folders) {
    if (!given.insert(std::filesystem::weakly_canonical(folder)).second)
      throw core::InputError("'" + folder.string() +
                             "' is there twice; its runs would count twice");
    for (EgoRun& run : readEgoRuns(std::filesystem::absolute(folder), base))
      runs.push_back(std::move(run));
  }
  const std::vector<EgoRanking> rankings = rankEgos(runs);
  core::OutputFolder output(base);
  output.write("ego_ranking.csv", rankingCsv(rankings));
  output.write("ego_ranking.html", rankingPage(name, rankings));
  return rankingMarkdown(rankings);
}

std::string rankingPage(const std::string& name, const std::vector<EgoRanking>& rankings) {
  Markup html = page::pageHeader(
      "Ego ranking", name,
      page::pageNote(
          "Contacts of the ego with anyone, over the km that it drove; brackets are 95 % "
          "intervals: exact Poisson, from five routes on wider where routes "
          "differ. Kinds of contact and "
          "worst cases: the fastest impact of each kind."));
  for (const EgoRanking& ranking : rankings) html += settingSection(ranking);
  return page::pageDocument("Ego ranking – " + name, {&page::kPanelSheetStyle, &kBatchPageStyle},
                            html);
}

namespace {

std::vector<std::string> csvCells(const std::string& setting, std::size_t rank,
                                  const EgoFigures& ego) {
  std::vector<std::string> cells = {setting, std::to_string(rank), ego.ego,
                                    std::to_string(ego.runs)};
  for (const double value : {ego.kilometers, ego.minutes}) cells.push_back(fixedText(value, 3));
  cells.push_back(std::to_string(ego.contacts));
  for (const double value : {ego.per_km, ego.per_km_interval.low, ego.per_km_interval.high})
    cells.push_back(ego.kilometers > 0.0 ? fixedText(value, 3) : "");
  for (const double value :
       {ego.per_minute, ego.per_minute_interval.low, ego.per_minute_interval.high})
    cells.push_back(fixedText(value, 3));
  for (const ContactKind kind : kContactKinds) cells.push_back(std::to_string(countOf(ego, kind)));
  for (const std::size_t count : {ego.standing, ego.slow, ego.near_misses})
    cells.push_back(std::to_string(count));
  cells.push_back(ego.withdrawn_percent ? fixedText(*ego.withdrawn_percent, 2) : "");
  for (const double value : {ego.standing_percent, ego.completion_percent, ego.driving_score})
    cells.push_back(fixedText(value, 2));
  return cells;
}

}  // namespace

std::string rankingCsv(const std::vector<EgoRanking>& rankings) {
  std::vector<std::string> head = {
      "setting",        "rank",   "ego",        "runs",        "km",         "minutes",
      "contacts",       "per_km", "per_km_low", "per_km_high", "per_minute", "per_minute_low",
      "per_minute_high"};
  for (const ContactKind kind : kContactKinds) head.emplace_back(toText(kind));
  for (const char* name : {"standing_ego", "slow_partner", "near_misses", "withdrawn_percent",
                           "standing_percent", "completion_percent", "driving_score"})
    head.emplace_back(name);
  std::string csv = core::csvRow(head);
  for (const EgoRanking& ranking : rankings) {
    for (std::size_t i = 0; i < ranking.egos.size(); ++i)
      csv += core::csvRow(csvCells(ranking.setting, i + 1, ranking.egos[i]));
  }
  return csv;
}

std::string rankingMarkdown(const std::vector<EgoRanking>& rankings) {
  std::string text;
  for (const EgoRanking& ranking : rankings) {
    text += "## " + core::markdownText(ranking.setting) +
            "\n\n| Ego | Contacts per km | per minute | completion % | from behind | standing ego "
            "|\n|---|---|---|---|---|---|\n";
    for (const EgoFigures& ego : ranking.egos) {
      text += "| " + core::markdownText(ego.ego) + " | " + rateText(ego) + " | " +
              fixedText(ego.per_minute, 2) + " | " + fixedText(ego.completion_percent, 1) + " | " +
              std::to_string(countOf(ego, ContactKind::kFromBehind)) + " | " +
              std::to_string(ego.standing) + " |\n";
    }
    text += "\n";
    for (const std::string& sentence : orderSentences(ranking)) text += "- " + sentence + "\n";
    text += "\n";
  }
  return text;
}

}  // namespace cdiff::evaluation
