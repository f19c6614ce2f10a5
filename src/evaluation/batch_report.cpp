// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/batch_report.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/contact_counts.h"
#include "evaluation/heat_map.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/ranking.h"
#include "evaluation/system_names.h"
#include "evaluation/system_summary.h"
#include "evaluation/trail_figure.h"
#include "evaluation/trail_scene.h"
#include "evaluation/worst_moments.h"
#include "metrics/known_measures.h"
#include "page/page_parts.h"

namespace cdiff::evaluation {

namespace {

using core::element;
using core::Markup;
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

/// How many runs ended in which way, then what the batch left out.
Markup countsOf(const std::vector<BatchRun>& runs, const std::string& skipped) {
  std::map<Outcome, std::size_t> counts;
  for (const BatchRun& run : runs) ++counts[outcomeOf(run.record)];
  const auto count = [&](Outcome outcome) { return std::to_string(counts[outcome]); };
  const std::string text = count(Outcome::kPassed) + " passed, " + count(Outcome::kStruck) +
                           " were struck, " + count(Outcome::kNotJudged) + " were not judged, " +
                           count(Outcome::kFailed) + " ended with a failed verdict, " +
                           count(Outcome::kError) + " broke, were interrupted or did not run";
  Markup html = element("p", {}, text);
  for (const std::string& line : core::splitText(skipped, '\n'))
    html += element("p", {}, "Left out: " + line);
  return html;
}

/// Which system is the hardest and, right below it, how little the batch says about that.
Markup answerOf(const Ranking& ranking, const SystemNames& names) {
  const RankingText text = rankingText(ranking, names);
  Markup answer = element("p", {}, text.sentences.front());
  for (const std::string& warning : fewWarnings(ranking.systems))
    answer += element("p", {{"class", "few"}}, warning);
  for (std::size_t i = 1; i < text.sentences.size(); ++i)
    answer += element("p", {}, text.sentences[i]);
  Markup items;
  for (const std::string& other : text.folded) items += element("li", {}, other) + "\n";
  if (!items.empty())
    answer += page::pageFold(countText(text.folded.size(), "other") + ", in this order",
                             element("ol", {{"start", "2"}}, "\n" + items));
  return element("div", {{"class", "answer"}}, answer);
}

/// The answer, then how the runs ended.
Markup headerOf(const std::string& name, const std::vector<BatchRun>& runs, const Ranking& ranking,
                const SystemNames& names, const std::string& skipped) {
  const Outcome worst = worstOf(runs);
  return page::pageHeader(name, "evaluation of " + std::to_string(runs.size()) + " runs",
                          answerOf(ranking, names) + "\n" +
                              page::pageBanner(worst, headlineOf(worst), countsOf(runs, skipped)));
}

/// Where a run's report opens; its folder's name alone where it has none.
Markup reportLink(const BatchRun& run, const Markup& text, const std::string& moment = "") {
  if (!std::filesystem::exists(run.folder / "report.html")) return text;
  return element(
      "a", {{"href", "runs/" + run.record.id + "/report.html" + moment}, {"title", run.record.id}},
      text);
}

Markup momentsHtml(const std::vector<BatchRun>& runs, const SystemNames& names) {
  Markup items;
  for (const WorstMoment& moment : worstMoments(runs)) {
    const BatchRun& run = runs[moment.run];
    const Factors& factors = run.record.factors;
    const std::string seconds = moment.seconds ? core::formatFixed(*moment.seconds, 2) : "";
    const std::string where = factors.at("scenario") + ", seed " + factors.at("seed") +
                              (moment.seconds ? " at " + seconds + " s" : "");
    items += element("li", {},
                     reportLink(run, where, moment.seconds ? "#t=" + seconds : "") + ", " +
                         names.of(factors) + ": " + moment.text) +
             "\n";
  }
  return items.empty()
             ? page::pageNote("No contact, and no CBV near the ego.")
             : page::pageNote(
                   "Contacts of a moving ego first, those at its fault before others, then by "
                   "the faster vehicle's speed.") +
                   element("ol", {{"class", "worst"}}, "\n" + items) + "\n";
}

/// Those without a complete run come last.
std::vector<System> inOrderOf(const Ranking& ranking, const std::vector<System>& systems) {
  std::vector<System> ordered = ranking.systems;
  std::copy_if(systems.begin(), systems.end(), std::back_inserter(ordered),
               [](const System& system) { return system.routes == 0; });
  return ordered;
}

std::string valueText(const BatchRun& run, const std::string& name, int decimals) {
  const auto found = run.record.measures.find(name);
  return found == run.record.measures.end() ? "–" : core::formatFixed(found->second, decimals);
}

/// A measure of each run that the page shows.
struct ShownMeasure {
  const metrics::MeasureDefinition* measure;
  const char* heading;
  int decimals;
};

/// A count of contacts of each run that the page shows.
struct ShownCount {
  double (*count)(const ContactCounts&);
  const char* heading;
};

constexpr ShownCount kShownCounts[] = {
    {[](const ContactCounts& counts) { return counts.all; }, "Contacts"},
    {[](const ContactCounts& counts) { return counts.with_cbvs; }, "With CBVs"},
    {[](const ContactCounts& counts) { return counts.withBackground(); }, "With background"},
    {[](const ContactCounts& counts) { return counts.standing; }, "Ego standing"}};

const std::vector<ShownMeasure>& shownMeasures() {
  namespace known = metrics::known;
  static const std::vector<ShownMeasure> measures = {
      {&known::kContactsAtFault, "At fault", 0},
      {&known::kDrivingScore, "Score", 1},
      {&known::kRouteCompletion, "Completion [%]", 1},
      {&known::kCbvMinimumDistance, "Nearest CBV, between centers [m]", 1}};
  return measures;
}

/// "timed_out" is "timed out".
std::string plainWords(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

/// A reason folds to its first words.
Markup foldedReason(const std::string& text) {
  constexpr std::size_t kShown = 48;
  if (text.size() <= kShown) return text;
  return page::pageFold(core::cutText(text, kShown), element("p", {}, text), "reason");
}

void addRow(const BatchRun& run, const SystemNames& names, page::HtmlTable& table) {
  const RunRecord& record = run.record;
  const std::string& repetition = record.factors.at("repetition");
  const std::string status =
      record.complete() ? record::wordOf(record.verdict) : plainWords(record.status);
  std::vector<Markup> cells = {
      reportLink(run, record.factors.at("scenario")), names.of(record.factors),
      record.factors.at("seed") + (repetition == "1" ? "" : ", repetition " + repetition), status};
  const ContactCounts counts = contactCountsOf(record);
  for (const ShownCount& shown : kShownCounts)
    cells.emplace_back(record.complete() ? core::formatFixed(shown.count(counts), 0) : "–");
  for (const ShownMeasure& shown : shownMeasures())
    cells.emplace_back(valueText(run, shown.measure->name, shown.decimals));
  std::vector<std::string> reasons = record.reasons;
  if (record.complete()) reasons.insert(reasons.begin(), plainWords(record.status));
  cells.push_back(foldedReason(record.complete() ? core::joinText(reasons, "; ") : record.cause));
  table.row(cells, record::toText(outcomeOf(record)));
}

/// The script makes it work; without one all rows stay.
Markup filterRow() {
  return element("p", {{"class", "filter"}, core::flag("hidden")},
                 element("label", {},
                         "Show runs with " + element("input", {{"type", "search"},
                                                               {"id", "filter"},
                                                               {"placeholder", "any words"}})) +
                     " " + element("output", {{"id", "shown"}}) + " A click on a heading sorts.") +
         "\n";
}

Markup runTable(const std::vector<BatchRun>& runs, const SystemNames& names) {
  std::vector<const BatchRun*> order;
  for (const BatchRun& run : runs) order.push_back(&run);
  std::stable_sort(order.begin(), order.end(), [](const BatchRun* left, const BatchRun* right) {
    return rankOf(left->record) < rankOf(right->record);
  });
  std::vector<std::string> head = {"Scenario", "Planner", "Seed", "Outcome"};
  for (const ShownCount& shown : kShownCounts) head.push_back("#" + std::string(shown.heading));
  for (const ShownMeasure& shown : shownMeasures())
    head.push_back("#" + std::string(shown.heading));
  head.emplace_back("Why");
  page::HtmlTable table(head);
  for (const BatchRun* run : order) addRow(*run, names, table);
  return filterRow() + table.html();
}

Markup shownCell(const TableCell& cell, bool with_interval) {
  const std::string rift = riftText(cell, with_interval);
  const std::string paper = paperText(cell.paper);
  Markup html = cellText(cell, with_interval);
  if (!rift.empty()) html += element("span", {{"class", "by_rift"}}, "RIFT: " + rift);
  if (!paper.empty()) html += element("span", {{"class", "paper"}}, "paper: " + paper);
  const std::string repository = paperText(cell.repository);
  if (!repository.empty())
    html += element("span", {{"class", "paper"}}, "RIFT's repository: " + repository);
  return html;
}

Markup paperTable(const Table& table) {
  const TableDefinition& definition = table.definition;
  std::vector<std::string> head = {definition.heading};
  for (const TableColumn& column : definition.columns)
    head.push_back(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
  page::HtmlTable rows(head);
  for (std::size_t i = 0; i < table.cells.size(); ++i) {
    std::vector<Markup> cells = {definition.rows[i].name};
    const bool intervals = showsIntervals(table.cells[i]);
    for (const TableCell& cell : table.cells[i]) cells.push_back(shownCell(cell, intervals));
    rows.row(cells);
  }
  Markup html = rows.html();
  if (anyRowWithout(table)) html += page::pageNote(intervalRule());
  if (!definition.note.empty()) html += page::pageNote(definition.note);
  for (const std::string& footnote : definition.footnotes) html += page::pageNote(footnote);
  for (const std::string& line : settingsLines(table)) html += page::pageNote(line);
  return html;
}

}  // namespace

std::string batchPage(const std::string& name, const std::vector<BatchRun>& runs,
                      const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const std::string& skipped) {
  std::vector<RunRecord> records;
  for (const BatchRun& run : runs) records.push_back(run.record);
  const std::vector<System> systems = systemsOf(records);
  const SystemNames names(systems);
  const Ranking ranking = rankingOf(systems, records, names);
  Markup html = headerOf(name, runs, ranking, names, skipped) +
                page::pageSection("Scenario by planner", heatMap(records, ranking, names)) +
                page::pageSection("Worst moments", momentsHtml(runs, names)) +
                page::pageSection("Planners", systemsHtml(inOrderOf(ranking, systems))) +
                page::pageSection("Runs", runTable(runs, names));
  for (const Table& table : tables)
    html += page::pageSection(table.definition.title, paperTable(table));
  for (const Figure& figure : figures) {
    html += page::pageSection(figure.sheet.title, page::sheetSvg(figure.sheet),
                              figure.wall_clock ? "wall-clock" : "");
  }
  html += page::pageNote(
      "Files of the batch: runs.csv, summary.json, summary.md, junit.xml, tables/, figures/.");
  return page::pageDocument(name + " – evaluation", {&page::kPanelSheetStyle, &kBatchPageStyle},
                            html, core::scriptElement(kBatchPageScript));
}

namespace {

namespace fs = std::filesystem;

std::vector<BatchRun> ofVariant(const std::string& variant, const std::vector<BatchRun>& runs) {
  std::vector<BatchRun> kept;
  for (const BatchRun& run : runs) {
    if (run.record.factors.at("variant") == variant) kept.push_back(run);
  }
  return kept;
}

TableDefinition withVariant(const std::string& variant, TableDefinition table) {
  for (TableRow& row : table.rows) row.levels.emplace("variant", variant);
  return table;
}

std::string row(const std::vector<std::string>& cells) {
  return "| " + core::joinText(cells, " | ") + " |\n";
}

std::string markdownCell(const TableCell& cell, bool with_interval) {
  const std::string rift = riftText(cell, with_interval);
  const std::string paper = paperText(cell.paper);
  const std::string repository = paperText(cell.repository);
  return cellText(cell, with_interval) + (rift.empty() ? "" : "<br>RIFT: " + rift) +
         (paper.empty() ? "" : "<br>paper: " + paper) +
         (repository.empty() ? "" : "<br>RIFT's repository: " + repository);
}

}  // namespace

std::string tablesMarkdown(const std::vector<Table>& tables) {
  const std::string intervals = std::any_of(tables.begin(), tables.end(), anyIntervals)
                                    ? "[95 % interval, bootstrap by routes; of events per km exact "
                                      "Poisson, wider where routes differ] "
                                    : "";
  std::string text = "# Tables of the paper\n\nOurs: mean ± standard deviation over seeds " +
                     intervals +
                     "(routes, seeds, runs that have the measure). "
                     "RIFT: the same by RIFT's definition. paper: as printed there. RIFT's "
                     "repository: as printed there. "
                     "In parentheses alone: why a cell is empty.\n";
  for (const Table& table : tables) {
    const TableDefinition& definition = table.definition;
    text += "\n## " + definition.title + "\n\n";
    if (!definition.note.empty()) text += definition.note + "\n\n";
    std::vector<std::string> head = {definition.heading};
    for (const TableColumn& column : definition.columns)
      head.push_back(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
    text += row(head) + row(std::vector<std::string>(head.size(), "---"));
    for (std::size_t i = 0; i < table.cells.size(); ++i) {
      std::vector<std::string> cells = {definition.rows[i].name};
      const bool intervals = showsIntervals(table.cells[i]);
      for (const TableCell& cell : table.cells[i]) cells.push_back(markdownCell(cell, intervals));
      text += row(cells);
    }
    text += "\n";
    if (anyRowWithout(table)) text += intervalRule() + "\n\n";
    for (const std::string& footnote : definition.footnotes) text += "- " + footnote + "\n";
    for (const std::string& line : settingsLines(table)) text += "- " + line + "\n";
  }
  return text;
}

namespace {

/// The shipped matrix whose page shows the paper's tables and figures; all others have them as
/// files.
constexpr const char* kPaperMatrix = "paper_tables";

std::string skippedIn(const fs::path& results) {
  const fs::path file = results / kSkippedFile;
  return core::isFile(file) ? core::readFile(file, "list of what was left out") : "";
}

}  // namespace

void writeBatchReport(const fs::path& results, const std::string& name) {
  const std::vector<BatchRun> runs = readBatchRuns(results);
  const std::string variant = pooledVariant(runs);
  const std::vector<BatchRun> pooled = ofVariant(variant, runs);
  std::vector<Table> tables;
  for (const TableDefinition& definition : paperTables())
    tables.push_back(fillTable(withVariant(variant, definition), runs));
  std::vector<Figure> figures = paperFigures(pooled);
  std::vector<Figure> trails;
  for (const TrailsOf who : {TrailsOf::kCbvs, TrailsOf::kEgo}) {
    if (auto figure = trailFigure(runs, who)) trails.push_back(std::move(*figure));
  }
  figures.insert(figures.end(), trails.begin(), trails.end());
  core::OutputFolder output(results);
  core::OutputFolder table_files(output.subfolder("tables"));
  for (const Table& table : tables)
    table_files.write(table.definition.id + ".csv", tableCsv(table));
  table_files.write("tables.md", tablesMarkdown(tables));
  core::OutputFolder figure_files(output.subfolder("figures"));
  for (const Figure& figure : figures) {
    figure_files.write(figure.id + ".csv", figure.csv);
    figure_files.write(figure.id + ".svg", page::sheetFile(figure.sheet));
  }
  const bool of_the_paper = name == kPaperMatrix;
  output.write("index.html", batchPage(name, runs, of_the_paper ? tables : std::vector<Table>(),
                                       of_the_paper ? figures : trails, skippedIn(results)));
}

}  // namespace cdiff::evaluation
