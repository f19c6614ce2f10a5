// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/steering_file.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr const char* kSummary = "summary.json";

traffic::SteeringChange changeOf(const json& entry) {
  return {entry.at("by"), entry.at("what"), entry.at("before"), entry.at("after")};
}

std::vector<SteeringEntry> recordedSteering(const fs::path& summary) {
  const std::string place = "'" + summary.string() + "'";
  try {
    const json steering = core::readJson(summary, "summary").at("steering");
    if (steering.at("paced_by_wall_clock").get<bool>()) refusePaced(summary);
    std::vector<SteeringEntry> entries;
    for (const json& change : steering.at("changes"))
      entries.push_back(entryOf(changeOf(change), change.at("seconds").get<double>()));
    return entries;
  } catch (const json::exception& error) {
    throw InputError(place + ": no steering can be read from it: " + core::jsonFault(error) +
                     "; expected the summary.json of a session of this version");
  }
}

}  // namespace

void refusePaced(const fs::path& source) {
  throw InputError("'" + source.string() +
                   "': the wall clock paced this session (real_time_factor), so that its steering "
                   "cannot be repeated; expected a session in lockstep");
}

std::vector<SteeringEntry> readSteering(const fs::path& source) {
  if (core::isFolder(source)) return recordedSteering(source / kSummary);
  if (source.extension() == ".json") return recordedSteering(source);
  const std::vector<SteeringEntry> entries = loadScenario(source.string()).steering;
  if (!entries.empty()) return entries;
  throw InputError("'" + source.string() +
                   "': it lists no steering; expected a scenario file with the key 'steering', a "
                   "result folder, or its summary.json");
}

namespace {

/// The package's version in a session.yaml; empty where there is none.
std::string versionIn(const fs::path& file) {
  if (!core::isFile(file)) return "";
  const std::string text = core::readFile(file, "session record", core::kLargestOptionsFile);
  const std::string key = "\n  version: \"";
  const std::size_t package = text.find("\npackage:\n");
  const std::size_t begin = package == std::string::npos ? package : text.find(key, package);
  if (begin == std::string::npos) return "";
  const std::size_t value = begin + key.size();
  return text.substr(value, text.find('"', value) - value);
}

std::string sessionText(const std::string& scenario, std::int64_t seed) {
  return "scenario '" + scenario + "' with seed " + std::to_string(seed);
}

}  // namespace

SteeredSession steeredSession(const fs::path& source) {
  const fs::path summary = core::isFolder(source) ? source / kSummary : source;
  if (summary.extension() != ".json") return {};
  try {
    const json record = core::readJson(summary, "summary");
    return {record.value("scenario", ""), record.value("seed", std::int64_t{0}),
            versionIn(summary.parent_path() / "session.yaml")};
  } catch (const json::exception& error) {
    throw InputError("'" + summary.string() +
                     "': it is no summary of a session: " + core::jsonFault(error) +
                     "; expected the summary.json of a session of this version");
  }
}

void requireSameSession(const fs::path& source, const SteeredSession& recorded,
                        const ScenarioOptions& options, const std::string& version) {
  if (recorded.scenario.empty()) return;
  const std::string as_list =
      "; to steer another session alike, give the list that `cdiff steering RESULT` prints";
  if (recorded.scenario != options.name || recorded.seed != options.seed) {
    throw InputError("'" + source.string() + "': its steering is that of " +
                     sessionText(recorded.scenario, recorded.seed) + ", and this session is " +
                     sessionText(options.name, options.seed) + as_list);
  }
  if (recorded.version.empty() || recorded.version == version) return;
  throw InputError("'" + source.string() + "': e2e_cdiff " + recorded.version +
                   " recorded its steering, and this is " + version +
                   ", which may drive otherwise; repeat it with that version" + as_list);
}

std::string recordedScenario(const std::string& text, const std::string& file) {
  const std::string head = "\nscenario:\n";
  const std::size_t found = text.find(head);
  if (found == std::string::npos)
    throw InputError(file + ": key 'scenario' is missing; expected what a session writes");
  std::string scenario;
  for (const std::string& line : core::splitText(text.substr(found + head.size()), '\n')) {
    if (line.compare(0, 2, "  ") != 0) break;
    scenario += line.substr(2) + "\n";
  }
  return scenario;
}

std::string steeredScenario(const fs::path& result) {
  const std::vector<SteeringEntry> entries = recordedSteering(result / kSummary);
  if (entries.empty()) throw InputError("'" + result.string() + "': nobody steered this session");
  const fs::path file = result / "session.yaml";
  ScenarioOptions options;
  const std::string record = core::readFile(file, "session record", core::kLargestOptionsFile);
  core::loadOptions({file.string(), recordedScenario(record, file.string())}, options);
  options.steering.clear();
  options.name += "_steered";
  std::string text = core::dumpOptions(options);
  const std::string none = "\nsteering: []\n";
  std::string list = "\nsteering:\n";
  for (const SteeringEntry& entry : entries) list += "  - " + flowText(entry) + "\n";
  return text.replace(text.find(none), none.size(), list);
}

}  // namespace cdiff::session
