// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/realism_tables.h"

#include <nlohmann/json.hpp>

#include "core/markup.h"
#include "core/text.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "page/page_parts.h"
#include "realism/matched_realism.h"
#include "realism/pooled_realism.h"

namespace cdiff::realism {
namespace {

using nlohmann::ordered_json;

/// A table before it is Markdown or HTML. Cells of numbers stand right.
struct Sheet {
  std::string title;
  std::string note;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

std::string numberText(const std::optional<double>& value) {
  return value ? core::formatFixed(*value, 3) : "–";
}

void addLikelihoods(const Likelihoods& likelihoods, bool with_map,
                    std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < kFeatures; ++i) {
    if (with_map || !featureDefinitions()[i].of_map) cells.push_back(numberText(likelihoods[i]));
  }
}

void addTitles(bool with_map, std::vector<std::string>& head) {
  for (const FeatureDefinition& feature : featureDefinitions()) {
    if (with_map || !feature.of_map) {
      head.push_back("#" + std::string(feature.title) + " (" +
                     core::formatFixed(feature.weight, 2) + ")");
    }
  }
}

std::string markdownOf(const Sheet& sheet) {
  std::string text = "## " + core::markdownText(sheet.title) + "\n\n" + sheet.note + "\n\n|";
  for (const std::string& name : sheet.head)
    text += " " + core::markdownText(name[0] == '#' ? name.substr(1) : name) + " |";
  text += "\n|";
  for (const std::string& name : sheet.head) text += name[0] == '#' ? "---:|" : "---|";
  for (const std::vector<std::string>& row : sheet.rows) {
    text += "\n|";
    for (const std::string& cell : row) text += " " + core::markdownText(cell) + " |";
  }
  return text + "\n";
}

core::Markup sectionOf(const Sheet& sheet) {
  page::HtmlTable table(sheet.head);
  for (const std::vector<std::string>& row : sheet.rows) table.row({row.begin(), row.end()});
  return page::pageSection(sheet.title, page::pageNote(sheet.note) + table.html());
}

std::string pageOf(const std::string& title, const std::string& line,
                   const std::vector<Sheet>& sheets) {
  core::Markup html = page::pageHeader(title, line);
  for (const Sheet& sheet : sheets) html += sectionOf(sheet);
  return page::pageDocument(title, {}, html);
}

ordered_json jsonOf(const Likelihoods& likelihoods) {
  ordered_json text = ordered_json::object();
  for (std::size_t i = 0; i < kFeatures; ++i) {
    if (likelihoods[i]) text[featureDefinitions()[i].key] = *likelihoods[i];
  }
  return text;
}

ordered_json orNull(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

std::string matchedNote(const ContinuationOptions& options) {
  return "Meta-metric of Waymo's Sim Agents Challenge 2025 (its features, bins, weights and "
         "pseudo-counts). Evaluated objects: the CBVs of each session's first hand-over, " +
         core::formatNumber(options.seconds) + " s from there, " +
         std::to_string(options.rollouts) +
         " rollouts; log: the same hand-over driven by PDM-Lite with another driver. Not "
         "comparable "
         "with the challenge's leaderboard, whose logs are human. SUMO's driver has no noise of "
         "its "
         "own: one course counts as all rollouts. In brackets: weights.";
}

std::string metaText(const evaluation::Statistics& meta) {
  return numberText(meta.mean) + evaluation::intervalText(meta.interval, 3);
}

Sheet matchedSheet(const std::vector<MatchedRow>& rows, const ContinuationOptions& options) {
  Sheet sheet{"realism_matched", matchedNote(options), {"driver of the CBVs"}, {}};
  sheet.head.emplace_back("#realism_matched (95 % over scenarios)");
  sheet.head.emplace_back("#sessions");
  sheet.head.emplace_back("#without a CBV");
  sheet.head.emplace_back("#broken");
  addTitles(true, sheet.head);
  for (const MatchedRow& row : rows) {
    std::vector<std::string> cells = {row.driver + (row.ceiling ? " (ceiling)" : ""),
                                      metaText(row.meta), std::to_string(row.hand_overs),
                                      std::to_string(row.without), std::to_string(row.broken)};
    addLikelihoods(row.likelihoods, true, cells);
    sheet.rows.push_back(cells);
  }
  return sheet;
}

constexpr const char* kPooledNote =
    "Likelihood of recorded drivers under the histogram of simulated ones, all moving steps "
    "(> 1 m/s) pooled, both differentiated by the same filter. Not the challenge's metric: no "
    "common start; the map's features (distance to the road's edge 0.05, off-road 0.25, "
    "traffic-light violation 0.05) are left out and the other weights, 0.65 together, scaled to 1. "
    "In brackets: weights.";

Sheet pooledSheet(const PooledResult& result, const std::string& site) {
  Sheet sheet{"realism_pooled against " + site, kPooledNote, {"driver"}, {}};
  if (site == result.headline) sheet.title += " (headline)";
  for (const char* name : {"#realism_pooled", "#courses", "#steps", "#courses with a collision"})
    sheet.head.emplace_back(name);
  addTitles(false, sheet.head);
  for (const PooledRow& row : result.rows) {
    const Likelihoods& likelihoods = row.at_site.at(site);
    const bool ceiling = &row == &result.rows.back();
    const std::vector<Course>& recorded = result.sites.at(site).all;
    const std::size_t courses = ceiling ? recorded.size() : row.courses;
    const std::size_t steps = ceiling ? countValues(recorded, kLinearSpeed) : row.steps;
    const std::size_t collided = ceiling ? countCollided(recorded) : row.collided;
    std::vector<std::string> cells = {row.driver, numberText(metaMetric(likelihoods)),
                                      std::to_string(courses), std::to_string(steps),
                                      std::to_string(collided)};
    addLikelihoods(likelihoods, false, cells);
    sheet.rows.push_back(cells);
  }
  return sheet;
}

/// The headline's first.
std::vector<Sheet> pooledSheets(const PooledResult& result) {
  std::vector<Sheet> sheets = {pooledSheet(result, result.headline)};
  for (const auto& [site, recorded] : result.sites) {
    if (site != result.headline) sheets.push_back(pooledSheet(result, site));
  }
  return sheets;
}

ordered_json intervalJson(const std::optional<evaluation::Interval>& interval) {
  return interval ? ordered_json{interval->low, interval->high} : ordered_json();
}

}  // namespace

std::string matchedJson(const std::vector<MatchedRow>& rows, const ContinuationOptions& options) {
  ordered_json drivers = ordered_json::array();
  for (const MatchedRow& row : rows) {
    drivers.push_back({{"driver", row.driver},
                       {"ceiling", row.ceiling},
                       {"realism_matched", orNull(row.meta.mean)},
                       {"interval_95", intervalJson(row.meta.interval)},
                       {"scenarios", row.meta.n},
                       {"sessions", row.hand_overs},
                       {"sessions_without_cbv", row.without},
                       {"broken", row.broken},
                       {"likelihoods", jsonOf(row.likelihoods)}});
  }
  return ordered_json({{"schema_version", 1},
                       {"measure", "realism_matched"},
                       {"rollouts", options.rollouts},
                       {"seconds", options.seconds},
                       {"drivers", drivers}})
             .dump(2) +
         "\n";
}

std::string matchedMarkdown(const std::vector<MatchedRow>& rows,
                            const ContinuationOptions& options) {
  return markdownOf(matchedSheet(rows, options));
}

std::string matchedPage(const std::vector<MatchedRow>& rows, const ContinuationOptions& options) {
  return pageOf("Realism from the same hand-over", "cdiff realism matched",
                {matchedSheet(rows, options)});
}

std::string pooledJson(const PooledResult& result) {
  ordered_json drivers = ordered_json::array();
  for (const PooledRow& row : result.rows) {
    ordered_json sites = ordered_json::object();
    for (const auto& [site, likelihoods] : row.at_site) {
      sites[site] = {{"realism_pooled", orNull(metaMetric(likelihoods))},
                     {"likelihoods", jsonOf(likelihoods)}};
    }
    drivers.push_back({{"driver", row.driver},
                       {"courses", row.courses},
                       {"steps", row.steps},
                       {"courses_with_collision", row.collided},
                       {"sites", sites}});
  }
  return ordered_json({{"schema_version", 1},
                       {"measure", "realism_pooled"},
                       {"headline_site", result.headline},
                       {"drivers", drivers}})
             .dump(2) +
         "\n";
}

std::string pooledMarkdown(const PooledResult& result) {
  std::string text;
  for (const Sheet& sheet : pooledSheets(result))
    text += (text.empty() ? "" : "\n") + markdownOf(sheet);
  return text;
}

std::string pooledPage(const PooledResult& result) {
  return pageOf("Realism against recorded drivers", "cdiff realism pooled", pooledSheets(result));
}

}  // namespace cdiff::realism
