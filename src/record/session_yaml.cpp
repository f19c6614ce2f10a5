// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_yaml.h"

#include <Eigen/Core>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "core/yaml_text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "session/steering_file.h"

#ifndef E2E_CDIFF_VERSION
#define E2E_CDIFF_VERSION "unknown"
#endif
#ifndef E2E_CDIFF_REVISION
#define E2E_CDIFF_REVISION "unknown"
#endif
#ifndef E2E_CDIFF_YAML_CPP_VERSION
#define E2E_CDIFF_YAML_CPP_VERSION "unknown"
#endif

namespace cdiff::record {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string compilerVersion() {
#if defined(__clang__)
  return __VERSION__;
#else
  return "GCC " __VERSION__;
#endif
}

}  // namespace

std::string packageVersion() { return E2E_CDIFF_VERSION; }

std::string packageRevision() { return E2E_CDIFF_REVISION; }

std::vector<std::pair<std::string, std::string>> libraryVersions() {
  return {{"eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"yaml_cpp", E2E_CDIFF_YAML_CPP_VERSION},
          {"nlohmann_json", dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                   NLOHMANN_JSON_VERSION_PATCH)},
          {"compiler", compilerVersion()}};
}

std::string processorModel() {
  std::ifstream stream("/proc/cpuinfo");
  const std::string key = "model name";
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
    return begin == std::string::npos ? "unknown" : line.substr(begin);
  }
  return "unknown";
}

std::string instructionSet() {
#if defined(__AVX512F__)
  return "x86-64 with AVX-512";
#elif defined(__AVX2__)
  return "x86-64 with AVX2";
#elif defined(__AVX__)
  return "x86-64 with AVX";
#elif defined(__x86_64__)
  return "x86-64 baseline";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown";
#endif
}

namespace {

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
  std::string text = "network:\n" + line(1, "source", core::yamlQuoted(network.source.string())) +
                     line(1, "source_sha256", core::yamlQuoted(network.source_sha256)) +
                     line(1, "imported_sha256", core::yamlQuoted(core::sha256(network.text)));
  if (network.changes.empty()) return text + line(1, "changes", "[]");
  text += "  changes:\n";
  for (const std::string& change : network.changes)
    text += "    - " + core::yamlQuoted(change) + "\n";
  return text;
}

std::string machineBlock() {
  std::string text = "libraries:\n";
  for (const auto& [name, version] : libraryVersions())
    text += line(1, name, core::yamlQuoted(version));
  return text + "processor:\n" + line(1, "model", core::yamlQuoted(processorModel())) +
         line(1, "instruction_set", core::yamlQuoted(instructionSet()));
}

/// Facts of a planner's network under keys that start with `prefix`; "" where it has none.
std::string networkLines(const session::ScenarioOptions& options, const std::string& planner,
                         const guidance::GuidanceOptions& guidance, bool inferred_here,
                         const std::string& prefix) {
  const planning::PlannerDescriptor* descriptor = planners::findPlanner(planner);
  if (descriptor == nullptr || !descriptor->network) return "";
  const planning::NetworkFacts facts = descriptor->network(options.planner_options, guidance);
  std::string text = line(1, prefix + "model", core::yamlQuoted(facts.model)) +
                     line(1, prefix + "conditioning", core::yamlQuoted(facts.conditioning));
  if (!inferred_here) return text;  // the weights may not even be here
  text += line(1, prefix + "model_files_sha256",
               core::yamlQuoted(descriptor->weights_sha256(options.planner_options)));
  for (const auto& [key, value] : facts.instruction_sets)
    text += line(1, prefix + key, core::yamlQuoted(value));
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
  return line(0, "schema_version", "1") + "package:\n" +
         line(1, "name", core::yamlQuoted("e2e_cdiff")) +
         line(1, "version", core::yamlQuoted(packageVersion())) +
         line(1, "revision", core::yamlQuoted(packageRevision())) +
         line(0, "deployment", core::yamlQuoted(facts.deployment)) +
         (facts.recorded_by.empty() ? ""
                                    : line(0, "recorded_by", core::yamlQuoted(facts.recorded_by))) +
         line(0, "deterministic", facts.deterministic ? "true" : "false") + "seeds:\n" +
         line(1, "root", std::to_string(options.seed)) + "simulator:\n" +
         line(1, "version", core::yamlQuoted(facts.simulator_version)) +
         networkBlock(setup.import()) + machineBlock() + inferenceBlock(options, facts) +
         "scenario:\n" + indented(core::dumpOptions(options));
}

namespace {

constexpr const char* kScenarioLine = "scenario:\n";

}  // namespace

std::map<std::string, std::string> sessionFacts(const std::string& yaml) {
  std::map<std::string, std::string> facts;
  std::string section;
  for (const std::string& line : core::splitText(yaml.substr(0, yaml.find(kScenarioLine)), '\n')) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, 4, "    ") == 0) continue;
    const bool inside = line.compare(0, 2, "  ") == 0;
    const std::string key = line.substr(inside ? 2 : 0, colon - (inside ? 2 : 0));
    const std::string value = colon + 2 < line.size() ? line.substr(colon + 2) : "";
    if (!inside) section = key;
    if (!value.empty()) facts[inside ? section + "." + key : key] = value;
  }
  return facts;
}

SessionFile readSessionYaml(const std::filesystem::path& file) {
  const std::string yaml = core::readFile(file, "session", core::kLargestOptionsFile);
  SessionFile session{sessionFacts(yaml), {}};
  core::loadOptions({file.string() + " (scenario)", session::recordedScenario(yaml, file.string())},
                    session.scenario);
  return session;
}

}  // namespace cdiff::record
