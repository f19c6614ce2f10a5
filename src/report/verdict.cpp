// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/verdict.h"

#include <algorithm>
#include <utility>

#include "e2e_cdiff/core/text.h"

namespace cdiff::report {
namespace {

using traffic::SessionStatus;

constexpr double kNoLimit = 1e9;  // default of the rules on counts

Check judged(const std::string& name, bool met, const std::string& text) {
  return {name, met ? CheckOutcome::kPassed : CheckOutcome::kFailed, text};
}

std::string quotedStatus(SessionStatus status) {
  return "'" + std::string(traffic::toText(status)) + "'";
}

Check sessionCheck(SessionStatus status, const std::vector<traffic::Fault>& faults) {
  const std::string text = "the session ended with status " + quotedStatus(status);
  if (endedByItself(status)) return {"session", CheckOutcome::kPassed, text};
  if (faults.empty()) return {"session", CheckOutcome::kError, text};
  return {"session", CheckOutcome::kError,
          text + ": " + faults.back().source + ": " + faults.back().text};
}

Check statusCheck(const scenario::VerdictOptions& rules, SessionStatus status) {
  const auto& allowed = rules.statuses;
  const bool met = allowed.empty() || std::find(allowed.begin(), allowed.end(),
                                                traffic::toText(status)) != allowed.end();
  const std::string asked =
      allowed.empty() ? "any but error and interrupted" : core::joinText(allowed, ", ");
  return judged("status", met,
                "the session ended with status " + quotedStatus(status) + "; allowed: " + asked);
}

Check completionCheck(const scenario::VerdictOptions& rules, double percent) {
  return judged("route_completion", percent >= rules.minimum_route_completion,
                "the ego completed " + core::formatFixed(percent, 1) +
                    " % of its route; at least " +
                    core::formatNumber(rules.minimum_route_completion) + " % is asked");
}

Check scoreCheck(const scenario::VerdictOptions& rules, const metrics::SessionMeasures& measures) {
  return judged("driving_score", measures.driving_score >= rules.minimum_driving_score,
                "the ego's driving score by " + measures.protocol + " was " +
                    core::formatFixed(measures.driving_score, 1) + " %; at least " +
                    core::formatNumber(rules.minimum_driving_score) + " % is asked");
}

Check collisionCheck(const scenario::VerdictOptions& rules, std::size_t collisions) {
  const double limit = rules.maximum_ego_collisions;
  const std::string found = "the ego had " + std::to_string(collisions) +
                            (collisions == 1 ? " collision" : " collisions");
  return judged("ego_collisions", static_cast<double>(collisions) <= limit,
                limit >= kNoLimit ? found + "; no limit is set"
                                  : found + "; at most " + core::formatNumber(limit) + " allowed");
}

/// A limit on one of the ego's infractions.
struct InfractionRule {
  std::string infraction;
  std::string text;  ///< what is counted, in a sentence
  double limit;
  int decimals;
};

Check infractionCheck(const InfractionRule& rule, const metrics::SessionMeasures& measures) {
  const auto found = measures.infractions.find(rule.infraction);
  if (found == measures.infractions.end() || !found->second.value) {
    const std::string reason =
        found == measures.infractions.end() ? "it was not measured" : found->second.reason;
    return {rule.infraction, CheckOutcome::kSkipped,
            rule.infraction + " of the ego is not defined: " + reason};
  }
  const double value = *found->second.value;
  const std::string unit = found->second.unit.empty() ? "" : " " + found->second.unit;
  const std::string text = rule.text + ": " + core::formatFixed(value, rule.decimals) + unit;
  return judged(rule.infraction, value <= rule.limit,
                rule.limit >= kNoLimit
                    ? text + "; no limit is set"
                    : text + "; at most " + core::formatNumber(rule.limit) + unit + " allowed");
}

std::vector<Check> infractionChecks(const scenario::VerdictOptions& rules,
                                    const metrics::SessionMeasures& measures) {
  const InfractionRule all[] = {
      {"red_lights", "red lights that the ego ran", rules.maximum_red_lights, 0},
      {"stop_signs", "stop signs that the ego did not obey", rules.maximum_stop_signs, 0},
      {"outside_lanes_percent", "share of its way that the ego drove outside the lanes",
       rules.maximum_outside_lanes_percent, 2}};
  std::vector<Check> checks;
  for (const InfractionRule& rule : all) checks.push_back(infractionCheck(rule, measures));
  return checks;
}

Check offRoadCheck(const scenario::VerdictOptions& rules, const metrics::Measure& rate) {
  if (!rate.value) {
    return {"cbv_off_road", CheckOutcome::kSkipped,
            "the off-road rate of the CBVs is not defined: " + rate.reason};
  }
  return judged("cbv_off_road", *rate.value <= rules.maximum_cbv_off_road_percent,
                "the CBVs were off the road " + core::formatFixed(*rate.value, 2) +
                    " % of their time; at most " +
                    core::formatNumber(rules.maximum_cbv_off_road_percent) + " % allowed");
}

}  // namespace

const char* toText(CheckOutcome outcome) {
  switch (outcome) {
    case CheckOutcome::kPassed:
      return "passed";
    case CheckOutcome::kFailed:
      return "failed";
    case CheckOutcome::kError:
      return "error";
    case CheckOutcome::kSkipped:
      return "skipped";
  }
  return "error";
}

bool endedByItself(SessionStatus status) {
  return status != SessionStatus::kError && status != SessionStatus::kInterrupted &&
         status != SessionStatus::kRunning;
}

std::vector<Check> evaluateChecks(const scenario::VerdictOptions& rules, SessionStatus status,
                                  const metrics::SessionMeasures& measures,
                                  const std::vector<traffic::Fault>& faults) {
  std::vector<Check> checks = {sessionCheck(status, faults), statusCheck(rules, status),
                               completionCheck(rules, measures.route_completion_percent),
                               scoreCheck(rules, measures),
                               collisionCheck(rules, measures.ego_collisions)};
  for (Check& check : infractionChecks(rules, measures)) checks.push_back(std::move(check));
  checks.push_back(offRoadCheck(rules, measures.cbv_off_road_rate_percent));
  if (endedByItself(status)) return checks;
  for (std::size_t i = 1; i < checks.size(); ++i) {
    checks[i].outcome = CheckOutcome::kSkipped;
    checks[i].text = "not judged: the session ended with status " + quotedStatus(status);
  }
  return checks;
}

Verdict verdictOf(const std::vector<Check>& checks) {
  Verdict verdict;
  for (const Check& check : checks) {
    const bool met =
        check.outcome == CheckOutcome::kPassed || check.outcome == CheckOutcome::kSkipped;
    if (!met) verdict.failures.push_back(check.text);
  }
  verdict.passed = verdict.failures.empty();
  return verdict;
}

}  // namespace cdiff::report
