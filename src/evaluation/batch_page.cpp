// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <iterator>
#include <map>

#include "core/markup.h"
#include "core/text.h"
#include "evaluation/batch_report.h"
#include "metrics/known_figures.h"
#include "page/page_head.h"

namespace cdiff::evaluation {
namespace {

using core::escapeMarkup;

constexpr const char* kPageStyle = R"CSS(
.sheet { display: block; max-width: 100%; height: auto; border: 1px solid var(--line);
  border-radius: 8px; margin: 8px 0 18px; }
td .paper, td .rift { color: var(--soft); font-size: .86rem; display: block; }
)CSS";

std::string headOf(const std::string& name) {
  return page::pageHead(name + " – evaluation", std::string(page::kPanelSheetStyle) + kPageStyle);
}

using record::Outcome;

/// Outcomes of runs in the order of the page; what broke, was interrupted or did not run is an
/// error.
constexpr Outcome kOrder[] = {Outcome::kError, Outcome::kFailed, Outcome::kStruck,
                              Outcome::kNotJudged, Outcome::kPassed};

Outcome outcomeOf(const RunRecord& record) {
  return record.complete() ? record.verdict : Outcome::kError;
}

/// Place in kOrder.
std::ptrdiff_t rankOf(const RunRecord& record) {
  return std::find(std::begin(kOrder), std::end(kOrder), outcomeOf(record)) - std::begin(kOrder);
}

/// The first outcome in kOrder that a run has; passed without runs.
Outcome worstOf(const std::vector<BatchRun>& runs) {
  std::ptrdiff_t rank = std::size(kOrder) - 1;
  for (const BatchRun& run : runs) rank = std::min(rank, rankOf(run.record));
  return kOrder[rank];
}

const char* headlineOf(Outcome worst) {
  switch (worst) {
    case Outcome::kPassed:
      return "All runs passed";
    case Outcome::kStruck:
      return "No run failed, but egos were struck";
    case Outcome::kFailed:
      return "Verdicts failed";
    case Outcome::kNotJudged:
      return "No run failed, but not every run was judged";
    case Outcome::kError:
    case Outcome::kInterrupted:
      break;
  }
  return "Not every run could be judged";
}

std::string bannerOf(const std::string& name, const std::vector<BatchRun>& runs) {
  const Outcome worst = worstOf(runs);
  std::map<Outcome, std::size_t> counts;
  for (const BatchRun& run : runs) ++counts[outcomeOf(run.record)];
  const auto count = [&](Outcome outcome) { return std::to_string(counts[outcome]); };
  const std::string counts_text = count(Outcome::kPassed) + " passed, " + count(Outcome::kStruck) +
                                  " were struck, " + count(Outcome::kNotJudged) +
                                  " were not judged, " + count(Outcome::kFailed) +
                                  " ended with a failed verdict, " + count(Outcome::kError) +
                                  " broke, were interrupted or did not run";
  return "<header>\n<h1>" + escapeMarkup(name) + "</h1>\n<p class=\"sub\">evaluation of " +
         std::to_string(runs.size()) + " runs</p>\n" +
         page::pageBanner(worst, headlineOf(worst), "<p>" + counts_text + "</p>") + "</header>\n";
}

std::string figureText(const BatchRun& run, const std::string& name, int decimals) {
  const auto figure = run.record.figures.find(name);
  return figure == run.record.figures.end() ? "–" : core::formatFixed(figure->second, decimals);
}

std::string runRow(const BatchRun& run) {
  const RunRecord& record = run.record;
  const std::string link = "runs/" + record.id + "/report.html";
  const bool has_report = std::filesystem::exists(run.folder / "report.html");
  const std::string name =
      has_report ? "<a href=\"" + escapeMarkup(link) + "\">" + escapeMarkup(record.id) + "</a>"
                 : escapeMarkup(record.id);
  const std::string why = record.complete() ? core::joinText(record.reasons, "; ") : record.cause;
  std::string html = "<tr class=\"" + std::string(record::toText(outcomeOf(record))) + "\"><td>" +
                     name + "</td><td>" + record.status +
                     (record.complete() ? ", " + record::wordOf(record.verdict) : "") + "</td>";
  namespace figures = metrics::figures;
  const std::pair<const char*, int> shown[] = {
      {figures::kRouteCompletion.name, 1},  {figures::kDrivingScore.name, 1},
      {figures::kEgoCollisions.name, 0},    {figures::kCbvDecisions.name, 0},
      {figures::kCbvEgoCollisions.name, 0}, {figures::kCbvMinimumDistance.name, 1}};
  for (const auto& [key, decimals] : shown)
    html += "<td class=\"number\">" + figureText(run, key, decimals) + "</td>";
  return html + "<td>" + escapeMarkup(why) + "</td></tr>\n";
}

std::string runTable(const std::vector<BatchRun>& runs) {
  std::vector<const BatchRun*> order;
  for (const BatchRun& run : runs) order.push_back(&run);
  std::stable_sort(order.begin(), order.end(), [](const BatchRun* left, const BatchRun* right) {
    return rankOf(left->record) < rankOf(right->record);
  });
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th>run</th><th>status</th><th "
      "class=\"number\">route completion [%]</th><th class=\"number\">driving score</th><th "
      "class=\"number\">ego collisions</th><th class=\"number\">CBV decisions</th><th "
      "class=\"number\">CBV contacts with the ego</th><th class=\"number\">closest CBV [m]</th>"
      "<th>why</th></tr></thead><tbody>\n";
  for (const BatchRun* run : order) html += runRow(*run);
  return html + "</tbody></table></div>\n";
}

std::string tableCellHtml(const TableCell& cell) {
  const std::string rift = riftText(cell);
  const std::string paper = paperText(cell.paper);
  return "<td>" + escapeMarkup(cellText(cell)) +
         (rift.empty() ? "" : "<span class=\"rift\">RIFT: " + rift + "</span>") +
         (paper.empty() ? "" : "<span class=\"paper\">paper: " + paper + "</span>") + "</td>";
}

std::string paperTable(const Table& table) {
  const TableDefinition& definition = table.definition;
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th>" + escapeMarkup(definition.heading) + "</th>";
  for (const TableColumn& column : definition.columns) {
    html += "<th>" + escapeMarkup(column.name) +
            (column.unit.empty() ? "" : " [" + escapeMarkup(column.unit) + "]") + "</th>";
  }
  html += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < table.cells.size(); ++i) {
    html += "<tr><td>" + escapeMarkup(definition.rows[i].name) + "</td>";
    for (const TableCell& cell : table.cells[i]) html += tableCellHtml(cell);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n" +
         (definition.note.empty()
              ? ""
              : "<p class=\"note\">" + escapeMarkup(definition.note) + "</p>\n");
}

}  // namespace

std::string batchPage(const std::string& name, const std::vector<BatchRun>& runs,
                      const std::vector<Table>& tables, const std::vector<Figure>& figures) {
  std::string html = headOf(name) + "<body>\n<main>\n" + bannerOf(name, runs) +
                     page::pageSection("Runs", runTable(runs));
  for (const Table& table : tables)
    html += page::pageSection(table.definition.title, paperTable(table));
  for (const Figure& figure : figures) {
    html += page::pageSection(figure.sheet.title, page::sheetSvg(figure.sheet),
                              figure.wall_clock ? "wall-clock" : "");
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace cdiff::evaluation
