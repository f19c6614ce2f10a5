// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/summary.h"

#include "core/text.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"
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
                    {"ego_at_fault", contact.ego_at_fault},
                    {"why", contact.reason},
                    {"ego_speed_mps", contact.ego_speed},
                    {"other_speed_mps", contact.partner_speed},
                    {"ego_side", contact.ego_side},
                    {"other_side", contact.partner_side},
                    {"x", contact.x},
                    {"y", contact.y},
                    {"avoidable", contact.avoidable}});
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
  for (const traffic::Fault& fault : faults) {
    list.push_back({{"tick", fault.tick}, {"source", fault.source}, {"text", fault.text}});
  }
  return list;
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
  summary["cbv"] = cbvObject(result);
  summary["guidance"] = guidanceObject(result.guidance);
  summary["guidance_trust_region_share"] = number(result.guidance.trustRegion().mean);
  summary["metrics"] = Json::object();
  addMeasures(summary["metrics"], "metrics", result.measures);
  summary["planner_latency_ms"] = latencyObject(result.latencies);
  summary["late_answers"] = lateObject(result.late);
  summary["faults"] = faultList(result.faults);
  summary["verdict"] = verdictObject(result.verdict);
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace cdiff::record
