// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <filesystem>

#include "core/file.h"
#include "session/scenario_options.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

fs::path scenarioFolder() { return core::shareFolder() / "config" / "scenarios"; }

bool looksLikeFile(const std::string& text) {
  return text.find('/') != std::string::npos || text.find('.') != std::string::npos;
}

/// A file named in a scenario: beside the scenario file, else beside its network, else as given.
std::string resolveFile(const std::string& file, const fs::path& scenario_folder,
                        const std::string& network) {
  if (file.empty() || fs::path(file).is_absolute()) return file;
  const fs::path candidates[] = {scenario_folder / file,
                                 core::shareFolder() / "networks" / network / file,
                                 fs::path(network).parent_path() / file};
  for (const fs::path& candidate : candidates) {
    if (core::isFile(candidate)) return fs::weakly_canonical(candidate).string();
  }
  return file;
}

}  // namespace

ScenarioOptions loadScenario(const std::string& name_or_file, const ScenarioOptions& base) {
  const fs::path file = core::shippedOrFile(scenarioFolder(), name_or_file, "scenario");
  ScenarioOptions options = base;
  options.name = file.stem().string();
  core::loadOptions({file.string(), core::readFile(file, "scenario")}, options);
  const bool file_network = looksLikeFile(options.network);
  if (file_network) options.network = resolveFile(options.network, file.parent_path(), "");
  if (options.demand != "generated" && options.demand != "none") {
    options.demand = resolveFile(options.demand, file.parent_path(), options.network);
  }
  options.metrics.speed_target_file =
      resolveFile(options.metrics.speed_target_file, file.parent_path(), options.network);
  options.route.bench2drive_file =
      resolveFile(options.route.bench2drive_file, file.parent_path(), options.network);
  return options;
}

std::vector<std::string> shippedScenarios() { return core::shippedNames(scenarioFolder()); }

}  // namespace cdiff::session
