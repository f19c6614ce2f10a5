// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_conditions.h"

#include <algorithm>
#include <set>
#include <vector>

#include "core/file.h"
#include "core/option_fields.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"
#include "evaluation/matrix.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/suite_selection.h"
#include "session/scenario_options.h"

namespace cdiff::evaluation {

namespace {

namespace fs = std::filesystem;
using core::InputError;

RunProtocol protocolOf(const session::ProtocolOptions& options) {
  return {options.preset + ", time limit " + core::formatNumber(options.time_limit) + " s",
          core::flatOptions(options)};
}

/// What the scenario of a run says.
struct RunScenario {
  RunProtocol protocol;
  std::shared_ptr<const Settings> settings;
};

RunScenario readScenario(const fs::path& file) {
  session::ScenarioOptions options;
  core::loadOptions({file.string(), core::readFile(file, "scenario", core::kLargestOptionsFile)},
                    options);
  return {protocolOf(options.protocol),
          std::make_shared<const Settings>(core::flatOptions(options))};
}

/// What the complete runs of one scenario were driven by.
struct ScenarioConditions {
  std::set<std::map<std::string, std::string>> protocols;
  RunProtocol one;                                      ///< one of them
  std::map<std::string, std::set<std::string>> inputs;  ///< hashes by name
};

/// Inputs that are the scenario's; weights and program may be what is compared.
const std::vector<std::string> kScenarioInputs = {"network", "demand", "storyboard", "route_file",
                                                  "speed_target"};

std::map<std::string, ScenarioConditions> byScenario(const RunSet& set) {
  std::map<std::string, ScenarioConditions> scenarios;
  for (const RunRecord& record : set.records) {
    if (!record.complete()) continue;
    ScenarioConditions& scenario = scenarios[record.factors.at("scenario")];
    for (const std::string& name : kScenarioInputs) {
      const auto hash = record.inputs.find(name);
      if (hash != record.inputs.end()) scenario.inputs[name].insert(hash->second);
    }
    const auto protocol = set.conditions.protocols.find(record.id);
    if (protocol == set.conditions.protocols.end()) continue;
    scenario.protocols.insert(protocol->second.values);
    scenario.one = protocol->second;
  }
  return scenarios;
}

/// "time_limit 40 in A and 60 in B, ..." of two protocols.
std::string differenceText(const RunProtocol& a, const RunProtocol& b) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : a.values) {
    const auto other = b.values.find(key);
    const std::string level = other == b.values.end() ? "(none)" : other->second;
    if (level != value) parts.push_back(key + " " + value + " in A and " + level + " in B");
  }
  return core::joinText(parts, ", ");
}

std::string bothNames(const RunSet& a, const RunSet& b) {
  return "A '" + a.name + "' and B '" + b.name + "'";
}

void requireSameSuite(const RunSet& a, const RunSet& b) {
  const auto text = [](const std::string& suite) {
    return suite.empty() ? std::string("no suite") : "suite '" + suite + "'";
  };
  if (a.conditions.suite == b.conditions.suite) return;
  throw InputError(bothNames(a, b) + " drove other routes: " + text(a.conditions.suite) + " and " +
                   text(b.conditions.suite) +
                   "; their figures do not compare. Run one of them again on the other's suite "
                   "(`suite:` of its matrix)");
}

void requireSameScenario(const std::string& name, const ScenarioConditions& a,
                         const ScenarioConditions& b, const std::string& sets) {
  if (a.protocols != b.protocols) {
    const std::string what = differenceText(a.one, b.one);
    throw InputError(sets + " were driven by different protocols: scenario '" + name +
                     "': " + a.one.text + " in A, " + b.one.text + " in B" +
                     (what.empty() ? "" : " (protocol: " + what + ")") +
                     "; their figures do not compare. Run one of them again with the other's "
                     "protocol (`set: [protocol.KEY=VALUE]` of its matrix)");
  }
  if (a.inputs.empty() || b.inputs.empty()) return;  // records of an earlier version
  for (const std::string& input : kScenarioInputs) {
    const auto mine = a.inputs.find(input);
    const auto other = b.inputs.find(input);
    const bool absent = mine == a.inputs.end();
    if (absent == (other == b.inputs.end()) && (absent || mine->second == other->second)) continue;
    throw InputError(
        sets + " have a scenario '" + name + "' each, but its " + input +
        " is not the same file in A and in B (SHA-256 of the records); their figures do "
        "not compare. Run one of them again with the other's files");
  }
}

}  // namespace

BatchConditions readConditions(const fs::path& results, const std::vector<RunRecord>& records) {
  BatchConditions conditions;
  MatrixOptions matrix;
  const fs::path file = results / "matrix.yaml";
  core::loadOptions({file.string(), core::readFile(file, "evaluation", core::kLargestOptionsFile)},
                    matrix);
  conditions.suite = suiteName(matrix.suite);
  std::map<std::string, RunScenario> known;  // repetitions have the same scenario text
  for (const RunRecord& record : records) {
    if (!record.complete()) continue;
    RunScenario& scenario = known[record.scenario_sha256];
    if (!scenario.settings)
      scenario = readScenario(runFolder(results, record.id) / "scenario.yaml");
    conditions.protocols[record.id] = scenario.protocol;
    conditions.settings[record.id] = scenario.settings;
  }
  return conditions;
}

std::string conditionsText(const BatchConditions& conditions,
                           const std::vector<RunRecord>& records) {
  std::set<std::string> protocols;
  for (const RunRecord& record : records) {
    const auto protocol = conditions.protocols.find(record.id);
    if (protocol != conditions.protocols.end()) protocols.insert(protocol->second.text);
  }
  std::string text =
      protocols.empty()
          ? std::string()
          : "protocol " + core::joinText({protocols.begin(), protocols.end()}, " and ");
  if (!conditions.suite.empty()) text += (text.empty() ? "" : "; ") + ("suite " + conditions.suite);
  return text;
}

RunSet readRunSet(const fs::path& results) {
  RunSet set{results.string(), readRecords(results)};
  set.conditions = readConditions(results, set.records);
  return set;
}

void requireComparable(const RunSet& a, const RunSet& b) {
  requireSameSuite(a, b);
  const auto scenarios_b = byScenario(b);
  for (const auto& [name, conditions] : byScenario(a)) {
    const auto other = scenarios_b.find(name);
    if (other != scenarios_b.end())
      requireSameScenario(name, conditions, other->second, bothNames(a, b));
  }
}

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
  if (parts.empty()) return "no objectives";
  return "objectives " + core::joinText(parts, ", ") +
         (guidance.last_step > 1 ? " down to k = " + std::to_string(guidance.last_step) : "");
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
  const auto values = core::flatOptions(scenario.planner_options);
  const auto tracker = values.find(name + ".tracker");  // in quotes
  if (tracker != values.end())
    parts.push_back("tracker " + tracker->second.substr(1, tracker->second.size() - 2));
  return core::joinText(parts, ", ");
}

}  // namespace

std::string settingsOf(const session::ScenarioOptions& scenario) {
  return plannerText("ego", scenario.ego_planner, scenario, scenario.ego_guidance) + "; " +
         plannerText("CBVs", scenario.cbv_planner, scenario, scenario.guidance) + "; protocol " +
         scenario.protocol.preset + ", " + core::formatNumber(scenario.protocol.time_limit) + " s";
}

std::string cbvConditioningOf(const session::ScenarioOptions& scenario) {
  const planning::PlannerDescriptor* planner = planners::findPlanner(scenario.cbv_planner);
  if (planner == nullptr || !planner->network) return "";
  return planner->network(scenario.planner_options, scenario.guidance).conditioning;
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
