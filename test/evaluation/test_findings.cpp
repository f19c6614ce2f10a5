// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "evaluation/paper/findings.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/run_records.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

TEST(Findings, TheRuleAsksForSignSizeAndAnIntervalWithoutZero) {
  using Outcome = FindingOutcome;
  EXPECT_EQ(outcomeOf(4.0, 2.0, Interval{0.1, 5.0}), Outcome::kReproduced);
  EXPECT_EQ(outcomeOf(4.0, 1.9, Interval{0.1, 5.0}), Outcome::kCannotBeTold);   // too small
  EXPECT_EQ(outcomeOf(4.0, 2.5, Interval{-0.1, 5.0}), Outcome::kCannotBeTold);  // holds 0
  EXPECT_EQ(outcomeOf(4.0, 0.5, Interval{-1.0, 1.9}), Outcome::kNotReproduced);
  EXPECT_EQ(outcomeOf(4.0, -3.0, Interval{-5.0, -1.0}), Outcome::kNotReproduced);
  EXPECT_EQ(outcomeOf(-4.0, -2.0, Interval{-5.0, -0.1}), Outcome::kReproduced);
  EXPECT_EQ(outcomeOf(-4.0, 3.0, Interval{1.0, 5.0}), Outcome::kNotReproduced);
  EXPECT_EQ(outcomeOf(4.0, 0.0, {}), Outcome::kCannotBeTold);
}

/// A run of the paper's system in a mode: so many contacts on 1 km as CBV.
BatchRun contactsOf(const char* mode, const std::string& route, double contacts) {
  BatchRun run;
  run.record = test::recordWith({route, "1"}, 1.0);
  Factors levels = cbvLevels(paper::kPaperMethod, mode);
  levels["ego_planner"] = paper::kPdmLite.planner();
  for (const auto& [factor, level] : levels) run.record.factors[factor] = level;
  run.numbers = {{metrics::known::kRiftCollisionsPerKm.place, contacts},
                 {metrics::known::kCbvDistance.place, 1000.0}};
  return run;
}

const Finding& figure4Of(const std::vector<Finding>& findings) { return findings.back(); }

TEST(Findings, AttackIsComparedOverTheRoutesThatBothHave) {
  // On a, b and c 20, 22 and 24 more; d was attacked only.
  std::vector<BatchRun> runs;
  int more = 20;
  for (const char* route : {"a", "b", "c"}) {
    runs.push_back(contactsOf(kNaturalistic, route, 1.0));
    runs.push_back(contactsOf(kSafetyCritical, route, 1.0 + more));
    more += 2;
  }
  runs.push_back(contactsOf(kSafetyCritical, "d", 500.0));
  const std::vector<Finding> findings = findingsOf(runs);
  const Finding& attack = figure4Of(findings);
  EXPECT_EQ(attack.table, "figure_4");
  EXPECT_NEAR(attack.paper_difference, 20.77 - 5.68, 1e-9);
  EXPECT_EQ(attack.routes, 3U);
  EXPECT_NEAR(*attack.difference, 22.0, 1e-9);
  EXPECT_GE(attack.interval->low, 20.0);
  EXPECT_LE(attack.interval->high, 24.0);
  EXPECT_EQ(attack.outcome, FindingOutcome::kReproduced);
}

TEST(Findings, EveryTableHasSomeAndNoneComparesMethodDefault) {
  const std::vector<Finding> findings = findingsOf({});
  for (const TableDefinition& table : paperTables()) {
    const auto of_table = [&](const Finding& finding) { return finding.table == table.id; };
    EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), of_table)) << table.id;
  }
  for (const Finding& finding : findings) {
    EXPECT_EQ(finding.outcome, FindingOutcome::kNotRun);
    EXPECT_NE(finding.paper_difference, 0.0);
    for (const std::string& name : {finding.a, finding.b})
      EXPECT_EQ(name.find("method default"), std::string::npos) << name;
  }
  EXPECT_NE(findingsMarkdown(findings).find(std::to_string(findings.size()) + " not run"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
