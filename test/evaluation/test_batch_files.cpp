// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>

#include "e2e_cdiff/evaluation/batch_files.h"
#include "evaluation/run_records.h"

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
    not_passed.passed = false;
    not_passed.failures = {"score < 30"};
    records_ = {recordWith({"s", "1"}, 10), not_passed, failed,
                recordWithout({"t", "1"}, "not_run")};
  }
  static void expectIn(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
  }
  std::vector<RunRecord> records_;
};

TEST_F(BatchFiles, CsvHasARowPerPlannedRun) {
  const std::string csv = runsCsv(records_);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  expectIn(
      "id,scenario,ego_planner,cbv_planner,mode,guidance_profile,variant,seed,repetition,"
      "status,passed,exit_code,attempts,wall_seconds,ego_completion_percent,ego_driving_score",
      csv);
  // The score's column is filled, the one before it (completion) and the one after it are empty.
  expectIn("\ns_none_1_1,s,pdm_lite,pdm_lite,naturalistic,none,,1,1,completed,true,0,1,0.000,,10,,",
           csv);
  expectIn(",error,,2,2,0.000,,", csv);
  expectIn(",\"SUMO said \"\"no\"\", twice\"\n", csv);
  expectIn(",not_run,,,0,,", csv);
}

TEST_F(BatchFiles, SummaryHasACellPerCombination) {
  const std::string summary = batchSummaryJson("night", records_);
  expectIn(
      "\"evaluation\": \"night\",\n  \"runs\": 4,\n  \"failed\": 1,\n  \"not_run\": 1,\n"
      "  \"verdict_failed\": 1,",
      summary);
  expectIn("\"runs\": 3,\n      \"failed\": 1,\n      \"not_run\": 0,", summary);
  // 10 and 20: mean 15, s = sqrt(50).
  expectIn(
      "\"ego_driving_score\": {\n          \"mean\": 15.0,\n          \"standard_deviation\": "
      "7.0710678",
      summary);
}

TEST_F(BatchFiles, JunitTellsErrorsFailuresAndWhatWasNotRun) {
  const std::string xml = batchJunitXml("night", records_);
  expectIn("<testsuites tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\"", xml);
  expectIn("<failure type=\"completed\" message=\"score &lt; 30\"/>", xml);
  expectIn("<error type=\"error\" message=\"SUMO said &quot;no&quot;, twice\"/>", xml);
  expectIn("<skipped message=\"not_run\"/>", xml);
}

TEST_F(BatchFiles, MarkdownShowsTheFactorsThatVary) {
  const std::string text = batchMarkdown("night", records_);
  expectIn("4 runs: 1 failed, 1 not run or interrupted, 1 ended with a failed verdict", text);
  expectIn("| scenario | runs | failed | not run | ego_completion_percent | ego_driving_score |",
           text);
  expectIn("| s | 3 | 1 | 0 | - | 15.00 \xC2\xB1 7.07 (2) |", text);
  expectIn("| t | 1 | 0 | 1 | - | - |", text);
}

}  // namespace
}  // namespace cdiff::evaluation
