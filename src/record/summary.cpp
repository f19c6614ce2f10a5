// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/summary.h"

#include <cmath>

#include "core/text.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"
#include "planners/planner_by_slot.h"
#include "record/repeated_faults.h"
#include "record/session_text.h"
#include "session/session_request.h"

namespace cdiff::record {
namespace {

/// Each contact of the ego, with who is at fault and why.
Json contactList(const std::vector<metrics::EgoContact>& contacts) {
  Json list = Json::array();
  for (const metrics::EgoContact& contact : contacts) {
    list.push_back({{"tick", contact.tick},
                    {"seconds", contact.seconds},
                    {"with", contact.partner},
                    {"with_cbv", contact.with_cbv},
                    {"ego_at_fault", contact.ego_at_fault},
                    {"why", contact.reason},
                    {"ego_speed_mps", contact.ego_speed},
                    {"other_speed_mps", contact.partner_speed},
                    {"ego_side", contact.ego_side},
                    {"other_side", contact.partner_side},
                    {"x", contact.x},
                    {"y", contact.y},
                    {"braking_avoids", contact.braking_avoids}});
  }
  return list;
}

/// Each measure of the ego under its key; infractions in an object, with their counts in another.
Json egoObject(const metrics::SessionMeasures& measures) {
  Json object = Json::object();
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const std::vector<std::string> keys = core::splitText(definition.place, '/');
    if (keys.front() != "ego") continue;
    const metrics::Measure measure = measures.at(definition);
    const std::string name = definition.name;
    if (keys.size() > 2) {
      addMeasure(object[keys[1]], keys.back(), measure);
      object[keys[1] + "_n"][keys.back()] = measure.n;
    } else if (name == metrics::known::kBlocked.name) {
      object[keys.back()] = measure.value == 1.0;
    } else {
      addPlainMeasure(object, keys.back(), measure);
    }
    if (name == metrics::known::kDrivingScore.name) object["protocol"] = measures.protocol;
    if (name == metrics::known::kContactsAtFault.name)
      object["contacts"] = contactList(measures.ego_contacts);
  }
  return object;
}

/// What the vehicle or light is that somebody waits for.
const char* reasonText(Wait::For reason) {
  constexpr const char* kTexts[] = {"vehicle", "light", "stop_line", "stop", "no_way", "nothing"};
  return kTexts[static_cast<std::size_t>(reason)];
}

Json waitList(const WaitChain& chain) {
  Json list = Json::array();
  for (const Wait& wait : chain.waits) {
    list.push_back({{"who", wait.vehicle},
                    {"waits_for", reasonText(wait.reason)},
                    {"id", wait.obstacle.empty() ? Json(nullptr) : Json(wait.obstacle)},
                    {"junction", wait.junction.empty() ? Json(nullptr) : Json(wait.junction)},
                    {"yields", wait.yields},
                    {"until", wait.until.empty() ? Json(nullptr) : Json(wait.until)}});
  }
  return list;
}

/// What held the ego up; null unless the session ended blocked or timed out.
Json holdUpObject(const SessionResult& result) {
  const std::optional<HoldUp>& found = result.hold_ups.found();
  if (!found) return nullptr;
  const bool stood = !found->chain.waits.empty();
  return {{"text", holdUpText(*found, result.setup, result.status)},
          {"begin_seconds", stood ? Json(found->begin) : Json(nullptr)},
          {"seconds", found->seconds},
          {"crept_seconds", found->crept},
          {"at_end", found->at_end},
          {"chain", waitList(found->chain)},
          {"ring", found->chain.ring},
          {"traffic_still_seconds", number(found->traffic_still)},
          {"cbvs", found->cbvs},
          {"stood_seconds", found->stood},
          {"slow_seconds", found->slow},
          {"held_behind", found->held_behind.empty() ? Json(nullptr) : Json(found->held_behind)}};
}

/// What guidance did to the plans of CBVs, by objective; null without guidance.
Json guidanceObject(const GuidanceLog& log) {
  if (log.series().empty()) return nullptr;
  Json object = Json::object();
  for (const GuidanceSeries& series : log.series()) {
    const ObjectiveSummary summary = summaryOf(series);
    object[series.objective] = {{"weight", number(summary.weight)},
                                {"value", number(summary.value)},
                                {"gradient_norm", number(summary.gradient_norm)},
                                {"capped_share", number(summary.capped_share)},
                                {"dropped", summary.dropped},
                                {"n", summary.n}};
  }
  return object;
}

/// What mode challenging came to.
Json challengeObject(const ChallengeCounts& counts) {
  return {{"decisions", counts.decisions},
          {"attacks", counts.attacks},
          {"attacking", counts.attacking},
          {"withdrawn", counts.withdrawn},
          {"refused", counts.refused}};
}

Json latencyObject(const std::map<std::string, LatencySummary>& latencies) {
  Json object = Json::object();
  for (const auto& [planner, summary] : latencies) {
    object[planner] = {{"p50", summary.median},
                       {"p95", summary.percentile_95},
                       {"max", summary.maximum},
                       {"n", summary.n}};
  }
  return object;
}

Json verdictObject(const Verdict& verdict) {
  Json rules = Json::array();
  for (const Check& check : verdict.checks) {
    rules.push_back(
        {{"rule", check.name}, {"outcome", toText(check.outcome)}, {"found", check.text}});
  }
  return {{"outcome", toText(verdict.outcome)},
          {"reasons", verdict.reasons},
          {"decided_by", verdict.decided_by},
          {"rules", rules}};
}

Json lateObject(const std::map<std::string, LateCounts>& late) {
  Json object = {{"count", lateAnswers(late)}, {"planners", Json::object()}};
  for (const auto& [planner, counts] : late) {
    object["planners"][planner] = {
        {"asked", counts.asked},
        {"late", counts.late},
        {"missing", counts.missing},
        {"by_plan", counts.by_plan},
        {"by_full_brake", counts.by_full_brake},
        {"not_driven", counts.not_driven},
        {"lateness_s",
         {{"p50", counts.median}, {"p95", counts.percentile_95}, {"max", counts.maximum}}}};
  }
  return object;
}

Json faultList(const std::vector<traffic::Fault>& faults) {
  Json list = Json::array();
  for (const RepeatedFault& repeated : repeatedFaults(faults)) {
    const traffic::Fault& fault = repeated.fault;
    list.push_back({{"tick", fault.tick}, {"source", fault.source}, {"text", fault.text}});
    if (repeated.times == 1) continue;
    list.back()["times"] = repeated.times;
    list.back()["last_tick"] = repeated.last_tick;
  }
  return list;
}

/// Time of a tick without the last bit of the product: 5.8, not 5.800000000000001 [s].
double secondsOf(std::uint64_t tick, double step) {
  return std::round(static_cast<double>(tick) * step * 1e9) / 1e9;
}

/// What was steered, as `cdiff run --steering` reads it.
Json steeringObject(const SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  Json changes = Json::array();
  for (const session::SteeringRecord& record : result.steering.records()) {
    const auto& [by, what, before, after] = record.change;
    changes.push_back({{"tick", record.tick},
                       {"seconds", secondsOf(record.tick, options.simulation_step)},
                       {"by", by},
                       {"what", what},
                       {"before", before},
                       {"after", after},
                       {"refused", record.refused}});
  }
  return {{"by_hand", result.steering.byHand()},
          {"paced_by_wall_clock", options.real_time_factor > 0.0},
          {"changes", changes}};
}

/// How the session was asked for and how it ended.
Json headOf(const SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  const session::MethodUse method = session::methodOf(options);
  Json head = {{"schema_version", 1},
               {"scenario", options.name},
               {"seed", options.seed},
               {"mode", options.mode},
               {"method", method.name},
               {"method_preset", method.preset},
               {"method_changes", method.changed},
               {"ego_planner", options.ego_planner},
               {"cbv_planner", options.cbv_planner},
               {"status", traffic::toText(result.status)},
               {"simulated_seconds", result.simulated_seconds},
               {"wall_seconds", result.wall_seconds}};
  if (result.wall_seconds > 0.0) {
    head["real_time_factor"] = result.simulated_seconds / result.wall_seconds;
  } else {
    head["real_time_factor"] = nullptr;
    head["real_time_factor_reason"] = "no wall time was measured";
  }
  head["trace_sha256"] = result.trace_sha256;
  return head;
}

}  // namespace

std::string summaryJson(const SessionResult& result) {
  Json summary = headOf(result);
  summary["ego"] = egoObject(result.measures);
  summary["hold_up"] = holdUpObject(result);
  summary["cbv"] = cbvObject(result);
  summary["guidance"] = guidanceObject(result.guidance);
  if (result.guidance.challenge().decisions > 0)
    summary["challenge"] = challengeObject(result.guidance.challenge());
  summary["guidance_trust_region_share"] = number(result.guidance.trustRegion().mean);
  summary["metrics"] = Json::object();
  addMeasures(summary["metrics"], "metrics", result.measures);
  summary["planner_latency_ms"] = latencyObject(result.latencies);
  summary["late_answers"] = lateObject(result.late);
  summary["steering"] = steeringObject(result);
  summary["faults"] = faultList(result.faults);
  summary["verdict"] = verdictObject(result.verdict);
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

/// {value, n, unit} and, where there is one, the reason (why absent, or how thinned out) and the
/// target that it is compared with.
Json measureObject(const metrics::Measure& measure) {
  Json object = {{"value", number(measure.value)}, {"n", measure.n}, {"unit", measure.unit}};
  if (!measure.reason.empty()) object["reason"] = measure.reason;
  if (!measure.target.empty()) object["target"] = measure.target;
  return object;
}

/// Adds `leaf` to a distribution's object: its values, then n and, where there is one, the reason.
void addToDistribution(Json& object, const std::string& leaf, const metrics::Measure& measure) {
  if (object.is_null()) object = Json::object();
  const std::string reason = object.value("reason", measure.reason);
  object.erase("n");
  object.erase("reason");
  object[leaf] = number(measure.value);
  object["n"] = measure.n;
  if (!reason.empty()) object["reason"] = reason;
}

Json entryList(const std::vector<metrics::MetricEntry>& entries) {
  Json list = Json::array();
  for (const metrics::MetricEntry& entry : entries) {
    list.push_back(Json::object());
    for (const auto& [key, value] : entry)
      std::visit([&, &name = key](const auto& content) { list.back()[name] = content; }, value);
  }
  return list;
}

}  // namespace

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void addMeasure(Json& object, const std::string& key, const metrics::Measure& measure) {
  object[key] = number(measure.value);
  if (!measure.reason.empty()) object[key + "_reason"] = measure.reason;
}

void addPlainMeasure(Json& object, const std::string& key, const metrics::Measure& measure) {
  addMeasure(object, key, measure);
  if (measure.unit == "count" && measure.value)
    object[key] = static_cast<std::uint64_t>(*measure.value);
}

void addMeasures(Json& object, const std::string& section,
                 const metrics::SessionMeasures& measures) {
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const std::vector<std::string> keys = core::splitText(definition.place, '/');
    if (keys.front() != section) continue;
    const metrics::Measure measure = measures.at(definition);
    if (keys.size() == 2) {
      addPlainMeasure(object, keys[1], measure);
      continue;
    }
    Json* parent = &object;
    for (std::size_t i = 1; i + 1 < keys.size(); ++i) parent = &(*parent)[keys[i]];
    if (keys.back() == "value") {
      *parent = measureObject(measure);
    } else {
      addToDistribution(*parent, keys.back(), measure);
    }
  }
  for (const auto& [place, entries] : measures.lists) {
    const std::vector<std::string> keys = core::splitText(place, '/');
    if (keys.front() == section) object[keys.back()] = entryList(entries);
  }
}

namespace {

Json summaryObject(const SampleSummary& summary) {
  return {{"mean", number(summary.mean)}, {"p95", number(summary.percentile_95)}, {"n", summary.n}};
}

Json conflictObject(const cbv::ConflictPoint& conflict, const map::Route& ego_route) {
  return {{"x", conflict.position.x()},
          {"y", conflict.position.y()},
          {"z", conflict.position.z()},
          {"ego_distance_m", conflict.ego_distance},
          {"cbv_distance_m", conflict.cbv_distance},
          {"ego_arrival_s", conflict.ego_arrival},
          {"cbv_arrival_s", conflict.cbv_arrival},
          {"arrival_time_gap_s", conflict.arrivalTimeGap()},
          {"ego_arc_length_m", conflict.ego_arc_length},
          {"in_junction_or_beyond", atOrBeyondFirstJunction(conflict, ego_route)}};
}

Json selectionObject(const CbvRecord& record, const SessionResult& result) {
  const session::SessionSetup& setup = result.setup;
  const double step = setup.options().simulation_step;
  Json object = {{"slot", record.slot},
                 {"planner", planners::plannerOfSlot(setup.options().cbv_planner, record.slot)},
                 {"vehicle_id", record.vehicle_id},
                 {"selected_tick", record.selected_tick},
                 {"selected_seconds", secondsOf(record.selected_tick, step)},
                 {"interaction_score", record.interaction_score},
                 {"conflict_point", conflictObject(record.conflict_point, setup.egoRoute())},
                 {"decisions_driven", record.decisions_driven},
                 {"released_tick", nullptr},
                 {"release_reason", record.release_reason},
                 {"contact_with", nullptr},
                 {"route_length_m", record.route_length},
                 {"route_completion_percent", record.routeCompletionPercent()},
                 {"conflict_point_passed", record.conflict_point_passed},
                 {"route_completed", record.routeCompleted()}};
  if (setup.options().cbv_target_speed.drawn())
    object["target_speed_mps"] = setup.cbvTargetSpeed(record.vehicle_id);
  if (record.released_tick) object["released_tick"] = *record.released_tick;
  if (const auto other = contactPartner(record, result)) object["contact_with"] = *other;
  return object;
}

/// Plans of all CBVs against what was driven and against exact dynamics; null without plans.
Json planObject(const SessionResult& result) {
  if (result.plans.empty()) return nullptr;
  Json object = Json::object();
  for (const int seconds : {1, 2, 3}) {
    object["displacement_" + std::to_string(seconds) + "s_m"] =
        summaryObject(displacementSummary(result.plans, seconds));
  }
  const SampleSummary mismatch = mismatchSummary(result.plans);
  object["state_mismatch_m"] = {{"mean", number(mismatch.mean)},
                                {"p95", number(mismatch.percentile_95)},
                                {"max", number(mismatch.maximum)},
                                {"n", mismatch.n}};
  return object;
}

/// Faults of planners of CBVs, by planner.
Json cbvFaults(const std::vector<traffic::Fault>& faults) {
  Json object = Json::object();
  for (const traffic::Fault& fault : faults) {
    if (fault.source.rfind("cbv:", 0) != 0) continue;
    object[fault.source] = object.value(fault.source, 0) + 1;
  }
  return object;
}

}  // namespace

bool atOrBeyondFirstJunction(const cbv::ConflictPoint& conflict, const map::Route& ego_route) {
  const auto& junctions = ego_route.junctionStretches();
  return !junctions.empty() && conflict.ego_arc_length >= junctions.front().first;
}

std::optional<std::string> contactPartner(const CbvRecord& record, const SessionResult& result) {
  const double step = result.setup.options().simulation_step;
  const double end = record.released_tick ? static_cast<double>(*record.released_tick) * step
                                          : result.timeline.duration();
  return result.timeline.lastContactOf(record.vehicle_id,
                                       static_cast<double>(record.selected_tick) * step, end);
}

Json cbvObject(const SessionResult& result) {
  Json object = Json::object();
  addMeasures(object, "cbv", result.measures);
  if (const std::string text = untestedText(result); !text.empty()) object["untested"] = text;
  object["selections"] = Json::array();
  for (const CbvRecord& record : result.cbv.records()) {
    object["selections"].push_back(selectionObject(record, result));
  }
  object["rejected"] = Json::object();
  for (const auto& [reason, count] : result.cbv.rejected()) object["rejected"][reason] = count;
  object["faults"] = cbvFaults(result.faults);
  object["plan"] = planObject(result);
  return object;
}

}  // namespace cdiff::record
