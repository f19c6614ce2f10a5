// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/suite.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "suite/seal.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr const char* kManifest = "suite.yaml";

fs::path suitesFolder() { return core::shareFolder() / "config" / "suites"; }

fs::path findSuite(const std::string& name_or_folder) {
  if (core::isFile(fs::path(name_or_folder) / kManifest)) return fs::absolute(name_or_folder);
  if (core::isFile(suitesFolder() / name_or_folder / kManifest))
    return suitesFolder() / name_or_folder;
  if (core::isFolder(name_or_folder)) {
    throw InputError("folder '" + name_or_folder + "' holds no " + kManifest +
                     "; expected a suite, as 'cdiff suite train --results DIR' makes it");
  }
  const std::vector<std::string> known = shippedSuites();
  throw InputError("suite '" + name_or_folder +
                   "' is neither the folder of a suite nor a shipped suite; the nearest shipped "
                   "one is '" +
                   core::nearestName(name_or_folder, known) +
                   "' (all: " + core::joinText(known, ", ") +
                   "); the training suite is made by 'cdiff suite train --results DIR'");
}

/// Reads the entries of one YAML map and says where something is wrong.
class EntryReader {
 public:
  EntryReader(const fs::path& file, const YAML::Node& node) : file_(file), node_(node) {
    if (!node.IsMap()) fail("expected a map of keys");
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) fail("expected keys that are plain words");
      keys_.push_back(entry.first.as<std::string>());
    }
  }

  template <class Value>
  void read(const char* key, Value& value, const char* expected) {
    known_.emplace_back(key);
    const YAML::Node entry = node_[key];
    if (!entry) fail(std::string("key '") + key + "' is missing; expected " + expected);
    try {
      value = entry.as<Value>();
    } catch (const YAML::Exception&) {
      fail(std::string("key '") + key + "': expected " + expected);
    }
  }

  void choice(const char* key, std::string& value, const std::vector<std::string>& choices) {
    read(key, value, core::joinText(choices, ", ").c_str());
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
    fail(std::string("key '") + key + "' is '" + value + "'; expected one of " +
         core::joinText(choices, ", "));
  }

  /// Refuses keys that were not read.
  void finish() const {
    for (const std::string& key : keys_) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      fail("unknown key '" + key + "'; the nearest known one is '" +
           core::nearestName(key, known_) + "'");
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("suite '" + file_.string() + "', line " +
                     std::to_string(node_.Mark().line + 1) + ": " + what);
  }

  bool has(const char* key) const { return node_[key].IsDefined(); }

  YAML::Node child(const char* key) {
    known_.emplace_back(key);
    return node_[key];
  }

 private:
  fs::path file_;
  YAML::Node node_;
  std::vector<std::string> keys_;
  std::vector<std::string> known_;
};

SuiteRoute readRoute(const fs::path& file, const YAML::Node& node) {
  EntryReader reader(file, node);
  SuiteRoute route;
  reader.read("name", route.name, "a text");
  reader.read("network", route.network, "a name of networks/");
  reader.read("edges", route.edges, "a list of SUMO edges");
  reader.read("start_offset", route.start_offset, "a number [m]");
  reader.read("end_offset", route.end_offset, "a number [m]");
  reader.choice("manoeuvre", route.manoeuvre, manoeuvres());
  reader.read("turn", route.turn, "a number [deg]");
  reader.read("length", route.length, "a number [m]");
  reader.read("conflicts", route.conflicts, "a whole number");
  reader.choice("density", route.density, densities());
  reader.read("seed", route.seed, "a whole number");
  reader.finish();
  return route;
}

void requireFile(const fs::path& manifest, const SuiteRoute& route, const char* what,
                 const fs::path& file) {
  if (core::isFile(file)) return;
  throw InputError("suite '" + manifest.string() + "', route '" + route.name + "': its " + what +
                   " '" + file.string() + "' is missing; restore it, or make the suite again");
}

YAML::Node parse(const fs::path& file) {
  try {
    return YAML::Load(core::readFile(file, "suite", core::kLargestOptionsFile));
  } catch (const YAML::Exception& error) {
    throw InputError("suite '" + file.string() + "', line " + std::to_string(error.mark.line + 1) +
                     ": " + error.msg);
  }
}

void readRoutes(const fs::path& file, EntryReader& reader, Suite& suite) {
  const YAML::Node routes = reader.child("routes");
  if (!routes || !routes.IsSequence() || routes.size() == 0)
    reader.fail("key 'routes': expected a list of routes");
  std::set<std::string> names;
  for (const YAML::Node& node : routes) {
    const SuiteRoute route = readRoute(file, node);
    if (!names.insert(route.name).second)
      EntryReader(file, node).fail("a second route is called '" + route.name + "'");
    requireFile(file, route, "network", suite.networkFile(route));
    requireFile(file, route, "scenario", suite.scenarioFile(route));
    suite.routes.push_back(route);
  }
}

std::string routeLine(const SuiteRoute& route) {
  return "  - {name: " + route.name + ", network: " + route.network + ", edges: [" +
         core::joinText(route.edges, ", ") +
         "], start_offset: " + core::formatNumber(route.start_offset) +
         ", end_offset: " + core::formatNumber(route.end_offset) +
         ", manoeuvre: " + route.manoeuvre + ", turn: " + core::formatNumber(route.turn) +
         ", length: " + core::formatNumber(route.length) +
         ", conflicts: " + std::to_string(route.conflicts) + ", density: " + route.density +
         ", seed: " + std::to_string(route.seed) + "}\n";
}

}  // namespace

fs::path Suite::networkFile(const SuiteRoute& route) const {
  return folder / "networks" / route.network / (route.network + ".net.xml");
}

fs::path Suite::scenarioFile(const SuiteRoute& route) const {
  return folder / "scenarios" / (route.name + ".yaml");
}

Suite loadSuite(const std::string& name_or_folder) {
  Suite suite;
  suite.folder = findSuite(name_or_folder);
  if (hasSeal(suite.folder)) requireIntactSeal(suite.folder);
  const fs::path file = suite.folder / kManifest;
  EntryReader reader(file, parse(file));
  int version = 0;
  reader.read("schema_version", version, "1");
  if (version != 1) reader.fail("key 'schema_version': expected 1");
  reader.read("name", suite.name, "a text");
  reader.read("seed", suite.seed, "a whole number");
  if (reader.has("sealed")) reader.read("sealed", suite.sealed, "true or false");
  if (suite.sealed != hasSeal(suite.folder))
    reader.fail(std::string("key 'sealed' and the file ") + kSealFile +
                " go together; one of them is missing: restore the folder from the repository");
  readRoutes(file, reader, suite);
  reader.finish();
  return suite;
}

std::vector<std::string> scenarioFiles(const Suite& suite) {
  std::vector<std::string> files;
  for (const SuiteRoute& route : suite.routes)
    files.push_back(fs::weakly_canonical(suite.scenarioFile(route)).string());
  return files;
}

std::vector<std::string> shippedSuites() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(suitesFolder(), none)) {
    if (fs::exists(entry.path() / kManifest)) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void requireForTraining(const Suite& suite) {
  const std::vector<std::string> shipped = shippedSuites();
  const bool ships = std::find(shipped.begin(), shipped.end(), suite.name) != shipped.end();
  if (!ships && !suite.sealed) return;
  throw InputError("suite '" + suite.name +
                   "' is for evaluation: nothing is trained on it and no training data may come "
                   "from it; make one of your own (cdiff suite train --results FOLDER)");
}

void requireForTraining(const std::vector<std::string>& scenarios) {
  std::set<fs::path> folders;
  for (const std::string& scenario : scenarios) {
    if (!core::isFile(scenario)) continue;
    const fs::path folder = fs::weakly_canonical(scenario).parent_path().parent_path();
    if (core::isFile(folder / kManifest) && folders.insert(folder).second)
      requireForTraining(loadSuite(folder.string()));
  }
}

std::string manifestText(const Suite& suite) {
  std::string text =
      "# SPDX-License-Identifier: BSD-3-Clause\n"
      "# Copyright (c) 2026 The e2e_cdiff authors\n"
      "#\n# Routes of a suite: offsets and lengths in m, turns in degrees (positive left); "
      "docs/suites.md.\n\nschema_version: 1\nname: " +
      suite.name + "\nseed: " + std::to_string(suite.seed) + "\nroutes:\n";
  for (const SuiteRoute& route : suite.routes) text += routeLine(route);
  return text;
}

}  // namespace cdiff::suite
