// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/bench2drive_table.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"
#include "evaluation/suite_selection.h"
#include "map/route_source.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using evaluation::RunRecord;
using nlohmann::json;

/// One line of the table.
struct Row {
  std::string status = "error";
  std::string completion = "-";
  std::string count = "0";
  int decisions = 0;
  int longest = 0;  ///< most decisions that a single CBV was driven
  int longest_at_junction =
      0;  ///< the same of CBVs whose conflict point lies at or beyond a junction
  std::string conflict = "-";
  std::string contacts = "-";
  std::string off_road = "-";
  std::string passed = "-";     ///< share of CBVs that passed their conflict point [%]
  std::string completed = "-";  ///< mean share of their routes that CBVs drove [%]
  std::string rejected;
};

/// A measure of the run with one decimal, "-" when it has none.
std::string valueText(const RunRecord& record, const std::string& name) {
  const auto found = record.measures.find(name);
  return found == record.measures.end() ? "-" : core::formatFixed(found->second, 1);
}

std::string rejections(const json& rejected) {
  std::vector<std::pair<int, std::string>> reasons;
  for (const auto& [reason, count] : rejected.items())
    reasons.emplace_back(-count.get<int>(), reason);
  std::sort(reasons.begin(), reasons.end());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, reasons.size()); ++i) {
    texts.push_back(reasons[i].second + " " + std::to_string(-reasons[i].first));
  }
  return core::joinText(texts, ", ");
}

void takeSummary(const json& summary, Row& row) {
  row.status = summary.at("status");
  row.completion = core::formatFixed(summary.at("ego").at("route_completion_percent"), 1);
  row.contacts = std::to_string(summary.at("ego").at("collisions").get<int>());
  const json& cbv = summary.at("cbv");
  row.count = std::to_string(cbv.at("count").get<int>());
  row.decisions = cbv.at("decisions");
  const json& off_road = cbv.at("off_road_rate_percent");
  if (off_road.is_number()) row.off_road = core::formatFixed(off_road, 2);
  row.rejected = rejections(cbv.at("rejected"));
  for (const json& selection : cbv.at("selections")) {
    const json& point = selection.at("conflict_point");
    const int driven = selection.at("decisions_driven");
    row.longest = std::max(row.longest, driven);
    if (point.at("in_junction_or_beyond").get<bool>()) {
      row.longest_at_junction = std::max(row.longest_at_junction, driven);
    }
    if (row.conflict == "-") {
      row.conflict =
          core::formatFixed(point.at("x"), 1) + ", " + core::formatFixed(point.at("y"), 1);
    }
  }
}

Row readRow(const RunRecord& record, const fs::path& results) {
  Row row;
  const fs::path file = evaluation::runFolder(results, record.id) / "summary.json";
  if (!fs::exists(file)) return row;
  row.passed = valueText(record, "cbv_passed_percent");
  row.completed = valueText(record, "cbv_completion_percent");
  try {
    takeSummary(core::readJson(file, "summary"), row);
  } catch (const json::exception& error) {
    throw core::InputError("'" + file.string() +
                           "' is no summary of a session: " + core::jsonFault(error) +
                           "; delete the record.json beside it to have the run repeated");
  }
  return row;
}

std::string tableLine(const std::string& route, const std::string& town, const Row& row) {
  return "| " +
         core::joinText({route, town, row.status, row.completion, row.contacts, row.count,
                         std::to_string(row.decisions), std::to_string(row.longest),
                         std::to_string(row.longest_at_junction), row.off_road, row.passed,
                         row.completed, row.conflict, row.rejected},
                        " | ") +
         " |\n";
}

constexpr int kDriven = 30;  // decisions of one CBV that count as driven

/// How many runs have what.
struct Totals {
  int errors = 0;
  int completed = 0;
  int driven = 0;
  int at_junction = 0;
  int without_cbv = 0;
  std::size_t runs = 0;

  void add(const Row& row) {
    errors += row.status == "error";
    completed += row.status == "completed";
    driven += row.longest >= kDriven;
    at_junction += row.longest_at_junction >= kDriven;
    without_cbv += row.status != "error" && row.count == "0";
    ++runs;
  }
  std::string text(const std::string& what) const {
    return std::to_string(runs) + " " + what + ": " + std::to_string(errors) + " errors, " +
           std::to_string(completed) + " completed; one CBV driven for at least " +
           std::to_string(kDriven) + " decisions on " + std::to_string(driven) +
           ", with a conflict point at or beyond a junction on " + std::to_string(at_junction) +
           "; without any CBV " + std::to_string(without_cbv) + "\n";
  }
};

}  // namespace

std::string routeTable(const std::vector<RunRecord>& records, const std::string& bench2drive,
                       const fs::path& results) {
  std::map<std::string, std::string> towns;
  for (const map::Bench2DriveEntry& entry : map::listBench2DriveRoutes(bench2drive))
    towns[entry.id] = entry.town;
  std::set<std::string> seeds;
  for (const RunRecord& record : records) seeds.insert(record.factors.at("seed"));
  std::string text =
      "| route | town | status | RC % | ego contacts | CBVs | decisions | longest | longest with "
      "conflict at or beyond a junction | off-road % | CBVs passed % | CBV route % | first "
      "conflict point (x, y) | most frequent rejections |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  const std::vector<std::string>& dev10 = evaluation::dev10Routes();
  Totals totals;
  Totals paper;  // of dev10 alone
  for (const RunRecord& record : records) {
    Row row = readRow(record, results);
    if (!record.complete()) row.status = record.status;
    const std::string& route = record.factors.at("scenario");
    const std::string seed = seeds.size() > 1 ? " (seed " + record.factors.at("seed") + ")" : "";
    totals.add(row);
    if (std::find(dev10.begin(), dev10.end(), route) != dev10.end()) paper.add(row);
    text += tableLine(route + seed, towns[route], row);
  }
  text += "\n" + totals.text("routes");
  if (paper.runs > 0) text += "of these " + paper.text("of the paper's dev10");
  return text;
}

}  // namespace cdiff::cli
