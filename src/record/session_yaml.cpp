// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_yaml.h"

#include <yaml-cpp/yaml.h>

#include "core/file.h"
#include "planners/registry.h"
#include "record/build_info.h"

namespace cdiff::record {
namespace {

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

std::string line(int depth, const std::string& key, const std::string& value) {
  return std::string(static_cast<std::size_t>(2 * depth), ' ') + key + ": " + value + "\n";
}

/// Every line of a YAML block one level deeper.
std::string indented(const std::string& block) {
  std::string text;
  std::size_t begin = 0;
  while (begin < block.size()) {
    const std::size_t end = std::min(block.find('\n', begin), block.size());
    text += "  " + block.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text;
}

std::string networkBlock(const map::ImportedNetwork& network) {
  std::string text = "network:\n" + line(1, "source", quoted(network.source.string())) +
                     line(1, "source_sha256", quoted(network.source_sha256)) +
                     line(1, "imported_sha256", quoted(core::sha256(network.text)));
  if (network.changes.empty()) return text + line(1, "changes", "[]");
  text += "  changes:\n";
  for (const std::string& change : network.changes) text += "    - " + quoted(change) + "\n";
  return text;
}

std::string machineBlock() {
  std::string text = "libraries:\n";
  for (const auto& [name, version] : libraryVersions()) text += line(1, name, quoted(version));
  return text + "processor:\n" + line(1, "model", quoted(processorModel())) +
         line(1, "instruction_set", quoted(instructionSet()));
}

/// Facts of a planner's network under keys that start with `prefix`; "" where it has none.
std::string networkLines(const session::ScenarioOptions& options, const std::string& planner,
                         const guidance::GuidanceOptions& guidance, bool inferred_here,
                         const std::string& prefix) {
  const planning::PlannerDescriptor* descriptor = planners::findPlanner(planner);
  if (descriptor == nullptr || !descriptor->network) return "";
  const planning::NetworkFacts facts = descriptor->network(options.planner_options, guidance);
  std::string text = line(1, prefix + "model", quoted(facts.model)) +
                     line(1, prefix + "conditioning", facts.conditioning);
  if (!inferred_here) return text;  // the weights may not even be here
  text += line(1, prefix + "model_files_sha256",
               quoted(descriptor->weights_sha256(options.planner_options)));
  for (const auto& [key, value] : facts.instruction_sets)
    text += line(1, prefix + key, quoted(value));
  return text;
}

/// What the bytes of planned actions depend on besides the scenario: models and instruction sets.
std::string inferenceBlock(const session::ScenarioOptions& options, const RunFacts& facts) {
  const bool here = facts.recorded_by.empty();
  const std::string text =
      networkLines(options, options.ego_planner, options.ego_guidance, here, "ego_") +
      networkLines(options, options.cbv_planner, options.guidance, here, "cbv_");
  return text.empty() ? "" : "inference:\n" + text;
}

}  // namespace

std::string sessionYaml(const session::SessionSetup& setup, const RunFacts& facts) {
  const session::ScenarioOptions& options = setup.options();
  return line(0, "schema_version", "1") + "package:\n" + line(1, "name", quoted("e2e_cdiff")) +
         line(1, "version", quoted(packageVersion())) +
         line(1, "revision", quoted(packageRevision())) +
         line(0, "deployment", quoted(facts.deployment)) +
         (facts.recorded_by.empty() ? "" : line(0, "recorded_by", quoted(facts.recorded_by))) +
         line(0, "deterministic", facts.deterministic ? "true" : "false") + "seeds:\n" +
         line(1, "root", std::to_string(options.seed)) + "simulator:\n" +
         line(1, "version", quoted(facts.simulator_version)) + networkBlock(setup.import()) +
         machineBlock() + inferenceBlock(options, facts) + "scenario:\n" +
         indented(core::dumpOptions(options));
}

}  // namespace cdiff::record
