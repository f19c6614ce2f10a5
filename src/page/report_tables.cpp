// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/report_tables.h"

#include <algorithm>

#include "core/text.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"
#include "page/page_parts.h"
#include "record/repeated_faults.h"
#include "record/session_text.h"
#include "record/session_yaml.h"
#include "record/summary.h"

namespace cdiff::page {
namespace {

constexpr std::size_t kMostFaults = 200;  // rows shown

std::string fixed(double value, int decimals) { return core::formatFixed(value, decimals); }

std::string fixedOrDash(const std::optional<double>& value, int decimals) {
  return value ? fixed(*value, decimals) : "–";
}

/// At most three ids, highest count first.
std::vector<std::string> mostOften(const std::pmr::map<std::string, std::size_t>& counts) {
  std::vector<std::pair<std::string, std::size_t>> rows(counts.begin(), counts.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& left, const auto& right) { return left.second > right.second; });
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, rows.size()); ++i) {
    ids.push_back(rows[i].first + " (" + std::to_string(rows[i].second) + ")");
  }
  return ids;
}

/// Why a measure is absent, how its samples were taken, and what it is compared with.
std::string noteOf(const metrics::Measure& measure) {
  if (measure.target.empty()) return measure.reason;
  return "against " + measure.target + (measure.reason.empty() ? "" : "; " + measure.reason);
}

void measureRow(HtmlTable& table, const Markup& name, const metrics::MeasureDefinition& definition,
                const metrics::SessionMeasures& measures) {
  const metrics::Measure measure = measures.at(definition);
  table.row(
      {name, measure.value ? fixed(*measure.value, definition.decimals) : "–",
       measure.unit == "count" ? "" : measure.unit, std::to_string(measure.n), noteOf(measure)},
      measure.value ? "" : "absent");
}

}  // namespace

Markup ruleTable(const record::SessionResult& result) {
  HtmlTable table({"Rule", "Outcome", "Found"});
  for (const record::Check& check : result.verdict.checks) {
    table.row({check.name, record::toText(check.outcome), linkedTimes(check.text)},
              record::toText(check.outcome));
  }
  return table.html();
}

namespace {

/// The heading under which a measure stands.
std::string groupOf(const metrics::MeasureDefinition& definition) {
  const std::vector<std::string> keys = core::splitText(definition.place, '/');
  if (keys.size() > 1 && keys[0] == "metrics" && keys[1] == "rift_compat")
    return "By RIFT's definitions";
  switch (definition.subject) {
    case metrics::Subject::kEgo:
      return "The ego";
    case metrics::Subject::kCbvs:
      return "CBVs";
    case metrics::Subject::kEgoAndOthers:
      break;
  }
  return "The ego and others";
}

Markup foldedDefinition(const metrics::MeasureDefinition& definition) {
  const std::string key = std::string(definition.name) + ": ";
  return pageFold(definition.label, element("p", {}, key + definition.definition), "definition");
}

}  // namespace

Markup metricTables(const metrics::SessionMeasures& measures) {
  Markup html = pageNote("A click on a metric opens its definition.");
  for (const std::string group :
       {"The ego", "The ego and others", "CBVs", "By RIFT's definitions"}) {
    HtmlTable table({"Metric", "#Value", "Unit", "#n", "Note"});
    for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
      if (groupOf(definition) == group)
        measureRow(table, foldedDefinition(definition), definition, measures);
    }
    html += element("h3", {}, group) + "\n" + table.html();
  }
  return html;
}

Markup infractionTable(const metrics::SessionMeasures& measures) {
  HtmlTable table({"Infraction by " + measures.protocol, "#Found", "Unit", "#n", "Note"});
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const std::vector<std::string> keys = core::splitText(definition.place, '/');
    if (keys.size() == 3 && keys[1] == "infractions")
      measureRow(table, keys.back(), definition, measures);
  }
  measureRow(table, "Penalty", metrics::known::kPenalty, measures);
  return table.html();
}

Markup selectionTable(const record::SessionResult& result) {
  if (result.cbv.records().empty()) {
    return pageNote("No vehicle was selected as CBV.");
  }
  HtmlTable table({"Vehicle", "#Slot", "#Selected [s]", "#Score",
                   "#Ego to conflict, along lanes [m]", "#CBV to conflict, along lanes [m]",
                   "#Arrival gap [s]", "Place", "#Decisions", "#Released [s]", "Why",
                   "#Route driven [%]", "Conflict point"});
  const double step = result.setup.options().simulation_step;
  const auto time = [step](std::uint64_t tick) {
    return timeLink(static_cast<double>(tick) * step);
  };
  for (const record::CbvRecord& record : result.cbv.records()) {
    const cbv::ConflictPoint& conflict = record.conflict_point;
    const bool junction = record::atOrBeyondFirstJunction(conflict, result.setup.egoRoute());
    const std::optional<std::string> other = record::contactPartner(record, result);
    table.row({record.vehicle_id, std::to_string(record.slot), time(record.selected_tick),
               fixed(record.interaction_score, 3), fixed(conflict.ego_distance, 1),
               fixed(conflict.cbv_distance, 1), fixed(conflict.arrivalTimeGap(), 2),
               junction ? "junction or beyond" : "before junction",
               std::to_string(record.decisions_driven),
               record.released_tick ? time(*record.released_tick) : "–",
               record::releaseText(record.release_reason) + (other ? " (" + *other + ")" : ""),
               fixed(record.routeCompletionPercent(), 1),
               record.conflict_point_passed ? "passed" : "not reached"});
  }
  return table.html();
}

Markup planTable(const record::PlanLog& plans) {
  HtmlTable table({"CBV", "#Plans", "#After 1\u00a0s: mean [m]", "#95th percentile [m]",
                   "#After 2\u00a0s: mean [m]", "#95th percentile [m]", "#After 3\u00a0s: mean [m]",
                   "#95th percentile [m]", "#State mismatch: mean [m]", "#95th percentile [m]",
                   "#maximum [m]"});
  for (const record::VehiclePlans& vehicle : plans.vehicles()) {
    if (vehicle.plans.empty()) continue;
    std::vector<Markup> cells = {vehicle.vehicle_id, std::to_string(vehicle.plans.size())};
    for (const double seconds : {1.0, 2.0, 3.0}) {
      const record::SampleSummary summary =
          record::summaryOf(plans.displacements(vehicle, seconds));
      cells.push_back(fixedOrDash(summary.mean, 2));
      cells.push_back(fixedOrDash(summary.percentile_95, 2));
    }
    const record::SampleSummary mismatch = record::mismatchSummary(vehicle);
    cells.push_back(fixedOrDash(mismatch.mean, 3));
    cells.push_back(fixedOrDash(mismatch.percentile_95, 3));
    cells.push_back(fixedOrDash(mismatch.maximum, 3));
    table.row(cells);
  }
  return table.html();
}

Markup guidanceTable(const record::GuidanceLog& log) {
  HtmlTable table({"Objective", "#Weight", "#Mean value", "#Mean gradient norm",
                   "#Steps with the gradient capped [%]", "#Steps left out", "#Decisions"});
  for (const record::GuidanceSeries& series : log.series()) {
    const record::ObjectiveSummary summary = record::summaryOf(series);
    std::optional<double> capped = summary.capped_share;
    if (capped) *capped *= 100.0;
    table.row({series.objective, fixedOrDash(summary.weight, 3), fixedOrDash(summary.value, 4),
               fixedOrDash(summary.gradient_norm, 4), fixedOrDash(capped, 1),
               std::to_string(summary.dropped), std::to_string(summary.n)});
  }
  return table.html();
}

Markup challengeTable(const record::ChallengeCounts& counts) {
  HtmlTable table({"Mode challenging", "Reason", "#Number"});
  table.row({"attacks that a careful driver can answer", "", std::to_string(counts.attacks)});
  table.row({"decisions under attack", "", std::to_string(counts.attacking)});
  for (const auto& [reason, count] : counts.withdrawn)
    table.row({"decisions withdrawn", reason, std::to_string(count)});
  for (const auto& [reason, count] : counts.refused)
    table.row({"plans refused", reason, std::to_string(count)});
  return table.html();
}

Markup rejectionTable(const record::CbvLog& cbv) {
  if (cbv.rejected().empty()) return pageNote("No candidate was rejected.");
  std::vector<std::pair<std::string, std::size_t>> rows(cbv.rejected().begin(),
                                                        cbv.rejected().end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& left, const auto& right) { return left.second > right.second; });
  HtmlTable table({"Reason", "#Times, over all decisions", "#Vehicles", "Most often", "Meaning"});
  for (const auto& [reason, count] : rows) {
    const auto& vehicles = cbv.rejectedVehicles().at(reason);
    table.row({reason, std::to_string(count), std::to_string(vehicles.size()),
               core::joinText(mostOften(vehicles), ", "), record::rejectionText(reason)});
  }
  return table.html();
}

namespace {

const char* blameText(record::Blame blame) {
  if (blame == record::Blame::kNone) return "no";
  return blame == record::Blame::kExcused ? "yes, excused" : "yes";
}

}  // namespace

Markup contactTable(const record::SessionResult& result) {
  const auto& all = result.timeline.contacts();
  if (all.empty()) return pageNote("No vehicles touched.");
  HtmlTable table({"#Time [s]", "Vehicle", "Vehicle", "Ego at fault", "Why", "#Ego [m/s]",
                   "#Other [m/s]", "Braking avoids it"});
  auto own = result.measures.ego_contacts.begin();  // in the order of `all`
  const session::ScenarioOptions& options = result.setup.options();
  const bool excuses = options.verdict.excusesUnavoidable(options.fiercestMode());
  for (const record::TimelineContact& contact : all) {
    std::vector<Markup> cells = {timeLink(contact.time), contact.first, contact.second};
    const bool ego = own != result.measures.ego_contacts.end() &&
                     (contact.first == own->partner || contact.second == own->partner) &&
                     contact.time == own->seconds;
    if (ego) {
      cells.insert(cells.end(), {blameText(record::blameOf(*own, excuses)), own->reason,
                                 fixed(own->ego_speed, 1), fixed(own->partner_speed, 1),
                                 own->braking_avoids ? "yes" : "no"});
      ++own;
    } else {
      cells.insert(cells.end(), {"–", "", "", "", ""});
    }
    table.row(cells);
  }
  return table.html();
}

Markup latencyTable(const std::map<std::string, record::LatencySummary>& latencies) {
  if (latencies.empty()) return pageNote("No planner was timed.");
  HtmlTable table(
      {"Planner", "#Median [ms]", "#95th percentile [ms]", "#Maximum [ms]", "#Decisions"});
  for (const auto& [planner, summary] : latencies) {
    table.row({planner, fixed(summary.median, 2), fixed(summary.percentile_95, 2),
               fixed(summary.maximum, 2), std::to_string(summary.n)});
  }
  return table.html();
}

Markup lateTable(const std::map<std::string, record::LateCounts>& late) {
  if (late.empty()) return pageNote("The session waited for every answer.");
  HtmlTable table({"Planner", "#Asked", "#Late", "#Never came", "#Drove on by its plan",
                   "#Braked fully", "#Not taken over yet", "#Lateness: median [s]",
                   "#95th percentile [s]", "#Maximum [s]"});
  for (const auto& [planner, counts] : late) {
    table.row({planner, std::to_string(counts.asked), std::to_string(counts.late),
               std::to_string(counts.missing), std::to_string(counts.by_plan),
               std::to_string(counts.by_full_brake), std::to_string(counts.not_driven),
               fixed(counts.median, 3), fixed(counts.percentile_95, 3), fixed(counts.maximum, 3)});
  }
  return table.html();
}

Markup steeringTable(const record::SessionResult& result) {
  if (result.steering.records().empty()) return pageNote("Nobody steered the session.");
  HtmlTable table({"#Tick", "#Time [s]", "By", "What", "Before", "After", "Note"});
  const double step = result.setup.options().simulation_step;
  for (const session::SteeringRecord& record : result.steering.records()) {
    const auto& [by, what, before, after] = record.change;
    table.row({std::to_string(record.tick), fixed(static_cast<double>(record.tick) * step, 2), by,
               what, before, after,
               record.refused.empty() ? "" : "refused: " + record::rejectionText(record.refused)});
  }
  return table.html();
}

Markup faultTable(const std::vector<traffic::Fault>& all) {
  const std::vector<record::RepeatedFault> faults = record::repeatedFaults(all);
  if (faults.empty()) return pageNote("None.");
  HtmlTable table({"#Tick", "Source", "What happened"});
  const std::size_t shown = std::min(faults.size(), kMostFaults);
  for (std::size_t i = 0; i < shown; ++i) {
    const traffic::Fault& fault = faults[i].fault;
    table.row({std::to_string(fault.tick), fault.source, faults[i].text()});
  }
  const std::size_t left = faults.size() - shown;
  if (left == 0) return table.html();
  return table.html() + pageNote(std::to_string(left) + " more are in summary.json.");
}

Markup originTable(const record::SessionResult& result) {
  const map::ImportedNetwork& network = result.setup.import();
  HtmlTable table({"What", "Is"});
  table.row({"package",
             "e2e_cdiff " + record::packageVersion() + ", revision " + record::packageRevision()});
  table.row(
      {"deployment", result.facts.deployment +
                         (result.facts.deterministic ? ", deterministic" : ", not deterministic")});
  table.row({"simulator", result.facts.simulator_version});
  table.row({"network", network.source.string()});
  table.row({"network sha256", network.source_sha256});
  for (const std::string& change : network.changes) table.row({"network import", change});
  for (const auto& [name, version] : record::libraryVersions()) table.row({name, version});
  table.row({"processor", record::processorModel() + "; built for " + record::instructionSet()});
  table.row({"trace sha256", result.trace_sha256});
  return table.html();
}

}  // namespace cdiff::page
