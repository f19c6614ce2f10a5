// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Whatever names and texts come from outside: the page, pictures, tables and files of a batch hold
/// them as text.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>

#include "core/file.h"
#include "core/markup.h"
#include "core/text.h"
#include "evaluation/batch_files.h"
#include "evaluation/batch_report.h"
#include "evaluation/comparison/comparison.h"
#include "evaluation/comparison/comparison_text.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/run_records.h"
#include "page/outside_texts.h"

namespace cdiff::evaluation {
namespace {

using test::outsideText;
using test::tagsOf;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Readers of trace.csv and plans.csv take a row to be a line, so no vehicle may have a line end in
/// its name.
std::string withoutLineEnds(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
  return text;
}

/// Makes a reason so long that it folds.
const std::string kLong(60, 'y');

/// A batch with `text` in every name: a run of the paper's own planner, a copy of it with another
/// one, and a broken run of a planner that no one knows.
class NamedBatch {
 public:
  explicit NamedBatch(const std::string& text) : text_(text) {
    test::writeNamedSession(scratch_.path(), withoutLineEnds(text));
    core::writeFileAtomically(scratch_.path() / "scenario.yaml",
                              core::dumpOptions(test::namedOptions(text)));
    add(paper::kDiffusion.planner());
    add(paper::kTwoStage.planner());
    add("planner" + text);
    RunRecord& broken = runs_.back().record;
    broken.status = "error";
    broken.cause = "cause " + text + kLong;
  }

  std::vector<RunRecord> records() const {
    std::vector<RunRecord> records;
    for (const BatchRun& run : runs_) records.push_back(run.record);
    return records;
  }
  std::vector<Figure> figures() const { return paperFigures(runs_); }
  std::vector<Table> tables() const {
    const TableDefinition own = {
        "table",
        "title " + text_,
        "note " + text_,
        "heading " + text_,
        {{"column " + text_, "unit " + text_, "/ego/driving_score", "", "", {}}},
        {{"row " + text_, {}, {}, ""}}};
    std::vector<Table> tables = {fillTable(own, runs_)};
    for (const TableDefinition& definition : paperTables())
      tables.push_back(fillTable(definition, runs_));
    return tables;
  }
  std::string page() const { return batchPage("batch " + text_, runs_, tables(), figures()); }
  std::string comparison(const std::function<std::string(const std::vector<Comparison>&)>& write) {
    const RunSet a{"A " + text_, {records().front()}};
    const RunSet b{"B " + text_, {records().front()}};
    return write({compareRuns(a, b, sharedFactors(a, b), {})});
  }

 private:
  void add(const std::string& planner) {
    RunRecord record = test::recordWith({"scenario" + text_, "1"}, 50.0);
    for (const auto& [factor, level] : cbvLevels(paper::kDiffusion)) record.factors[factor] = level;
    record.factors["cbv_planner"] = planner;
    record.factors["variant"] = "variant" + text_;
    record.verdict = record::Outcome::kFailed;
    record.reasons = {"reason " + text_ + kLong};
    record.decided_by = {"rule " + text_};
    record.id = planner + " run" + text_;
    const std::string summary = core::readFile(scratch_.path() / "summary.json", "summary");
    runs_.push_back({record, scratch_.path(), summaryNumbers(summary, "summary")});
  }

  std::string text_;
  test::TemporaryFolder scratch_;
  std::vector<BatchRun> runs_;
};

std::set<std::string> kindsOf(const std::string& html) {
  const std::vector<std::string> tags = tagsOf(html);
  return {tags.begin(), tags.end()};
}

class BatchTexts : public testing::Test {
 protected:
  NamedBatch named_{outsideText()};
  NamedBatch harmless_{""};
};

TEST_F(BatchTexts, ThePageShowsThem) {
  const std::string page = named_.page();
  // Lines of text in pictures wrap, so there may be more of them, but none of another kind.
  const std::set<std::string> harmless = kindsOf(harmless_.page());
  for (const std::string& kind : kindsOf(page)) EXPECT_EQ(harmless.count(kind), 1u) << kind;
  EXPECT_TRUE(test::isPlain(page));
  EXPECT_EQ(page.find("<script"), page.rfind("<script"));  // the page's own
  for (const char* place : {"<h1>batch ", "reason ", "cause ", "<h2>title ", "heading ", ">note ",
                            ">column ", "<td>row ", "<title>bg_1", " run", "href=\"runs/planner",
                            "<th scope=\"row\">scenario", "data-filter=\"scenario"})
    EXPECT_TRUE(has(page, place + std::string(test::escapedText()))) << place;
}

TEST_F(BatchTexts, PicturesAreXmlAndShowThem) {
  const std::vector<Figure> figures = named_.figures();
  const std::vector<Figure> harmless = harmless_.figures();
  ASSERT_EQ(figures.size(), harmless.size());
  std::string all;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string svg = page::sheetFile(figures[i].sheet);
    EXPECT_GT(test::xmlElementsOf(svg).size(), 1u) << test::xmlElementsOf(svg).front();
    EXPECT_TRUE(test::isPlain(svg));
    EXPECT_EQ(kindsOf(svg), kindsOf(page::sheetFile(harmless[i].sheet))) << figures[i].id;
    all += svg;
  }
  EXPECT_TRUE(has(all, "<title>bg_1" + std::string(test::escapedText())));  // a vehicle
  EXPECT_TRUE(has(all, ">planner" + std::string(test::escapedText())));     // in a legend
}

TEST_F(BatchTexts, LongNamesAreCutInPictures) {
  const NamedBatch named(test::longText());
  for (const Figure& figure : named.figures()) {
    const std::string svg = page::sheetFile(figure.sheet);
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(svg.c_str()));
    for (const auto& found : document.select_nodes("//text"))
      EXPECT_LE(std::string(found.node().text().get()).size(), 170u) << figure.id;
  }
}

TEST_F(BatchTexts, TheJunitFileIsXmlAndHoldsThem) {
  const std::string text = batchJunitXml("batch " + outsideText(), named_.records());
  EXPECT_TRUE(test::isPlain(text));
  pugi::xml_document junit;
  ASSERT_TRUE(junit.load_string(text.c_str())) << text;
  const pugi::xml_node suite = junit.child("testsuites").child("testsuite");
  EXPECT_EQ(suite.attribute("name").value(), core::plainText("batch " + outsideText()));
  EXPECT_EQ(suite.select_node("testcase/error").node().attribute("message").value(),
            core::plainText("cause " + outsideText() + kLong));
  EXPECT_EQ(suite.select_node("testcase/failure").node().attribute("type").value(),
            core::plainText("rule " + outsideText()));
  EXPECT_EQ(test::xmlElementsOf(text),
            test::xmlElementsOf(batchJunitXml("batch", harmless_.records())));
}

/// Numbers of cells of each row, and the cells, by the rules of RFC 4180.
struct CsvTable {
  explicit CsvTable(const std::string& text) {
    bool quoted = false;
    std::size_t columns = 1;
    cells.emplace_back();
    for (const char letter : text) {
      quoted ^= letter == '"';
      if (!quoted && (letter == ',' || letter == '\n')) {
        cells.emplace_back();
        ++columns;
      } else {
        cells.back() += letter;
      }
      if (quoted || letter != '\n') continue;
      widths.insert(columns - 1);
      columns = 1;
    }
  }
  std::set<std::size_t> widths;
  std::vector<std::string> cells;
};

TEST_F(BatchTexts, CsvFilesHaveTheirColumns) {
  std::vector<std::string> files = {runsCsv(named_.records()), named_.comparison(comparisonCsv)};
  for (const Figure& figure : named_.figures()) files.push_back(figure.csv);
  for (const Table& table : named_.tables()) files.push_back(tableCsv(table));
  for (const std::string& file : files) EXPECT_EQ(CsvTable(file).widths.size(), 1u) << file;
  EXPECT_TRUE(has(files.front(), "\"cause <script>alert(1)</script>\"\"'&amp;"));
}

/// Every line of a table has as many cells as the one before it.
void expectTables(const std::string& markdown) {
  EXPECT_FALSE(has(markdown, "<script"));
  EXPECT_TRUE(test::isPlain(markdown));
  std::size_t before = 0;
  for (const std::string& line : core::splitText(markdown, '\n')) {
    std::size_t cells = 0;
    for (std::size_t i = 0; i < line.size(); ++i)
      cells += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    const bool row = line.rfind('|', 0) == 0;
    EXPECT_TRUE(!row || before == 0 || cells == before) << line;
    before = row ? cells : 0;
  }
}

TEST_F(BatchTexts, MarkdownTablesKeepTheirCells) {
  const std::string summary = batchMarkdown("batch " + outsideText(), named_.records());
  expectTables(summary);
  EXPECT_TRUE(has(summary, "# batch &lt;script>alert(1)&lt;/script>"));
  EXPECT_TRUE(has(summary, "| scenario&lt;script>"));
  const std::string comparison = named_.comparison(
      [](const auto& comparisons) { return comparisonMarkdown(comparisons, true); });
  expectTables(comparison);
  EXPECT_TRUE(has(comparison, "## A = A &lt;script>"));
}

TEST_F(BatchTexts, TheSummaryHoldsThem) {
  const auto summary = nlohmann::json::parse(batchSummaryJson(outsideText(), named_.records()));
  EXPECT_TRUE(has(summary["evaluation"].get<std::string>(), "<script>alert(1)</script>"));
}

TEST(BatchAssets, TheStyleSheetCanStandInItsElement) {
  EXPECT_EQ(kBatchPageStyle.text().find_first_of("<&"), std::string_view::npos);
  EXPECT_EQ(kBatchPageScript.text().find("</script"), std::string_view::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
