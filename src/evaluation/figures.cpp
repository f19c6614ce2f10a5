// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/figures.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/known_figures.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {
namespace {

using nlohmann::json;

/// Figures that lie at one place of a summary: all that metrics defines, and some of the session.
const std::vector<std::pair<std::string, std::string>>& places() {
  static const std::vector<std::pair<std::string, std::string>> all = [] {
    std::vector<std::pair<std::string, std::string>> list;
    for (const metrics::FigureDefinition& figure : metrics::figureDefinitions())
      list.emplace_back(figure.name, figure.place);
    list.emplace_back("guidance_trust_region_share", "/guidance_trust_region_share");
    list.emplace_back("simulated_seconds", "/simulated_seconds");
    list.emplace_back("real_time_factor", "/real_time_factor");
    return list;
  }();
  return all;
}

/// Shares over the CBVs that were selected; absent where the summary does not have the keys.
void addSelectionFigures(const json& summary, Figures& figures) {
  const json selections = summary.value(json::json_pointer("/cbv/selections"), json::array());
  double passed = 0.0;
  double completion = 0.0;
  std::size_t with_passed = 0;
  std::size_t with_completion = 0;
  for (const json& selection : selections) {
    const json passed_value = selection.value("conflict_point_passed", json());
    const json completion_value = selection.value("route_completion_percent", json());
    if (passed_value.is_boolean()) {
      ++with_passed;
      passed += passed_value.get<bool>() ? 100.0 : 0.0;
    }
    if (completion_value.is_number()) {
      ++with_completion;
      completion += completion_value.get<double>();
    }
  }
  if (with_passed > 0) figures["cbv_passed_percent"] = passed / static_cast<double>(with_passed);
  if (with_completion > 0) {
    figures["cbv_completion_percent"] = completion / static_cast<double>(with_completion);
  }
}

std::string lastFault(const json& summary) {
  const json faults = summary.value("faults", json::array());
  return faults.empty() ? "" : faults.back().value("text", "");
}

}  // namespace

const std::vector<std::string>& figureNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, place] : places()) {
      all.emplace_back(name);
      if (all.back() != metrics::figures::kCbvMinimumDistance.name) continue;
      all.insert(all.end(), {"cbv_passed_percent", "cbv_completion_percent"});
    }
    return all;
  }();
  return names;
}

SummaryFacts readSummary(const std::string& text, const std::string& source) {
  try {
    const json summary = json::parse(text);
    SummaryFacts facts;
    facts.status = summary.at("status");
    facts.fault = lastFault(summary);
    facts.verdict = record::outcomeOf(summary.at("verdict").at("outcome"));
    facts.reasons = summary.at("verdict").at("reasons").get<std::vector<std::string>>();
    facts.decided_by = summary.at("verdict").value("decided_by", std::vector<std::string>());
    facts.simulated_seconds = summary.at("simulated_seconds");
    for (const auto& [name, place] : places()) {
      const json::json_pointer pointer(place);
      if (!summary.contains(pointer)) continue;
      const json& value = summary.at(pointer);
      if (value.is_number()) facts.figures[name] = value;
      if (value.is_boolean()) facts.figures[name] = value.get<bool>() ? 1.0 : 0.0;
    }
    addSelectionFigures(summary, facts.figures);
    return facts;
  } catch (const json::exception& error) {
    throw core::InputError("'" + source + "' is no summary of a session: " + error.what());
  }
}

}  // namespace cdiff::evaluation
