// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/plan_file.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/host.h"
#include "core/json_file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "diffusion/network/cpu_denoiser.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_plan.h"
#include "inference/precision.h"
#include "record/session_yaml.h"

namespace cdiff::evaluation {

namespace fs = std::filesystem;

std::string instructionSets() {
  using diffusion::CpuDenoiser;
  return record::instructionSet() + "; encoder with " + inference::oneDnnInstructionSet("auto") +
         ", denoiser with " + CpuDenoiser::toText(CpuDenoiser::bestInstructionSet());
}

void writePlan(const fs::path& results, const PlanFile& plan) {
  const nlohmann::ordered_json json = {{"schema_version", 1},
                                       {"program_sha256", plan.program},
                                       {"instruction_sets", plan.instruction_sets},
                                       {"timeout", plan.timeout},
                                       {"retries", plan.retries},
                                       {"fresh", plan.fresh},
                                       {"runs", plan.ids}};
  core::writeOwnFile(results / PlanFile::kName, json.dump(1) + "\n");
}

namespace {

/// Throws InputError for values that no command plans.
void requireUsable(const PlanFile& plan, int version, const fs::path& file) {
  constexpr int kMostRetries = 1000;
  const auto is_name = [](const std::string& id) {
    return !id.empty() && id != "." && id != ".." && id.find('/') == std::string::npos;
  };
  std::string wrong;
  if (version != 1) wrong = "schema_version is " + std::to_string(version) + "; expected 1";
  if (!(plan.timeout > 0.0)) wrong = "timeout is not above 0";
  if (plan.retries < 0 || plan.retries > kMostRetries) wrong = "retries are not 0 to 1000";
  for (const std::string& id : plan.ids) {
    if (!is_name(id)) wrong = "'" + core::shortened(id) + "' is no name of a run";
  }
  if (wrong.empty()) return;
  throw core::InputError("'" + file.string() + "' is no plan of a batch: " + wrong +
                         "; write it again with the command that planned it (cdiff evaluate: with "
                         "--resume)");
}

}  // namespace

PlanFile readPlan(const fs::path& results) {
  const fs::path file = results / PlanFile::kName;
  if (!core::isFile(file)) {
    throw core::InputError("'" + results.string() + "' has no " + PlanFile::kName +
                           "; expected the result folder of a batch that is under way");
  }
  try {
    const auto json = core::readJson(file, "plan");
    PlanFile plan;
    plan.program = json.at("program_sha256");
    plan.instruction_sets = json.at("instruction_sets");
    plan.timeout = json.at("timeout");
    plan.retries = json.at("retries");
    plan.fresh = json.at("fresh");
    plan.ids = json.at("runs").get<std::vector<std::string>>();
    requireUsable(plan, json.at("schema_version"), file);
    return plan;
  } catch (const nlohmann::json::exception& error) {
    throw core::InputError(
        "'" + file.string() + "' is no plan of a batch: " + core::jsonFault(error) +
        "; write it again with the command that planned it (cdiff evaluate: with --resume)");
  }
}

void requireSameProgram(const PlanFile& plan) {
  const std::string where = "the worker on host " + core::hostName() + " ";
  if (plan.program != programSha256()) {
    throw core::InputError(where + "is another build (SHA-256 " + programSha256() +
                           ") than the one that planned (" + plan.program +
                           "); expected the same program, libraries and plug-ins");
  }
  const std::string here = instructionSets();
  if (plan.instruction_sets == here) return;
  throw core::InputError(where + "uses other instruction sets (" + here +
                         ") than the machine that planned (" + plan.instruction_sets +
                         "); its bytes would differ: set E2E_CDIFF_ISA and ONEDNN_MAX_CPU_ISA "
                         "alike on both, or leave such machines out");
}

}  // namespace cdiff::evaluation
