// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_settings.h"

#include <algorithm>
#include <vector>

#include "core/text.h"
#include "evaluation/paper/paper_table.h"

namespace cdiff::evaluation {
namespace {

/// "speed 0.1, drivable_area 2", with the caps that a method may put on them.
std::string objectivesText(const guidance::GuidanceOptions& guidance) {
  std::vector<std::string> parts;
  for (const guidance::WeightedObjective& entry : guidance.objectives) {
    if (entry.weight <= 0.0) continue;
    const std::string cap =
        entry.gradient_cap > 0.0 ? " (cap " + core::formatNumber(entry.gradient_cap) + ")" : "";
    parts.push_back(entry.name + " " + core::formatNumber(entry.weight) + cap);
  }
  return parts.empty() ? "no objectives" : "objectives " + core::joinText(parts, ", ");
}

std::string plannerText(const std::string& role, const std::string& name,
                        const session::ScenarioOptions& scenario,
                        const guidance::GuidanceOptions& guidance) {
  const planning::PlannerDescriptor* planner = planners::findPlanner(name);
  if (planner == nullptr) return role + " " + name;
  std::vector<std::string> parts = {role + " " + planner->title};
  if (planner->network) {
    const planning::NetworkFacts facts = planner->network(scenario.planner_options, guidance);
    if (planner->guided) parts.push_back("method " + scenario.method);
    if (!facts.sampling.empty()) parts.push_back(facts.sampling);
    parts.push_back("conditioning " + facts.conditioning);
    parts.push_back("weights '" + facts.model + "'");
  }
  if (planner->guided) parts.push_back(objectivesText(guidance));
  return core::joinText(parts, ", ");
}

}  // namespace

std::string settingsOf(const session::ScenarioOptions& scenario) {
  return plannerText("ego", scenario.ego_planner, scenario, scenario.ego_guidance) + "; " +
         plannerText("CBVs", scenario.cbv_planner, scenario, scenario.guidance) + "; protocol " +
         scenario.protocol.preset + ", " + core::formatNumber(scenario.protocol.time_limit) + " s";
}

void addSettings(const TableRow& row, const TableDefinition& definition,
                 const std::vector<BatchRun>& runs, Table& table) {
  std::vector<TableSettings>& settings = table.settings;
  for (const TableColumn& column : definition.columns) {
    for (const BatchRun* run : runsWith(runs, merged(row.levels, column.levels))) {
      if (run->settings.empty()) continue;
      auto found = std::find_if(settings.begin(), settings.end(),
                                [&](const auto& entry) { return entry.text == run->settings; });
      if (found == settings.end()) found = settings.insert(settings.end(), {{}, run->settings});
      if (found->rows.empty() || found->rows.back() != row.name) found->rows.push_back(row.name);
    }
  }
}

std::vector<std::string> settingsLines(const Table& table) {
  std::vector<std::string> lines;
  for (const TableSettings& entry : table.settings)
    lines.push_back(core::joinText(entry.rows, " | ") + ": " + entry.text + ".");
  return lines;
}

}  // namespace cdiff::evaluation
