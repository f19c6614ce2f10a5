// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_inputs.h"

#include <link.h>

#include <set>
#include <vector>

#include "core/file.h"
#include "core/text.h"
#include "map/network_import.h"
#include "planners/registry.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

/// Adds a loaded library that is ours to a map from file name to path.
int noteLibrary(dl_phdr_info* info, std::size_t, void* data) {
  const fs::path path = info->dlpi_name;
  const std::string name = path.filename().string();
  if (name.rfind("libe2e_cdiff_", 0) == 0)
    (*static_cast<std::map<std::string, fs::path>*>(data))[name] = path;
  return 0;
}

std::string hashProgram() {
  std::map<std::string, fs::path> parts = {{"", "/proc/self/exe"}};
  ::dl_iterate_phdr(noteLibrary, &parts);
  core::Sha256 hash;
  for (const auto& [name, path] : parts) hash.update(core::readFile(path, "program"));
  return hash.finish();
}

}  // namespace

const std::string& InputHasher::ofFile(const fs::path& file, const std::string& what) {
  std::string& hash = files_[file.string()];
  if (hash.empty()) hash = core::sha256(core::readFile(file, what));
  return hash;
}

const std::string& InputHasher::ofNetwork(const planning::PlannerDescriptor& planner,
                                          const session::ScenarioOptions& options) {
  const std::string model = planner.network(options.planner_options, options.guidance).model;
  std::string& hash = models_[{planner.name, model}];
  if (hash.empty()) hash = planner.weights_sha256(options.planner_options);
  return hash;
}

InputHashes InputHasher::hashes(const session::ScenarioOptions& options) {
  InputHashes hashes = {{"program", programSha256()}};
  hashes["network"] = ofFile(map::networkFile(options.network), "network");
  if (options.demand != "generated" && options.demand != "none")
    hashes["demand"] = ofFile(options.demand, "demand");
  if (!options.route.bench2drive_file.empty())
    hashes["route_file"] = ofFile(options.route.bench2drive_file, "route file");
  if (!options.metrics.speed_target_file.empty())
    hashes["speed_target"] = ofFile(options.metrics.speed_target_file, "speed target");
  for (const auto& [input, name] : {std::pair{"ego_weights", options.ego_planner},
                                    std::pair{"cbv_weights", options.cbv_planner}}) {
    const planning::PlannerDescriptor* planner = planners::findPlanner(name);
    if (planner != nullptr && planner->network) hashes[input] = ofNetwork(*planner, options);
  }
  return hashes;
}

const std::string& programSha256() {
  static const std::string hash = hashProgram();
  return hash;
}

std::string changedInputs(const InputHashes& before, const InputHashes& now) {
  std::set<std::string> changed;
  for (const auto& [name, hash] : now) {
    const auto earlier = before.find(name);
    if (earlier == before.end() || earlier->second != hash) changed.insert(name);
  }
  for (const auto& [name, hash] : before) {
    if (now.count(name) == 0) changed.insert(name);
  }
  return core::joinText({changed.begin(), changed.end()}, ", ");
}

}  // namespace cdiff::evaluation
