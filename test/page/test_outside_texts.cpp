// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Whatever names and texts come from outside: pages have the same elements as with harmless ones,
/// and show them as text.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/file.h"
#include "core/markup.h"
#include "e2e_cdiff/metrics/metric.h"
#include "learning/small_samples.h"
#include "page/outside_texts.h"
#include "page/page_parts.h"
#include "page/player_parts.h"
#include "page/training_pages.h"

namespace cdiff::page {
namespace {

using test::outsideText;
using test::tagsOf;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

/// A page with outside texts against the same page with harmless ones.
void expectSameElements(const std::string& page, const std::string& harmless) {
  EXPECT_EQ(tagsOf(page), tagsOf(harmless));
  EXPECT_TRUE(test::isPlain(page));
  EXPECT_FALSE(has(page, "<script>alert"));
  EXPECT_TRUE(has(page, test::escapedText()));
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin) + begin.size();
  return text.substr(from, text.find(end, from) - from);
}

TEST(OutsideTexts, TheReaderOfTagsNoticesWhatIsNotEscaped) {
  const std::string end = "</p>";
  EXPECT_EQ(tagsOf("<p class=\"a\" hidden>x" + end),
            std::vector<std::string>({"p class hidden", "/p"}));
  EXPECT_NE(tagsOf("<p>" + outsideText() + end), tagsOf("<p>x" + end));
  EXPECT_NE(tagsOf("<p id=\"" + outsideText() + "\">" + end), tagsOf("<p id=\"x\">" + end));
  EXPECT_NE(tagsOf("<p id=\"a\" onclick=\"b\">" + end), tagsOf("<p id=\"a\">" + end));
  EXPECT_NE(tagsOf("<script>\"</script>\"</script>"), tagsOf("<script>\"\"</script>"));
  EXPECT_NE(tagsOf("a < b"), tagsOf("a b"));
  EXPECT_FALSE(test::isPlain(outsideText()));
}

/// A measure as a plug-in may define it.
void registerNamedMetric() {
  static const std::string label = "label " + outsideText();
  static const metrics::MeasureDefinition definition = {"outside_measure",
                                                        "",
                                                        label.c_str(),
                                                        "count",
                                                        metrics::Direction::kNeither,
                                                        metrics::Subject::kEgo,
                                                        "A measure.",
                                                        "",
                                                        0};
  class Nothing final : public metrics::Metric {
    void observe(const metrics::MetricTick&) override {}
    void report(metrics::MetricSink& sink) const override {
      sink.set(definition, {1.0, 1, {}, {}});
    }
  };
  metrics::registerMetric(
      {"outside_metric",
       "A metric.",
       {definition},
       [](const metrics::MetricContext&) { return std::make_unique<Nothing>(); },
       "a_plugin.so"});
}

/// A result folder with `text` in every name.
class NamedResult {
 public:
  explicit NamedResult(const std::string& text) { test::writeNamedSession(scratch_.path(), text); }
  std::string textOf(const char* name) const {
    return core::readFile(scratch_.path() / name, name);
  }

 private:
  test::TemporaryFolder scratch_;
};

TEST(OutsideTexts, TheReportShowsThem) {
  const std::string page = NamedResult(outsideText()).textOf("report.html");
  const std::string harmless = NamedResult("").textOf("report.html");
  expectSameElements(page, harmless);
  EXPECT_EQ(countOf(page, "<script"), 3u);  // the data, the player and the program
  for (const char* place :
       {"<h1>scenario ", "<td>bg_1", "<h3>bg_1", "<title>bg_1", "</svg>CBV bg_1", "<td>source ",
        "<td>fault ", "<td>speed", "<figcaption>speed", "<td>ego:", "<td>cbv:", "<td>change ",
        "<td>deployment ", "<td>SUMO ", "<td>network", "<title>contact of bg_9"})
    EXPECT_TRUE(has(page, place + std::string(test::escapedText()))) << place;
}

TEST(OutsideTexts, AMetricOfAPlugInIsShown) {
  const std::string harmless = NamedResult("").textOf("report.html");
  registerNamedMetric();
  const std::string page = NamedResult("").textOf("report.html");
  EXPECT_TRUE(has(page, "<summary>label " + std::string(test::escapedText())));
  // One row of five cells more, with a definition that unfolds.
  EXPECT_EQ(tagsOf(page).size(), tagsOf(harmless).size() + 12 + 6);
  EXPECT_EQ(countOf(page, "<script"), 3u);
  EXPECT_TRUE(test::isPlain(page));
}

TEST(OutsideTexts, TheDataOfTheReportHoldThem) {
  const std::string page = NamedResult(outsideText()).textOf("report.html");
  const std::string json = between(page, "id=\"playback\">", "</script>");
  EXPECT_FALSE(has(json, "<"));
  EXPECT_TRUE(has(json, "\\u003cscript>alert(1)"));
  const auto vehicles = nlohmann::json::parse(json)["vehicles"];
  EXPECT_EQ(vehicles[1][0].get<std::string>().rfind("bg_1<script>alert(1)</script>\"'&amp;", 0), 0u)
      << vehicles;
}

TEST(OutsideTexts, TheJunitFileIsXmlAndHoldsThem) {
  const std::string text = NamedResult(outsideText()).textOf("junit.xml");
  EXPECT_TRUE(test::isPlain(text));
  EXPECT_FALSE(has(text, "&#1;"));  // which no XML parser may take
  pugi::xml_document junit;
  ASSERT_TRUE(junit.load_string(text.c_str())) << text;
  const pugi::xml_node suite = junit.child("testsuites").child("testsuite");
  EXPECT_EQ(suite.attribute("name").value(), core::plainText("scenario " + outsideText()));
  EXPECT_GT(suite.attribute("failures").as_int(), 0);
  const std::string message = suite.find_child_by_attribute("testcase", "name", "contacts_at_fault")
                                  .child("failure")
                                  .attribute("message")
                                  .value();
  EXPECT_TRUE(has(message, core::plainText("bg_9" + outsideText()))) << text;
  EXPECT_EQ(test::xmlElementsOf(text), test::xmlElementsOf(NamedResult("").textOf("junit.xml")));
}

TEST(OutsideTexts, TheTrainingPageShowsThem) {
  const auto page = [](const std::string& text) {
    TrainingStage stage{"stage" + text, 10, 20.0, {}};
    const std::vector<std::string> quantities = {"loss" + text, "loss",
                                                 "held_out_" + text + "_ade_m", "held_out_b_ade_m"};
    for (const std::string& quantity : quantities)
      stage.curves[quantity] = {{10.0, 1.0}, {20.0, 0.5}};
    return trainingReport("model" + text, {stage}, "card " + text);
  };
  expectSameElements(page(outsideText()), page("a"));
  for (const char* place : {"<h1>model", "<h2>stage", "<pre>card ", "</svg>loss"})
    EXPECT_TRUE(has(page(outsideText()), place + std::string(test::escapedText()))) << place;
}

TEST(OutsideTexts, TheSampleSheetShowsThem) {
  const test::TemporaryFolder folder;
  learning::DrivingShardWriter writer(test::smallSchema());
  for (std::size_t i = 0; i < 8; ++i) writer.append(test::smallSample(i, i));
  writer.write(folder.path() / "a.shard");
  const learning::Dataset stored(folder.path(), 0.0);
  const learning::DrivingDataset dataset(stored);
  const auto page = [&](const std::string& text) {
    return sampleSheet("data" + text, {{"dropped: " + text, "1" + text, "2" + text}}, dataset, 1);
  };
  expectSameElements(page(outsideText()), page(""));
  for (const char* place : {"<h1>data", "<td>dropped: ", "<td>1", "<td>2"})
    EXPECT_TRUE(has(page(outsideText()), place + std::string(test::escapedText()))) << place;
}

TEST(OutsideTexts, PicturesCutWhatIsTooLong) {
  const NamedResult result(test::longText());
  const std::string page = result.textOf("report.html");
  EXPECT_EQ(tagsOf(page), tagsOf(NamedResult("").textOf("report.html")));
  // A name in the picture from above has 40 characters: "bg_1", 35 letters and an ellipsis.
  const std::string picture = between(page, "id=\"top-view\"", "</svg>");
  EXPECT_TRUE(has(picture, ">bg_1" + std::string(35, 'W') + "…</text>"));
  for (std::size_t at = page.find("<text"); at != std::string::npos;
       at = page.find("<text", at + 1))
    EXPECT_LT(page.find("</text>", at) - at, 400u);
  EXPECT_TRUE(has(page, "<td>bg_1" + test::longText() + "</td>"));  // the style sheet breaks it
  EXPECT_EQ(test::xmlElementsOf(result.textOf("junit.xml")),
            test::xmlElementsOf(NamedResult("").textOf("junit.xml")));
}

TEST(PageAssets, CanStandInTheirElements) {
  for (const core::Asset* sheet :
       {&kReportStyle, &kPanelSheetStyle, &kSampleSheetStyle, &kLiveStyle})
    EXPECT_EQ(sheet->text().find_first_of("<&"), std::string_view::npos);
  for (const core::Asset* script : {&kPlayerScript, &kReportScript, &kLiveScript}) {
    EXPECT_FALSE(has(std::string(script->text()), "</script"));
    EXPECT_FALSE(has(std::string(script->text()), "<!--"));
  }
  const std::string page = NamedResult("").textOf("report.html");
  EXPECT_TRUE(has(page, "<script>\n" + std::string(kReportScript.text()) + "</script>"));
  EXPECT_TRUE(has(page, "<style>\n" + std::string(kReportStyle.text()) + "</style>"));
}

TEST(PageAssets, TheScriptsAreJavaScript) {
  if (std::system("command -v node > /dev/null 2>&1") != 0) GTEST_SKIP() << "node is not installed";
  const test::TemporaryFolder scratch;
  const std::string file = (scratch.path() / "report.js").string();
  for (const core::Asset* script : {&kPlayerScript, &kReportScript, &kLiveScript}) {
    EXPECT_FALSE(has(std::string(script->text()), "::"));  // a name of C++
    core::writeFileAtomically(file, std::string(script->text()));
    EXPECT_EQ(std::system(("node --check " + file).c_str()), 0);
  }
}

TEST(PageAssets, TheScriptsMakeNoMarkupOfTexts) {
  for (const core::Asset* script : {&kPlayerScript, &kReportScript, &kLiveScript}) {
    for (const char* way : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write"})
      EXPECT_FALSE(has(std::string(script->text()), way)) << way;
  }
}

}  // namespace
}  // namespace cdiff::page
