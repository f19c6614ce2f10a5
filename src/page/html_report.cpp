// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/html_report.h"

#include <algorithm>

#include "core/text.h"
#include "metrics/known_measures.h"
#include "page/approach_section.h"
#include "page/driving_section.h"
#include "page/guidance_section.h"
#include "page/page_parts.h"
#include "page/pictures/session_charts.h"
#include "page/playback.h"
#include "page/player_parts.h"
#include "page/report_tables.h"
#include "record/session_text.h"
#include "session/session_request.h"

namespace cdiff::page {
namespace {

/// What the banner says first.
const char* headlineOf(record::Outcome outcome) {
  switch (outcome) {
    case record::Outcome::kPassed:
      return "Passed";
    case record::Outcome::kStruck:
      return "Struck: the ego met its rules, but not without contact";
    case record::Outcome::kFailed:
      return "Failed";
    case record::Outcome::kNotJudged:
      return "Not judged";
    case record::Outcome::kInterrupted:
      return "Interrupted: the session was not judged";
    case record::Outcome::kError:
      break;
  }
  return "Error: the session could not be judged";
}

/// Of a session that passed.
std::string metText(const record::SessionResult& result) {
  const auto& checks = result.verdict.checks;
  const bool all = std::none_of(checks.begin(), checks.end(), [](const record::Check& check) {
    return check.outcome == record::CheckOutcome::kSkipped;
  });
  return "the session ended with status '" + std::string(traffic::toText(result.status)) +
         (all ? "' and met every rule of the scenario"
              : "' and met every rule of the scenario that applies");
}

/// All contacts of the ego, folded, where the reasons name some of them alone.
Markup foldedContacts(const std::vector<metrics::EgoContact>& contacts) {
  if (contacts.size() <= record::kShownContacts) return {};
  Markup items;
  for (const metrics::EgoContact& contact : contacts)
    items += element("li", {}, linkedTimes(record::contactText(contact))) + "\n";
  return pageFold("All " + std::to_string(contacts.size()) + " contacts of the ego",
                  element("ol", {}, "\n" + items));
}

Markup banner(const record::SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  const record::Outcome outcome = result.verdict.outcome;
  Markup content;
  for (const std::string& reason : result.verdict.reasons)
    content += element("p", {}, linkedTimes(reason));
  if (outcome == record::Outcome::kPassed) content += element("p", {}, metText(result));
  const bool untested = !record::untestedText(result).empty();
  const std::string headline =
      headlineOf(outcome) + std::string(untested ? " \u00b7 0 CBVs: nothing was tested" : "");
  std::string story;
  for (const std::string& sentence : record::sessionStory(result)) story += sentence + " ";
  content += element("p", {{"class", "story"}}, linkedTimes(story)) +
             foldedContacts(result.measures.ego_contacts);
  return pageHeader(options.name,
                    options.mode + " · seed " + std::to_string(options.seed) + " · ego " +
                        options.ego_planner + " · CBV " + options.cbv_planner + " · method " +
                        session::methodText(session::methodOf(options)),
                    pageBanner(outcome, headline, content));
}

/// Below the verdict: a session that late answers went into cannot be repeated.
Markup lateBanner(const record::SessionResult& result) {
  const std::string text = record::latenessText(result.late);
  if (text.empty()) return {};
  return element(
             "div", {{"class", "late"}, {"role", "note"}},
             element("strong", {}, "Answers came late: ") + text + ". Another run will differ.") +
         "\n";
}

Markup tile(const std::string& name, const std::string& value, const std::string& unit,
            const std::string& note) {
  const Markup number = unit.empty() ? Markup(value) : value + " " + element("small", {}, unit);
  return element("div", {{"class", "figure"}},
                 element("span", {{"class", "name"}}, name) +
                     element("span", {{"class", "value"}}, number) +
                     element("span", {{"class", "under"}}, note)) +
         "\n";
}

Markup tile(const metrics::MeasureDefinition& definition, const metrics::SessionMeasures& measures,
            const std::string& note = "") {
  constexpr int kDecimals = 2;
  const metrics::Measure measure = measures.at(definition);
  const std::string more = note.empty() ? "" : "; " + note;
  if (!measure.value) return tile(definition.label, "–", "", measure.reason + more);
  return tile(definition.label, core::formatFixed(*measure.value, kDecimals), measure.unit,
              "n = " + std::to_string(measure.n) + more);
}

/// A time to collision with CBVs; that with all traffic below it.
Markup ttcTile(const metrics::MeasureDefinition& with_cbvs,
               const metrics::MeasureDefinition& with_all,
               const metrics::SessionMeasures& measures) {
  const metrics::Measure all = measures.at(with_all);
  return tile(
      with_cbvs, measures,
      "with all traffic " + (all.value ? core::formatFixed(*all.value, 2) + " " + all.unit : "–"));
}

std::string paceText(const record::SessionResult& result) {
  if (!(result.wall_seconds > 0.0)) return "wall time not measured";
  return core::formatFixed(result.simulated_seconds / result.wall_seconds, 1) + " times real time";
}

Markup egoTiles(const record::SessionResult& result) {
  namespace known = metrics::known;
  const metrics::SessionMeasures& measures = result.measures;
  const std::size_t with_cbvs = measures.count(known::kCbvEgoCollisions);
  const std::size_t all = std::max(with_cbvs, measures.count(known::kEgoCollisions));
  const session::ScenarioOptions& options = result.setup.options();
  const bool excuses = options.verdict.excusesUnavoidable(options.fiercestMode());
  const auto excused = std::count_if(
      measures.ego_contacts.begin(), measures.ego_contacts.end(), [&](const auto& contact) {
        return record::blameOf(contact, excuses) == record::Blame::kExcused;
      });
  return tile(known::kRouteCompletion.label,
              core::formatFixed(measures.number(known::kRouteCompletion), 1), "%",
              traffic::toText(result.status)) +
         tile(known::kDrivingScore.label,
              core::formatFixed(measures.number(known::kDrivingScore), 1), "",
              "of 100, by " + measures.protocol) +
         tile(known::kEgoCollisions.label, std::to_string(all), "",
              std::to_string(with_cbvs) + " with CBVs + " + std::to_string(all - with_cbvs) +
                  " with background, " + std::to_string(measures.count(known::kContactsAtFault)) +
                  " its fault" + (excused > 0 ? " (" + std::to_string(excused) + " excused)" : "") +
                  ", " + std::to_string(measures.count(known::kEgoBrakingAvoids)) +
                  " avoided by braking");
}

Markup cbvTiles(const metrics::SessionMeasures& measures) {
  namespace known = metrics::known;
  const metrics::Measure rate = measures.at(known::kCollisionsPerKm);
  return tile(known::kCbvCount.label, std::to_string(measures.count(known::kCbvCount)), "",
              std::to_string(measures.count(known::kCbvDecisions)) + " decisions, " +
                  core::formatFixed(measures.number(known::kCbvDistance), 0) + " m") +
         tile(known::kCbvCollisions.label, std::to_string(measures.count(known::kCbvCollisions)),
              "", rate.value ? core::formatFixed(*rate.value, 2) + " per km" : rate.reason) +
         tile(known::kCbvOffRoad, measures);
}

Markup tiles(const record::SessionResult& result) {
  namespace known = metrics::known;
  const metrics::SessionMeasures& measures = result.measures;
  const Markup content =
      egoTiles(result) + cbvTiles(measures) +
      ttcTile(known::kTtcCbvMinimum, known::kTtcMinimum, measures) +
      ttcTile(known::kTtcCbvMean, known::kTtcMean, measures) +
      tile("Simulated", core::formatFixed(result.simulated_seconds, 1), "s", paceText(result));
  return element("div", {{"class", "figures"}}, "\n" + content) + "\n";
}

Markup planSection(const record::PlanLog& plans) {
  if (plans.empty()) return pageNote("No plan of a CBV was shown.");
  return planTable(plans) +
         pageNote(
             "Distance between centers, of where a decision's plan put the CBV and where it was, "
             "1, 2 and 3 s "
             "later, over all decisions whose plan and drive reach that far. State mismatch: "
             "largest distance between planned positions and what the vehicle dynamics makes of "
             "the planned actions.");
}

Markup configuration(const record::SessionResult& result) {
  const Markup content = element("summary", {}, "Resolved scenario") + "\n" +
                         element("pre", {}, core::dumpOptions(result.setup.options())) + "\n";
  return originTable(result) + element("details", {}, content) + "\n";
}

/// What other drivers would have come to; `cdiff what_if` fills it when the session is over.
Markup whatIf(const std::map<std::string, std::string>& answers) {
  Markup rows;
  for (const auto& [address, text] : answers)
    rows += element("li", {}, element("a", {{"href", address}}, text)) + "\n";
  const Markup list = answers.empty() ? Markup() : element("ul", {}, "\n" + rows);
  return element("div", {{"id", "what-if"}}, list) + "\n";
}

std::vector<PageSection> sections(const record::SessionResult& result, const MapCanvas& canvas) {
  return {{"What happened", stageHtml(result, canvas)},
          {"Over time", sessionCharts(result)},
          {"Distributions", drivingSection(result)},
          {"Closest approach", approachSection(result)},
          {"Plans against what was driven", planSection(result.plans)},
          {"Guidance", guidanceSection(result)},
          {"Rules", ruleTable(result)},
          {"Metrics", metricTables(result.measures)},
          {"Infractions of the ego", infractionTable(result.measures)},
          {"Critical background vehicles", selectionTable(result)},
          {"Why others were no CBVs", rejectionTable(result.cbv)},
          {"Contacts", contactTable(result) + whatIf({})},
          {"Steering", steeringTable(result)},
          {"Planner latency", latencyTable(result.latencies)},
          {"Late answers", lateTable(result.late)},
          {"Faults", faultTable(result.faults)},
          {"Configuration and versions", configuration(result)}};
}

}  // namespace

std::string htmlReport(const record::SessionResult& result) {
  const MapCanvas canvas(sessionRegion(result));
  const std::vector<PageSection> parts = sections(result, canvas);
  return pageDocument(result.setup.options().name + " – session report", {},
                      banner(result) + lateBanner(result) + tiles(result) + pageContents(parts) +
                          pageSections(parts),
                      core::jsonElement("playback", playbackJson(result, canvas)) +
                          core::scriptElement(kPlayerScript) + core::scriptElement(kReportScript));
}

std::optional<std::string> withWhatIf(const std::string& page,
                                      const std::map<std::string, std::string>& answers) {
  const std::string begin = "<div id=\"what-if\">";
  const std::string end = "</div>\n";
  const std::size_t from = page.find(begin);
  const std::size_t to = from == std::string::npos ? from : page.find(end, from);
  if (to == std::string::npos) return std::nullopt;
  return page.substr(0, from) + whatIf(answers).str() + page.substr(to + end.size());
}

}  // namespace cdiff::page
