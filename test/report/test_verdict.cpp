// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/report/verdict.h"

namespace cdiff::report {
namespace {

using traffic::SessionStatus;

metrics::SessionMeasures goodMeasures() {
  metrics::SessionMeasures measures;
  measures.route_completion_percent = 80.0;
  measures.protocol = "bench2drive";
  measures.driving_score = 33.6;
  measures.ego_collisions = 1;
  measures.infractions["red_lights"] = {1.0, 3, "", ""};
  measures.infractions["stop_signs"] = {2.0, 2, "", ""};
  measures.infractions["outside_lanes_percent"] = {1.25, 400, "%", ""};
  measures.cbv_off_road_rate_percent = {5.0, 100, "%", ""};
  return measures;
}

std::vector<CheckOutcome> outcomes(const scenario::VerdictOptions& rules, SessionStatus status,
                                   const metrics::SessionMeasures& measures) {
  std::vector<CheckOutcome> outcomes;
  for (const Check& check : evaluateChecks(rules, status, measures, {}))
    outcomes.push_back(check.outcome);
  return outcomes;
}

constexpr auto kPassed = CheckOutcome::kPassed;
constexpr auto kFailed = CheckOutcome::kFailed;
constexpr auto kError = CheckOutcome::kError;
constexpr auto kSkipped = CheckOutcome::kSkipped;
using Outcomes = std::vector<CheckOutcome>;

TEST(Verdict, WithoutRulesAllowsEveryEndOfItsOwn) {
  for (const SessionStatus status :
       {SessionStatus::kCompleted, SessionStatus::kBlocked, SessionStatus::kDeviated,
        SessionStatus::kTimedOut, SessionStatus::kCollided}) {
    const auto checks = evaluateChecks({}, status, goodMeasures(), {});
    EXPECT_TRUE(verdictOf(checks).passed) << traffic::toText(status);
  }
}

TEST(Verdict, LimitsCountAsMetAtTheLimit) {
  scenario::VerdictOptions rules;
  rules.minimum_route_completion = 80.0;
  rules.minimum_driving_score = 33.6;
  rules.maximum_ego_collisions = 1.0;
  rules.maximum_red_lights = 1.0;
  rules.maximum_stop_signs = 2.0;
  rules.maximum_outside_lanes_percent = 1.25;
  rules.maximum_cbv_off_road_percent = 5.0;
  rules.statuses = {"completed", "blocked"};
  EXPECT_EQ(outcomes(rules, SessionStatus::kBlocked, goodMeasures()), Outcomes(9, kPassed));
}

TEST(Verdict, NamesEveryRuleThatIsNotMet) {
  scenario::VerdictOptions rules;
  rules.minimum_route_completion = 90.0;
  rules.minimum_driving_score = 50.0;
  rules.maximum_ego_collisions = 0.0;
  rules.maximum_red_lights = 0.0;
  rules.maximum_stop_signs = 1.0;
  rules.maximum_outside_lanes_percent = 1.0;
  rules.maximum_cbv_off_road_percent = 4.0;
  rules.statuses = {"completed"};
  const auto checks = evaluateChecks(rules, SessionStatus::kTimedOut, goodMeasures(), {});
  const Verdict verdict = verdictOf(checks);
  EXPECT_FALSE(verdict.passed);
  ASSERT_EQ(verdict.failures.size(), 8u);
  EXPECT_EQ(verdict.failures[0], "the session ended with status 'timed_out'; allowed: completed");
  EXPECT_EQ(verdict.failures[1], "the ego completed 80.0 % of its route; at least 90 % is asked");
  EXPECT_EQ(verdict.failures[2],
            "the ego's driving score by bench2drive was 33.6 %; at least 50 % is asked");
  EXPECT_EQ(verdict.failures[3], "the ego had 1 collision; at most 0 allowed");
  EXPECT_EQ(verdict.failures[4], "red lights that the ego ran: 1; at most 0 allowed");
  EXPECT_EQ(verdict.failures[5], "stop signs that the ego did not obey: 2; at most 1 allowed");
  EXPECT_EQ(verdict.failures[6],
            "share of its way that the ego drove outside the lanes: 1.25 %; at most 1 % allowed");
  EXPECT_EQ(verdict.failures[7],
            "the CBVs were off the road 5.00 % of their time; at most 4 % allowed");
}

TEST(Verdict, AnAbsentInfractionIsSkippedWithItsReason) {
  metrics::SessionMeasures measures = goodMeasures();
  measures.infractions["red_lights"] = {std::nullopt, 0, "", "no road network was given"};
  scenario::VerdictOptions rules;
  rules.maximum_red_lights = 0.0;
  for (const Check& check : evaluateChecks(rules, SessionStatus::kCompleted, measures, {})) {
    if (check.name != "red_lights") continue;
    EXPECT_EQ(check.outcome, kSkipped);
    EXPECT_EQ(check.text, "red_lights of the ego is not defined: no road network was given");
    return;
  }
  FAIL() << "no check of red lights";
}

TEST(Verdict, AnAbsentRateIsSkippedNotPassed) {
  metrics::SessionMeasures measures = goodMeasures();
  measures.cbv_off_road_rate_percent = {std::nullopt, 0, "%", "no CBV was driven"};
  scenario::VerdictOptions rules;
  rules.maximum_cbv_off_road_percent = 0.0;
  EXPECT_EQ(outcomes(rules, SessionStatus::kCompleted, measures).back(), kSkipped);
  EXPECT_TRUE(verdictOf(evaluateChecks(rules, SessionStatus::kCompleted, measures, {})).passed);
}

TEST(Verdict, ABrokenSessionIsAnErrorAndNotJudged) {
  scenario::VerdictOptions rules;
  rules.minimum_route_completion = 100.0;
  rules.statuses = {"error", "interrupted"};
  for (const SessionStatus status :
       {SessionStatus::kError, SessionStatus::kInterrupted, SessionStatus::kRunning}) {
    EXPECT_EQ(outcomes(rules, status, goodMeasures()),
              Outcomes({kError, kSkipped, kSkipped, kSkipped, kSkipped, kSkipped, kSkipped,
                        kSkipped, kSkipped}));
  }
  const auto checks =
      evaluateChecks(rules, SessionStatus::kError, {}, {{3, "simulator", "SUMO was lost"}});
  const Verdict verdict = verdictOf(checks);
  EXPECT_FALSE(verdict.passed);
  ASSERT_EQ(verdict.failures.size(), 1u);
  EXPECT_EQ(verdict.failures[0], "the session ended with status 'error': simulator: SUMO was lost");
}

}  // namespace
}  // namespace cdiff::report
