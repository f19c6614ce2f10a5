// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search_page.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/csv.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "evaluation/worker.h"
#include "page/page_parts.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::element;
using core::Markup;

constexpr const char* kFoundFolder = "found";
constexpr int kScoreDecimals = 3;

std::size_t foundIn(const std::vector<SearchCase>& cases) {
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const auto& one) { return one.isFound(); }));
}

/// "yes", "no", or "" where it was not asked.
std::string answerText(const std::optional<bool>& answer) {
  return !answer ? "" : *answer ? "yes" : "no";
}

/// What happened to the ego.
std::string eventText(const SearchCase& one) {
  if (!one.record.complete())
    return one.record.status + (one.record.cause.empty() ? "" : ": " + one.record.cause);
  const auto& contact = one.score.contact;
  if (!contact) return "no contact of the moving ego";
  return "contact with " + contact->partnerText() +
         (contact->ego_at_fault ? ", the ego's fault" : ", not the ego's fault") + ": " +
         contact->why;
}

std::string traceOf(const SearchCase& one, const fs::path& results) {
  if (!one.record.complete()) return "";
  const fs::path file = runFolder(results, one.id) / "summary.json";
  const std::string text = core::readFile(file, "summary");
  core::requireShallowJson(text, "summary '" + file.string() + "'");
  const auto summary = nlohmann::json::parse(text, nullptr, false);
  return summary.is_object() ? summary.value("trace_sha256", "") : "";
}

/// What came of the careful driver's session: as answerText(), or "broke".
std::string carefulText(const SearchCase& one) {
  return one.careful_broke ? "broke" : answerText(one.careful_survives);
}

/// A link to the report of a case, at its contact.
Markup caseLink(const SearchCase& one) {
  if (!one.record.complete()) return one.id;
  const auto& contact = one.score.contact;
  const std::string moment =
      contact ? "#t=" + core::formatFixed(std::max(0.0, contact->seconds - 2.0), 1) : "";
  return element("a", {{"href", "runs/" + one.id + "/report.html" + moment}}, one.id);
}

/// With places behind the dots of a key where browsers may break a line.
std::string wrapped(const std::string& key) {
  return core::joinText(core::splitText(key, '.'), ".\u200b");
}

Markup caseTable(const Search& search) {
  std::vector<std::string> head = {"#", "Case", "#Score", "What happened"};
  if (search.asksCarefulDriver()) head.emplace_back("Careful driver survives");
  for (const SearchKey& key : search.space().keys()) head.push_back("#" + wrapped(key.key));
  page::HtmlTable table(head);
  std::size_t rank = 0;
  for (const SearchCase* one : worstFirst(search.cases())) {
    std::vector<Markup> cells = {std::to_string(++rank), caseLink(*one),
                                 core::formatFixed(one->worth(), kScoreDecimals), eventText(*one)};
    if (search.asksCarefulDriver()) cells.emplace_back(carefulText(*one));
    for (const std::string& assignment : one->set)
      cells.emplace_back(assignment.substr(assignment.find('=') + 1));
    table.row(cells);
  }
  return table.html();
}

/// The scenario files of the cases that were found; others of an earlier search go.
void writeFound(const Search& search, core::OutputFolder& output) {
  core::OutputFolder found(output.subfolder(kFoundFolder));
  std::set<std::string> old = found.names();
  for (const SearchCase& one : search.cases()) {
    if (!one.isFound()) continue;
    const fs::path scenario = runFolder(output.path(), one.id) / "scenario.yaml";
    found.write(one.id + ".yaml", core::readFile(scenario, "scenario"));
    old.erase(one.id + ".yaml");
  }
  found.remove(old);
}

}  // namespace

std::string searchText(const std::vector<SearchCase>& cases, bool asks_careful) {
  std::string text = std::to_string(foundIn(cases)) + " of " + std::to_string(cases.size()) +
                     " cases have a contact of the moving ego" +
                     (asks_careful ? " that a careful driver in its place does not have" : "");
  const auto order = worstFirst(cases);
  if (order.empty()) return text;
  return text + "; worst: " + order.front()->id + " with score " +
         core::formatFixed(order.front()->worth(), kScoreDecimals);
}

std::string casesCsv(const Search& search, std::size_t batch, const fs::path& results) {
  std::vector<std::string> head = {
      "id", "batch", "score", "found", "contact", "careful_survives", "trace_sha256"};
  for (const SearchKey& key : search.space().keys()) head.push_back(key.key);
  std::string text = core::csvRow(head);
  std::size_t place = 0;
  for (const SearchCase& one : search.cases()) {
    std::vector<std::string> cells = {one.id,
                                      std::to_string(place++ / batch + 1),
                                      core::formatNumber(one.worth()),
                                      one.isFound() ? "yes" : "no",
                                      eventText(one),
                                      carefulText(one),
                                      traceOf(one, results)};
    for (const std::string& assignment : one.set)
      cells.push_back(assignment.substr(assignment.find('=') + 1));
    text += core::csvRow(cells);
  }
  return text;
}

std::string searchPage(const Search& search, const std::string& title) {
  const Markup header = page::pageHeader(
      title, "search of " + std::to_string(search.cases().size()) + " cases",
      element("p", {}, searchText(search.cases(), search.asksCarefulDriver()) + "."));
  const Markup note = page::pageNote(
      "Worst for the ego first. A case with a contact has a score of 1 or more. Each that was "
      "found is a scenario file in found/, and runs again with the same bytes.");
  return page::pageDocument(title, {},
                            header + page::pageSection("Cases", note + caseTable(search)));
}

void writeSearchFiles(const Search& search, const SearchRequest& request, const fs::path& results) {
  core::OutputFolder output(results);
  writeFound(search, output);
  const auto batch = static_cast<std::size_t>(request.options.batch);
  output.write("cases.csv", casesCsv(search, batch, output.path()));
  output.write("index.html", searchPage(search, "Search: " + request.scenario));
}

}  // namespace cdiff::evaluation
