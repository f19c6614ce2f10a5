// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/html_report.h"

#include <algorithm>

#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/report/approach_section.h"
#include "e2e_cdiff/report/driving_section.h"
#include "e2e_cdiff/report/guidance_section.h"
#include "e2e_cdiff/report/markup.h"
#include "e2e_cdiff/report/page_head.h"
#include "e2e_cdiff/report/playback.h"
#include "e2e_cdiff/report/report_style.h"
#include "e2e_cdiff/report/report_tables.h"
#include "e2e_cdiff/report/session_charts.h"
#include "e2e_cdiff/report/session_story.h"
#include "e2e_cdiff/report/stage.h"

namespace cdiff::report {
namespace {

std::string head(const SessionResult& result) {
  return pageHead(result.setup.options().name + " – session report");
}

/// What the banner says first.
const char* headlineOf(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed:
      return "Passed";
    case Outcome::kStruck:
      return "Struck: the ego met its rules, but was hit";
    case Outcome::kFailed:
      return "Failed";
    case Outcome::kNotJudged:
      return "Not judged";
    case Outcome::kInterrupted:
      return "Interrupted: the session was not judged";
    case Outcome::kError:
      break;
  }
  return "Error: the session could not be judged";
}

/// Of a session that passed.
std::string metText(const SessionResult& result) {
  const auto& checks = result.verdict.checks;
  const bool all = std::none_of(checks.begin(), checks.end(), [](const Check& check) {
    return check.outcome == CheckOutcome::kSkipped;
  });
  return "the session ended with status '" + std::string(traffic::toText(result.status)) +
         (all ? "' and met every rule of the scenario"
              : "' and met every rule of the scenario that applies");
}

std::string banner(const SessionResult& result) {
  const scenario::ScenarioOptions& options = result.setup.options();
  const Outcome outcome = result.verdict.outcome;
  std::string content;
  for (const std::string& reason : result.verdict.reasons)
    content += "<p>" + escapeMarkup(reason) + "</p>";
  if (outcome == Outcome::kPassed) content += "<p>" + metText(result) + "</p>";
  content += "<p class=\"story\">";
  for (const std::string& sentence : sessionStory(result)) content += escapeMarkup(sentence) + " ";
  return "<header>\n<h1>" + escapeMarkup(options.name) + "</h1>\n<p class=\"sub\">" +
         escapeMarkup(options.mode) + " · seed " + std::to_string(options.seed) + " · ego " +
         escapeMarkup(options.ego_planner) + " · CBV " + escapeMarkup(options.cbv_planner) +
         "</p>\n" + pageBanner(outcome, headlineOf(outcome), content + "</p>") + "</header>\n";
}

/// Below the verdict: a session that late answers went into cannot be repeated.
std::string lateBanner(const SessionResult& result) {
  const std::string text = latenessText(result.late);
  if (text.empty()) return "";
  return "<div class=\"late\" role=\"note\"><strong>Answers came late: </strong>" +
         escapeMarkup(text) + ". Another run will differ.</div>\n";
}

std::string figure(const std::string& name, const std::string& value, const std::string& unit,
                   const std::string& note) {
  return "<div class=\"figure\"><span class=\"name\">" + name + "</span><span class=\"value\">" +
         value + (unit.empty() ? "" : " <small>" + escapeMarkup(unit) + "</small>") +
         "</span><span class=\"under\">" + escapeMarkup(note) + "</span></div>\n";
}

std::string figure(const std::string& name, const metrics::Measure& measure, int decimals) {
  if (!measure.value) return figure(name, "–", "", measure.reason);
  return figure(name, core::formatFixed(*measure.value, decimals), measure.unit,
                "n = " + std::to_string(measure.n));
}

std::string figures(const SessionResult& result) {
  const metrics::SessionMeasures& measures = result.measures;
  const std::string pace =
      result.wall_seconds > 0.0
          ? core::formatFixed(result.simulated_seconds / result.wall_seconds, 1) +
                " times real time"
          : "wall time not measured";
  return "<div class=\"figures\">\n" +
         figure("Route completion", core::formatFixed(measures.route_completion_percent, 1), "%",
                traffic::toText(result.status)) +
         figure("Driving score", core::formatFixed(measures.driving_score, 1), "",
                "of 100, by " + measures.protocol) +
         figure("Ego collisions", std::to_string(measures.ego_collisions), "",
                std::to_string(measures.contactsAtFault()) + " its fault, " +
                    std::to_string(measures.cbv_ego_collisions) + " with CBVs") +
         figure("CBVs", std::to_string(measures.cbv_count), "",
                std::to_string(measures.cbv_decisions) + " decisions, " +
                    core::formatFixed(measures.cbv_distance_m, 0) + " m") +
         figure("CBV collisions", std::to_string(measures.cbv_collisions), "",
                measures.collisions_per_km.value
                    ? core::formatFixed(*measures.collisions_per_km.value, 2) + " per km"
                    : measures.collisions_per_km.reason) +
         figure("CBV off-road rate", measures.cbv_off_road_rate_percent, 2) +
         figure("2D-TTC, minimum", measures.ttc_2d.minimum, 2) +
         figure("2D-TTC, mean", measures.ttc_2d.mean, 2) +
         figure("Simulated", core::formatFixed(result.simulated_seconds, 1), "s", pace) +
         "</div>\n";
}

std::string planSection(const PlanLog& plans) {
  if (plans.empty()) return "<p class=\"note\">No plan of a CBV was shown.</p>\n";
  return planTable(plans) +
         "<p class=\"note\">Distance between where a decision's plan put the CBV and where it was, "
         "1, 2 and 3 s later, over all decisions whose plan and drive reach that far. State "
         "mismatch: "
         "largest distance between planned positions and what the vehicle dynamics makes of the "
         "planned actions.</p>\n";
}

std::string configuration(const SessionResult& result) {
  return originTable(result) + "<details><summary>Resolved scenario</summary>\n<pre>" +
         escapeMarkup(core::dumpOptions(result.setup.options())) + "</pre>\n</details>\n";
}

}  // namespace

std::string htmlReport(const SessionResult& result) {
  const MapCanvas canvas(sessionRegion(result));
  return head(result) + "<body>\n<main>\n" + banner(result) + lateBanner(result) + figures(result) +
         pageSection("What happened", stageHtml(result, canvas)) +
         pageSection("Over time", sessionCharts(result)) +
         pageSection("Distributions", drivingSection(result)) +
         pageSection("Closest approach", approachSection(result)) +
         pageSection("Plans against what was driven", planSection(result.plans)) +
         pageSection("Guidance", guidanceSection(result)) +
         pageSection("Rules", ruleTable(result)) +
         pageSection("Metrics", metricTable(result.measures)) +
         pageSection("Infractions of the ego", infractionTable(result.measures)) +
         pageSection("Critical background vehicles", selectionTable(result)) +
         pageSection("Why others were no CBVs", rejectionTable(result.cbv)) +
         pageSection("Contacts", contactTable(result)) +
         pageSection("Planner latency", latencyTable(result.latencies)) +
         pageSection("Late answers", lateTable(result.late)) +
         pageSection("Faults", faultTable(result.faults)) +
         pageSection("Configuration and versions", configuration(result)) +
         "</main>\n<script type=\"application/json\" id=\"playback\">" +
         playbackJson(result, canvas) + "</script>\n<script>" + kReportScript +
         "</script>\n</body>\n</html>\n";
}

}  // namespace cdiff::report
