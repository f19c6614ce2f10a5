// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/batch_files.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/csv.h"
#include "core/file.h"
#include "core/markup.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "evaluation/system_summary.h"
#include "metrics/known_measures.h"
#include "record/junit.h"
#include "record/summary.h"

namespace cdiff::evaluation {
namespace {

using Json = nlohmann::ordered_json;
using record::Outcome;

/// A measure of a cell by its name; absent ones are null.
Json statisticsJson(const Cell& cell, const std::string& name) {
  const auto measure = cell.measures.find(name);
  const Statistics statistics = measure == cell.measures.end() ? Statistics() : measure->second;
  Json interval = nullptr;
  if (statistics.interval)
    interval = Json::array({statistics.interval->low, statistics.interval->high});
  return {{"mean", record::number(statistics.mean)},
          {"standard_deviation", record::number(statistics.standard_deviation)},
          {"interval_95", interval},
          {"n", statistics.n}};
}

Json cellJson(const Cell& cell) {
  Json factors = Json::object();
  for (const std::string& factor : factorNames()) {
    if (cell.factors.count(factor) != 0) factors[factor] = cell.factors.at(factor);
  }
  Json measures = Json::object();
  for (const std::string& name : measureNames()) measures[name] = statisticsJson(cell, name);
  return {{"factors", factors},
          {"runs", cell.runs},
          {"failed", cell.failed},
          {"not_run", cell.missing},
          {"figures", measures}};
}

struct Counts {
  std::size_t failed = 0;
  std::size_t missing = 0;
  std::size_t passed = 0;
  std::size_t struck = 0;
  std::size_t not_judged = 0;
  std::size_t verdict_failed = 0;  ///< complete, but the verdict failed
};

Counts countOf(const std::vector<RunRecord>& records) {
  Counts counts;
  for (const RunRecord& record : records) {
    counts.failed += record.failed();
    counts.missing += !record.failed() && !record.complete();
    counts.passed += record.has(Outcome::kPassed);
    counts.struck += record.has(Outcome::kStruck);
    counts.not_judged += record.has(Outcome::kNotJudged);
    counts.verdict_failed += record.has(Outcome::kFailed);
  }
  return counts;
}

record::JunitCase caseOf(const RunRecord& record) {
  using Kind = record::JunitCase::Kind;
  const std::string reasons = core::joinText(record.reasons, "; ");
  record::JunitCase junit;
  junit.name = record.id;
  junit.seconds = record.wall_seconds;
  if (record.has(Outcome::kPassed)) return junit;
  if (record.has(Outcome::kStruck) || record.has(Outcome::kNotJudged)) {  // count as passed
    junit.message = record::wordOf(record.verdict) + ": " + reasons;
    return junit;
  }
  junit.kind = record.failed() ? Kind::kError : record.complete() ? Kind::kFailure : Kind::kSkipped;
  junit.message = record.failed() ? record.cause : record.complete() ? reasons : record.status;
  const bool by_rules = record.complete() && !record.decided_by.empty();
  junit.type = by_rules ? core::joinText(record.decided_by, ", ") : record.status;
  return junit;
}

/// "12.3 ± 0.4 (3)": mean, standard deviation and n.
std::string cellText(const Cell& cell, const std::string& name) {
  const auto found = cell.measures.find(name);
  if (found == cell.measures.end() || !found->second.mean) return "-";
  const Statistics& statistics = found->second;
  std::string text = core::formatFixed(*statistics.mean, 2);
  if (statistics.standard_deviation)
    text += " \xC2\xB1 " + core::formatFixed(*statistics.standard_deviation, 2);
  return text + " (" + std::to_string(statistics.n) + ")";
}

/// Factors with more than one level; the scenario in any case.
std::vector<std::string> shownFactors(const std::vector<Cell>& cells) {
  std::vector<std::string> shown;
  for (const std::string& factor : factorNames()) {
    std::set<std::string> levels;
    for (const Cell& cell : cells) {
      const auto level = cell.factors.find(factor);
      if (level != cell.factors.end()) levels.insert(level->second);
    }
    if (levels.size() > 1 || factor == "scenario") shown.push_back(factor);
  }
  return shown;
}

std::string rowText(const std::vector<std::string>& fields) {
  return "| " + core::joinText(fields, " | ") + " |\n";
}

const std::vector<std::string>& tableMeasures() {
  namespace known = metrics::known;
  static const std::vector<std::string> names = {
      known::kRouteCompletion.name, known::kDrivingScore.name,  known::kEgoCollisions.name,
      known::kCbvDecisions.name,    known::kCbvOffRoad.name,    known::kCbvEgoCollisions.name,
      "cbv_passed_percent",         known::kCbvSpeedError.name, known::kCbvClosestDistance.name,
      known::kTtcMean.name};
  return names;
}

std::string cellsTable(const std::vector<Cell>& cells) {
  const std::vector<std::string> shown = shownFactors(cells);
  std::vector<std::string> head = shown;
  head.insert(head.end(), {"runs", "broken", "not run"});
  head.insert(head.end(), tableMeasures().begin(), tableMeasures().end());
  std::string text = rowText(head) + rowText(std::vector<std::string>(head.size(), "---"));
  for (const Cell& cell : cells) {
    std::vector<std::string> fields;
    for (const std::string& factor : shown) {
      const std::string& level = cell.factors.at(factor);
      fields.push_back(level.empty() ? "-" : core::markdownText(level));
    }
    for (const std::size_t count : {cell.runs, cell.failed, cell.missing})
      fields.push_back(std::to_string(count));
    for (const std::string& name : tableMeasures()) fields.push_back(cellText(cell, name));
    text += rowText(fields);
  }
  return text;
}

/// Runs in which no CBV was driven say nothing about CBVs: how many, and scenarios that have no
/// other run.
std::string withoutCbvText(const std::vector<RunRecord>& records) {
  std::map<std::string, bool> driven;  // by scenario: in any run
  std::size_t complete = 0;
  std::size_t without = 0;
  for (const RunRecord& record : records) {
    const auto count = record.measures.find(metrics::known::kCbvCount.name);
    if (!record.complete() || count == record.measures.end()) continue;
    ++complete;
    without += count->second == 0.0;
    bool& any = driven[record.factors.at("scenario")];
    any = any || count->second > 0.0;
  }
  std::vector<std::string> never;
  for (const auto& [scenario, any] : driven) {
    if (!any) never.push_back(core::markdownText(scenario));
  }
  return "Without a CBV: " + std::to_string(without) + " of " + std::to_string(complete) +
         " complete runs; no run with one on " + std::to_string(never.size()) + " of " +
         std::to_string(driven.size()) + " scenarios" +
         (never.empty() ? "" : " (" + core::joinText(never, ", ") + ")") + ".\n";
}

}  // namespace

std::string runsCsv(const std::vector<RunRecord>& records) {
  std::vector<std::string> head = {"id"};
  head.insert(head.end(), factorNames().begin(), factorNames().end());
  head.insert(head.end(), {"status", "verdict", "exit_code", "attempts", "wall_seconds"});
  head.insert(head.end(), measureNames().begin(), measureNames().end());
  head.emplace_back("cause");
  std::string text = core::joinText(head, ",") + "\n";
  for (const RunRecord& record : records) {
    const bool started = record.attempts > 0;
    text += core::csvCell(record.id);
    for (const std::string& factor : factorNames())
      text += "," + core::csvCell(record.factors.at(factor));
    text += "," + core::csvCell(record.status) + "," +
            (record.complete() ? record::toText(record.verdict) : "") + "," +
            (started ? std::to_string(record.exit_code) : "") + "," +
            std::to_string(record.attempts) + "," +
            (started ? core::formatFixed(record.wall_seconds, 3) : "");
    for (const std::string& name : measureNames()) {
      const auto measure = record.measures.find(name);
      text += "," + (measure == record.measures.end() ? "" : core::formatNumber(measure->second));
    }
    text += "," + core::csvCell(record.cause) + "\n";
  }
  return text;
}

std::string batchSummaryJson(const std::string& name, const std::vector<RunRecord>& records) {
  const Counts counts = countOf(records);
  Json summary = {{"schema_version", 1},
                  {"evaluation", name},
                  {"runs", records.size()},
                  {"failed", counts.failed},
                  {"not_run", counts.missing},
                  {"verdict_passed", counts.passed},
                  {"verdict_struck", counts.struck},
                  {"verdict_failed", counts.verdict_failed},
                  {"verdict_not_judged", counts.not_judged},
                  {"systems", systemsJson(systemsOf(records))},
                  {"cells", Json::array()}};
  for (const Cell& cell : cellsOf(records)) summary["cells"].push_back(cellJson(cell));
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string batchJunitXml(const std::string& name, const std::vector<RunRecord>& records) {
  record::JunitSuite suite{name};
  for (const RunRecord& record : records) {
    suite.seconds += record.wall_seconds;
    suite.cases.push_back(caseOf(record));
  }
  return record::junitText(suite);
}

std::string batchMarkdown(const std::string& name, const std::vector<RunRecord>& records) {
  const Counts counts = countOf(records);
  return "# " + core::markdownText(name) + "\n\n" + std::to_string(records.size()) +
         " runs: " + std::to_string(counts.failed) + " broken, " + std::to_string(counts.missing) +
         " not run or interrupted, " + std::to_string(counts.verdict_failed) +
         " ended with a failed verdict, " + std::to_string(counts.struck) + " were struck, " +
         std::to_string(counts.not_judged) + " were not judged, " + std::to_string(counts.passed) +
         " passed.\n\n" + systemsMarkdown(systemsOf(records)) +
         "\n## Routes\n\nMean \xC2\xB1 standard deviation over seeds (number of seeds that have "
         "the measure); shares are of all samples together.\n\n" +
         cellsTable(cellsOf(records)) + "\n" + withoutCbvText(records);
}

void writeBatchFiles(const std::filesystem::path& results, const std::string& name,
                     const std::vector<RunRecord>& records) {
  core::writeOwnFile(results / "runs.csv", runsCsv(records));
  core::writeOwnFile(results / "summary.json", batchSummaryJson(name, records));
  core::writeOwnFile(results / "junit.xml", batchJunitXml(name, records));
  core::writeOwnFile(results / "summary.md", batchMarkdown(name, records));
}

}  // namespace cdiff::evaluation
