// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "evaluation/batch_files.h"
#include "evaluation/batch_report.h"
#include "evaluation/run_records.h"
#include "record/verdict_cases.h"

namespace cdiff::evaluation {
namespace {

using test::recordWith;
using test::recordWithout;

class BatchFiles : public testing::Test {
 protected:
  BatchFiles() {
    RunRecord failed = recordWithout({"s", "3"}, "error");
    failed.cause = "SUMO said \"no\", twice";
    failed.attempts = 2;
    failed.exit_code = 2;
    RunRecord not_passed = recordWith({"s", "2"}, 20);
    not_passed.verdict = record::Outcome::kFailed;
    not_passed.reasons = {"score < 30"};
    not_passed.decided_by = {"driving_score", "red_lights"};
    RunRecord struck = recordWith({"u", "1"}, 30);
    struck.verdict = record::Outcome::kStruck;
    struck.reasons = {"struck by cbv_1"};
    RunRecord not_judged = recordWith({"v", "1"}, 40);
    not_judged.verdict = record::Outcome::kNotJudged;
    not_judged.reasons = {"no rules"};
    records_ = {recordWith({"s", "1"}, 10),           not_passed, failed,
                recordWithout({"t", "1"}, "not_run"), struck,     not_judged};
  }
  static void expectIn(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
  }
  std::vector<RunRecord> records_;
};

TEST_F(BatchFiles, CsvHasARowPerPlannedRun) {
  const std::string csv = runsCsv(records_);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  expectIn(
      "id,scenario,ego_planner,cbv_planner,mode,method,guidance_profile,variant,seed,repetition,"
      "status,verdict,exit_code,attempts,wall_seconds,ego_completion_percent,ego_driving_score",
      csv);
  // The score's column is filled, the one before it (completion) and the one after it are empty.
  expectIn(
      "\ns_none_1_1,s,pdm_lite,pdm_lite,naturalistic,default,none,,1,1,completed,passed,0,1,0.000,,"
      "10,,",
      csv);
  expectIn("1,1,completed,struck,0,", csv);
  expectIn("1,1,completed,not_judged,0,", csv);
  expectIn(",error,,2,2,0.000,,", csv);
  expectIn(",\"SUMO said \"\"no\"\", twice\"\n", csv);
  expectIn(",not_run,,,0,,", csv);
}

TEST_F(BatchFiles, SummaryHasACellPerCombination) {
  const std::string summary = batchSummaryJson("night", records_);
  expectIn(
      "\"evaluation\": \"night\",\n  \"runs\": 6,\n  \"failed\": 1,\n  \"not_run\": 1,\n"
      "  \"verdict_passed\": 1,\n  \"verdict_struck\": 1,\n  \"verdict_failed\": 1,\n  "
      "\"verdict_not_judged\": 1,",
      summary);
  expectIn("\"runs\": 3,\n      \"failed\": 1,\n      \"not_run\": 0,", summary);
  // 10 and 20: mean 15, s = sqrt(50).
  expectIn(
      "\"ego_driving_score\": {\n          \"mean\": 15.0,\n          \"standard_deviation\": "
      "7.0710678",
      summary);
}

TEST_F(BatchFiles, SummaryHasASystemPerCombinationWithoutRoutes) {
  // 4 contacts in 2 km on two routes: 2 per km, Garwood 1.0899 to 10.2416 over 2 km.
  std::vector<RunRecord> records = {recordWith({"s", "1"}, 10), recordWith({"t", "1"}, 30)};
  for (RunRecord& record : records) {
    record.measures["cbv_collisions"] = 2.0;
    record.measures["cbv_distance_m"] = 1000.0;
  }
  const auto systems = nlohmann::json::parse(batchSummaryJson("night", records))["systems"];
  ASSERT_EQ(systems.size(), 1U);
  EXPECT_EQ(systems[0]["factors"].count("scenario"), 0U);
  EXPECT_EQ(systems[0]["routes"], 2);
  const auto& contacts = systems[0]["figures"]["cbv_collisions"];
  EXPECT_EQ(contacts["events"], 4);
  EXPECT_DOUBLE_EQ(contacts["km"], 2.0);
  EXPECT_NEAR(contacts["interval_95"][0], 0.5449, 1e-4);
  EXPECT_NEAR(contacts["interval_95"][1], 5.1208, 1e-4);
  EXPECT_EQ(systems[0]["figures"]["ego_driving_score"]["interval_95"],
            nlohmann::json::array({10.0, 30.0}));
  const std::string text = batchMarkdown("night", records);
  expectIn("| all runs | 2 | 0 | 0 | 2 | 1 |", text);
  expectIn("| 4 / 2.000 km = 2.00 |", text);
  expectIn(
      "Warning: only 1 seed; a figure needs at least 5 (`--seeds 1,2,3,4,5`). Only 2 routes: "
      "too few for bootstrap intervals, which need 5.",
      text);
}

TEST_F(BatchFiles, ARowOfSystemsShowsAllIntervalsOrNone) {
  // 5 routes with 1 contact in 1 km each: 1 per km, Garwood 1.6235 to 11.6683 over 5 km. Route 4
  // lacks nothing in system "none", which shows intervals; system "speed" drove 4 of them.
  std::vector<RunRecord> records;
  for (const char* profile : {"none", "speed"}) {
    for (const char* route : {"a", "b", "c", "d", "e"}) {
      if (*route == 'e' && *profile == 's') continue;
      records.push_back(recordWith({route, "1", profile}, 10.0 + (*route - 'a')));
      records.back().measures["cbv_collisions"] = 1.0;
      records.back().measures["cbv_distance_m"] = 1000.0;
    }
  }
  records[0].measures["ttc_mean_s"] = 2.5;  // of one route alone
  std::string text = batchMarkdown("night", records);
  expectIn("Figures over all routes with 95 % intervals", text);
  expectIn("| 5 / 5.000 km = 1.00 [0.32, 2.33] |", text);
  expectIn("ttc_mean_s: no interval: one route has it", text);
  expectIn("| 4 / 4.000 km = 1.00 |", text);
  expectIn("A row shows the intervals of all its figures or none: it needs 5 routes.", text);
  records.resize(4);  // 4 routes alone: nothing promises intervals
  text = batchMarkdown("night", records);
  expectIn("Figures over all routes; counts are events / km = rate.", text);
  EXPECT_EQ(text.find("95 %"), std::string::npos) << text;
}

TEST_F(BatchFiles, ASystemThatWasNotRunIsNoReasonForAWarning) {
  std::vector<RunRecord> records;
  for (int route = 0; route < 10; ++route) {
    for (const char* seed : {"1", "2", "3", "4", "5"})
      records.push_back(recordWith({std::to_string(route), seed}, 10.0 + route));
  }
  records.push_back(recordWithout({"0", "1", "speed"}, "not_run"));
  EXPECT_EQ(batchMarkdown("night", records).find("Warning"), std::string::npos);
}

TEST_F(BatchFiles, JunitReportsErrorsFailuresAndWhatWasNotRun) {
  const std::string xml = batchJunitXml("night", records_);
  expectIn("<testsuites tests=\"6\" failures=\"1\" errors=\"1\" skipped=\"1\"", xml);
  expectIn("<failure type=\"driving_score, red_lights\" message=\"score &lt; 30\" />", xml);
  expectIn("<error type=\"error\" message=\"SUMO said &quot;no&quot;, twice\" />", xml);
  expectIn("<system-out>struck: struck by cbv_1</system-out>", xml);
  expectIn("<system-out>not judged: no rules</system-out>", xml);
  expectIn("<skipped message=\"not_run\" />", xml);
}

/// Four runs are complete (s twice, u, v); s has a CBV in one of its two, u in none, v does not
/// say.
TEST_F(BatchFiles, MarkdownCountsRunsAndScenariosWithoutACbv) {
  records_[0].measures["cbv_count"] = 0.0;
  records_[1].measures["cbv_count"] = 2.0;
  records_[4].measures["cbv_count"] = 0.0;
  expectIn("Without a CBV: 2 of 3 complete runs; no run with one on 1 of 2 scenarios (u).\n",
           batchMarkdown("night", records_));
}

TEST_F(BatchFiles, MarkdownShowsTheFactorsThatVary) {
  const std::string text = batchMarkdown("night", records_);
  expectIn(
      "6 runs: 1 broken, 1 not run or interrupted, 1 ended with a failed verdict, 1 were struck, 1 "
      "were not judged, 1 passed.",
      text);
  expectIn("| scenario | runs | broken | not run | ego_completion_percent | ego_driving_score |",
           text);
  expectIn("| s | 3 | 1 | 0 | - | 15.00 \xC2\xB1 7.07 (2) |", text);
  expectIn("| t | 1 | 0 | 1 | - | - |", text);
}

/// The record that a batch keeps of a session.
RunRecord recordOf(const test::VerdictCase& wanted, const std::filesystem::path& folder) {
  const test::SampleSetup sample(test::optionsOf(wanted));
  page::ResultWriter writer(sample.setup, test::sampleFacts(), folder);
  test::playCase(writer, wanted);
  writer.finish(1.0);
  const SummaryFacts facts =
      readSummary(core::readFile(folder / "summary.json", "summary"), wanted.name);
  RunRecord record = recordWithout({wanted.name}, facts.status);
  record.verdict = facts.verdict;
  record.reasons = facts.reasons;
  record.decided_by = facts.decided_by;
  record.exit_code = writer.exitCode();
  record.attempts = 1;
  return record;
}

/// Values of an attribute of every element of that name, with commas between them.
std::string typesIn(const std::string& xml, const std::string& element) {
  const std::string begin = "<" + element + " type=\"";
  std::vector<std::string> types;
  for (std::size_t at = xml.find(begin); at != std::string::npos; at = xml.find(begin, at)) {
    at += begin.size();
    types.push_back(xml.substr(at, xml.find('"', at) - at));
  }
  return core::joinText(types, ", ");
}

class BatchVerdict : public testing::TestWithParam<test::VerdictCase> {};

/// The row of the run in runs.csv, the counts, JUnit and the page say what the session's files say.
TEST_P(BatchVerdict, IsThatOfTheSession) {
  const test::VerdictCase& wanted = GetParam();
  const test::TemporaryFolder folder;
  const RunRecord record = recordOf(wanted, folder.path());
  const std::string word = record::toText(wanted.outcome);
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string status = traffic::toText(wanted.status);
  const std::string csv = runsCsv({record});
  EXPECT_TRUE(has(csv, "," + status + "," + (record.complete() ? word : "") + "," +
                           std::to_string(wanted.exit_code) + ",1,"))
      << csv;
  const std::string summary = batchSummaryJson("night", {record});
  for (const char* each : {"passed", "struck", "failed", "not_judged"})
    EXPECT_TRUE(
        has(summary, std::string("\"verdict_") + each + "\": " + (word == each ? "1" : "0")))
        << each << summary;
  const std::string xml = batchJunitXml("night", {record});
  EXPECT_EQ(has(xml, "<failure"), wanted.outcome == record::Outcome::kFailed);
  EXPECT_EQ(has(xml, "<error"), wanted.outcome == record::Outcome::kError);
  EXPECT_EQ(has(xml, "<skipped"), wanted.outcome == record::Outcome::kInterrupted);
  EXPECT_EQ(has(xml, "<system-out>struck: "), wanted.outcome == record::Outcome::kStruck);
  EXPECT_EQ(has(xml, "<system-out>not judged: "), wanted.outcome == record::Outcome::kNotJudged);
  const std::string sessions_xml = core::readFile(folder.path() / "junit.xml", "junit");
  EXPECT_EQ(typesIn(xml, "failure"), typesIn(sessions_xml, "failure")) << sessions_xml;
  const std::string shown = record.complete() ? word : "error";
  const std::string page = batchPage("night", {{record, folder.path(), {}}}, {}, {});
  EXPECT_TRUE(has(page, "class=\"banner " + shown + "\""));
  EXPECT_TRUE(has(page, "<tr class=\"" + shown + "\">"));
}

/// The page of a batch whose first run has a report and a contact at 15.8 s.
std::string contactPage(const test::TemporaryFolder& folder, std::vector<RunRecord> records) {
  core::writeFileAtomically(folder.path() / "report.html", "");
  std::vector<BatchRun> runs;
  for (const RunRecord& record : records) runs.push_back({record, folder.path(), {}});
  runs.front().contacts = {{15.8, "vehicle_27", true, "its front struck the rear", 8.0, 2.0}};
  return batchPage("night", runs, {}, {}, "6 runs of m.yaml: cannot be guided");
}

TEST_F(BatchFiles, ThePageAnswersFirstAndLinksTheWorstMoment) {
  const test::TemporaryFolder folder;
  records_[0].measures["cbv_ego_collisions"] = 2.0;
  records_[0].measures["cbv_moving_ego_collisions"] = 1.0;
  records_[0].measures["cbv_distance_m"] = 1000.0;
  const std::string page = contactPage(folder, records_);
  expectIn(
      "<div class=\"answer\"><p>pdm_lite, for the ego driven by pdm_lite: CBVs touched the moving "
      "ego 1 time in 1.00 km (1.0 per km",
      page);
  EXPECT_LT(page.find("class=\"answer\""), page.find("class=\"banner"));
  expectIn(
      "<li><a href=\"runs/s_none_1_1/report.html#t=15.80\" title=\"s_none_1_1\">s, seed 1 at "
      "15.80 s</a>, pdm_lite: contact of the ego with vehicle_27 (the ego&#39;s fault)",
      page);
  expectIn("Left out: 6 runs of m.yaml: cannot be guided", page);
}

TEST_F(BatchFiles, ThePageFoldsLongReasonsAndSpellsKeysOut) {
  const test::TemporaryFolder folder;
  records_[1].reasons = {std::string(200, 'x')};
  const std::string page = contactPage(folder, records_);
  expectIn("<details class=\"reason\"><summary>", page);
  for (const char* key : {"ego_driving_score", "cbv_off_road", "ego_completion_percent"})
    EXPECT_EQ(page.find(key), std::string::npos) << key;
  expectIn("Route completion [%]", page);
  expectIn("id=\"filter\"", page);
}

INSTANTIATE_TEST_SUITE_P(All, BatchVerdict, testing::ValuesIn(test::verdictCases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cdiff::evaluation
