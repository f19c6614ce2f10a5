// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/matrix.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/suite_selection.h"
#include "suite/suite.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::InputError;

fs::path matrixFolder() { return core::shareFolder() / "config" / "evaluations"; }

bool isThere(const fs::path& path) { return core::isFile(path) || core::isFolder(path); }

/// A name stays when there is nothing of that name in the folder.
void resolveAgainst(const fs::path& folder, std::string& name) {
  if (name.empty() || fs::path(name).is_absolute() || !isThere(folder / name)) return;
  name = fs::weakly_canonical(folder / name).string();
}

}  // namespace

void Bench2DriveOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"file", "", "Bench2Drive route file; empty: none."}, file, {});
  visitor.text({"networks", "", "Folder with TOWN.net.xml files."}, networks, {});
  visitor.list({"routes", "", "Route ids, or dev10; empty: all whose town's network is there."},
               routes);
}

void MatrixOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"schema_version", "", "Version of this file format."}, schema_version, 1, 1);
  visitor.text({"name", "", "Name of the evaluation in results."}, name, {});
  visitor.list({"scenarios", "", "Shipped scenarios or scenario files."}, scenarios);
  visitor.text({"suite", "", "Shipped route suite or folder of one; each route a scenario."}, suite,
               {});
  visitor.text({"open_sealed", "", "Why a sealed suite is opened (docs/sealed_suites.md)."},
               open_sealed, {});
  visitor.group({"bench2drive", "", "Bench2Drive routes, each a scenario of its own."},
                bench2drive);
  visitor.list({"ego_planners", "", "Planners of the ego; empty: the scenario's."}, ego_planners);
  visitor.list({"cbv_planners", "", "Planners of the CBVs; empty: the scenario's."}, cbv_planners);
  visitor.list({"modes", "", "naturalistic, challenging, safety_critical; empty: the scenario's."},
               modes);
  visitor.list({"methods", "", "Shipped methods; empty: the scenario's."}, methods);
  visitor.list(
      {"guidance_profiles", "", "Guidance of the CBVs, shipped or a file; empty: the mode's."},
      guidance_profiles);
  visitor.list({"combinations", "",
                "Instead of the product of the five lists above: sets of their levels, each "
                "\"ego_planner=NAME cbv_planner=NAME mode=MODE method=NAME guidance_profile=NAME\" "
                "or a part of it; variant=NAME runs it with that variant, which the others then "
                "do without."},
               combinations);
  visitor.list({"variants", "", "Sets of overrides, each \"name: key=value key=value\"."},
               variants);
  visitor.list({"seeds", "", "Root seeds; empty: the scenario's."}, seeds);
  visitor.integer({"repetitions", "", "Runs of the same seed."}, repetitions, 1, 1000);
  visitor.list({"set", "", "Overrides for every run, each key=value."}, set);
  visitor.flag({"ego_ranking", "", "Also write ego_ranking.html: contacts of each ego, ranked."},
               ego_ranking);
  visitor.number({"timeout", "s", "Wall time after which a run is killed."}, timeout, 0.1, 86400.0);
  visitor.integer({"retries", "", "Further attempts when a run's process or SUMO died."}, retries,
                  0, 100);
}

MatrixOptions loadMatrix(const std::string& name_or_file) {
  const fs::path file = core::shippedOrFile(matrixFolder(), name_or_file, "evaluation");
  MatrixOptions matrix;
  matrix.name = file.stem().string();
  core::loadOptions({file.string(), core::readFile(file, "evaluation", core::kLargestOptionsFile)},
                    matrix);
  const fs::path folder = file.parent_path();
  for (std::string& scenario : matrix.scenarios) resolveAgainst(folder, scenario);
  for (std::string& profile : matrix.guidance_profiles) resolveAgainst(folder, profile);
  if (core::isFile(folder / matrix.suite / "suite.yaml")) resolveAgainst(folder, matrix.suite);
  resolveAgainst(folder, matrix.bench2drive.file);
  resolveAgainst(folder, matrix.bench2drive.networks);
  return matrix;
}

std::vector<std::string> shippedMatrices() { return core::shippedNames(matrixFolder()); }

std::string identityOf(const MatrixOptions& matrix) {
  const MatrixOptions defaults;
  MatrixOptions same = matrix;
  same.timeout = defaults.timeout;
  same.retries = defaults.retries;
  same.open_sealed = defaults.open_sealed;
  return core::dumpOptions(same);
}

namespace {

std::vector<ScenarioLevel> bench2DriveLevels(const Bench2DriveOptions& options) {
  std::vector<ScenarioLevel> levels;
  for (const auto& [id, network] : selectBench2Drive(options).routes) {
    session::SessionRequest request;
    request.bench2drive = options.file;
    request.route = id;
    request.network = network;
    levels.push_back({id, request});
  }
  return levels;
}

/// Those named, then those of the suite.
std::vector<std::string> scenariosOf(const MatrixOptions& matrix) {
  std::vector<std::string> scenarios = matrix.scenarios;
  if (matrix.suite.empty()) return scenarios;
  for (const std::string& file : suite::scenarioFiles(suite::loadSuite(matrix.suite)))
    scenarios.push_back(file);
  return scenarios;
}

Combination combinationOf(const std::string& text, const std::string& source) {
  Combination combination;
  std::map<std::string, std::string*> fields = {{"ego_planner", &combination.ego_planner},
                                                {"cbv_planner", &combination.cbv_planner},
                                                {"mode", &combination.mode},
                                                {"method", &combination.method},
                                                {"guidance_profile", &combination.guidance_profile},
                                                {"variant", &combination.variant}};
  for (const std::string& word : core::splitText(text, ' ')) {
    const std::size_t equals = word.find('=');
    const auto field = fields.find(word.substr(0, equals));
    if (equals == std::string::npos || field == fields.end() || !field->second->empty()) {
      throw InputError(source + ": key 'combinations' holds '" + text + "', where '" + word +
                       "' is wrong; expected ego_planner=, cbv_planner=, mode=, method=, "
                       "guidance_profile= and variant=, each once at most");
    }
    *field->second = word.substr(equals + 1);
  }
  return combination;
}

/// Lists of the factors that a combination holds.
std::vector<const std::vector<std::string>*> chosenTogether(const MatrixOptions& matrix) {
  return {&matrix.ego_planners, &matrix.cbv_planners, &matrix.modes, &matrix.methods,
          &matrix.guidance_profiles};
}

/// A product of lists, of which an empty one leaves the factor as the scenario has it.
std::vector<Combination> productOf(const MatrixOptions& matrix, const std::string& source) {
  double count = 1.0;
  for (const auto* list : chosenTogether(matrix))
    count *= static_cast<double>(std::max<std::size_t>(1, list->size()));
  if (count > static_cast<double>(kMostRuns)) {
    throw InputError(source + ": planners, modes, methods and profiles give " +
                     core::formatFixed(count, 0) + " combinations; at most " +
                     std::to_string(kMostRuns) + " runs were expected");
  }
  const auto levels = [](const std::vector<std::string>& given) {
    return given.empty() ? std::vector<std::string>{""} : given;
  };
  std::vector<Combination> product;
  for (const std::string& ego : levels(matrix.ego_planners)) {
    for (const std::string& cbv : levels(matrix.cbv_planners)) {
      for (const std::string& mode : levels(matrix.modes)) {
        for (const std::string& method : levels(matrix.methods)) {
          for (const std::string& profile : levels(matrix.guidance_profiles))
            product.push_back({ego, cbv, mode, method, profile});
        }
      }
    }
  }
  return product;
}

}  // namespace

namespace {

/// What tables call a scenario: its `name`. A file that cannot be loaded is refused when its runs
/// are resolved.
std::string labelOf(const std::string& scenario) {
  if (!core::isFile(scenario)) return scenario;
  try {
    return session::loadScenario(scenario).name;
  } catch (const InputError&) {
    return fs::path(scenario).stem().string();
  }
}

}  // namespace

std::vector<ScenarioLevel> scenarioLevels(const MatrixOptions& matrix, const std::string& source) {
  std::vector<ScenarioLevel> levels;
  for (const std::string& name : scenariosOf(matrix)) {
    session::SessionRequest request;
    request.scenario = name;
    levels.push_back({labelOf(name), request});
  }
  if (!matrix.bench2drive.file.empty()) {
    for (ScenarioLevel& level : bench2DriveLevels(matrix.bench2drive)) levels.push_back(level);
  }
  if (levels.empty()) {
    throw InputError(source +
                     ": the matrix is empty; give scenarios: [...], a suite or a bench2drive.file");
  }
  return levels;
}

std::vector<Variant> variantsOf(const MatrixOptions& matrix, const std::string& source) {
  std::vector<Variant> variants;
  for (const std::string& text : matrix.variants) {
    const std::size_t colon = text.find(':');
    const auto names = core::splitText(text.substr(0, colon), ' ');
    if (colon == std::string::npos || names.size() != 1) {
      throw InputError(source + ": key 'variants' holds '" + text +
                       "'; expected \"name: key=value key=value\"");
    }
    variants.push_back({names.front(), core::splitText(text.substr(colon + 1), ' ')});
  }
  if (variants.empty()) variants.emplace_back();
  return variants;
}

std::vector<Combination> combinationsOf(const MatrixOptions& matrix, const std::string& source) {
  if (matrix.combinations.empty()) return productOf(matrix, source);
  for (const auto* list : chosenTogether(matrix)) {
    if (list->empty()) continue;
    throw InputError(source +
                     ": key 'combinations' replaces ego_planners, cbv_planners, modes, methods "
                     "and guidance_profiles; give either it or them");
  }
  std::vector<Combination> combinations;
  for (const std::string& text : matrix.combinations)
    combinations.push_back(combinationOf(text, source));
  return combinations;
}

std::set<std::string> namedVariants(const std::vector<Combination>& combinations,
                                    const std::vector<Variant>& variants,
                                    const std::string& source) {
  std::set<std::string> named;
  for (const Combination& combination : combinations) {
    const std::string& name = combination.variant;
    if (name.empty()) continue;
    if (std::none_of(variants.begin(), variants.end(),
                     [&](const Variant& variant) { return variant.name == name; })) {
      throw InputError(source + ": key 'combinations' names variant '" + name +
                       "', which key 'variants' does not hold");
    }
    named.insert(name);
  }
  return named;
}

std::vector<Variant> variantsFor(const Combination& combination,
                                 const std::vector<Variant>& variants,
                                 const std::set<std::string>& named) {
  std::vector<Variant> chosen;
  for (const Variant& variant : variants) {
    const bool own = combination.variant.empty() ? named.count(variant.name) == 0
                                                 : variant.name == combination.variant;
    if (own) chosen.push_back(variant);
  }
  if (chosen.empty()) chosen.emplace_back();
  return chosen;
}

void checkSeeds(const std::vector<std::string>& seeds, const std::string& source) {
  for (const std::string& seed : seeds) {
    const bool digits = !seed.empty() && seed.find_first_not_of("0123456789") == std::string::npos;
    if (digits && seed.size() <= 10) continue;  // its range is that of the scenario's key
    throw InputError(source + ": key 'seeds' holds '" + seed +
                     "'; expected whole numbers from 0 on, e.g. [1, 2, 3]");
  }
}

}  // namespace cdiff::evaluation
