// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_yaml.h"

#include <yaml-cpp/yaml.h>

#include "core/file.h"
#include "diffusion/cpu_denoiser.h"
#include "diffusion/image_encoder.h"
#include "diffusion/model.h"
#include "planners/planner_factory.h"
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

/// What the networks of ego and CBVs are told.
std::string conditioningLines(const session::ScenarioOptions& options) {
  const auto lineOf = [&](const char* key, const std::string& planner,
                          const guidance::GuidanceOptions& guidance) {
    return planners::seesImages(planner)
               ? line(1, key, options.diffusion.conditioningUnder(guidance))
               : "";
  };
  return lineOf("ego_conditioning", options.ego_planner, options.ego_guidance) +
         lineOf("cbv_conditioning", options.cbv_planner, options.guidance);
}

/// What the bytes of a planned action depend on besides the scenario: model and instruction sets.
std::string inferenceBlock(const session::ScenarioOptions& options, const RunFacts& facts) {
  if (!planners::seesImages(options.cbv_planner) && !planners::seesImages(options.ego_planner))
    return "";
  using diffusion::CpuDenoiser;
  if (!facts.recorded_by.empty())  // nothing was inferred here; the model may not even be here
    return "inference:\n" + line(1, "model", quoted(options.diffusion.model)) +
           conditioningLines(options);
  return "inference:\n" + line(1, "model", quoted(options.diffusion.model)) +
         conditioningLines(options) +
         line(1, "model_files_sha256",
              quoted(diffusion::modelFilesSha256(options.diffusion.model))) +
         line(1, "encoder_instruction_set", quoted(diffusion::ImageEncoder::instructionSet())) +
         line(1, "denoiser_instruction_set",
              quoted(CpuDenoiser::toText(CpuDenoiser::bestInstructionSet())));
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
