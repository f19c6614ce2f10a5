// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/evaluation/run_plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/map/route_source.h"
#include "e2e_cdiff/planning/planner_factory.h"
#include "e2e_cdiff/scenario/session_request.h"
#include "e2e_cdiff/suite/suite.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::InputError;

/// One level of the factor scenario.
struct ScenarioLevel {
  std::string label;
  scenario::SessionRequest request;
};

struct Variant {
  std::string name;
  std::vector<std::string> set;
};

std::vector<ScenarioLevel> bench2DriveLevels(const Bench2DriveOptions& options) {
  std::vector<ScenarioLevel> levels;
  std::vector<std::string> missing = options.routes;
  for (const map::Bench2DriveEntry& entry : map::listBench2DriveRoutes(options.file)) {
    const auto& wanted = options.routes;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), entry.id) == wanted.end())
      continue;
    const fs::path network = fs::path(options.networks) / (entry.town + ".net.xml");
    if (!fs::exists(network)) continue;
    missing.erase(std::remove(missing.begin(), missing.end(), entry.id), missing.end());
    scenario::SessionRequest request;
    request.bench2drive = options.file;
    request.route = entry.id;
    request.network = network.string();
    levels.push_back({entry.id, request});
  }
  if (!missing.empty()) {
    throw InputError("routes " + core::joinText(missing, ", ") + " are not in '" + options.file +
                     "', or the network of their town is not in '" + options.networks + "'");
  }
  if (levels.empty()) {
    throw InputError("no route of '" + options.file +
                     "' lies in a town whose TOWN.net.xml is in '" + options.networks + "'");
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

std::vector<ScenarioLevel> scenarioLevels(const MatrixOptions& matrix, const std::string& source) {
  std::vector<ScenarioLevel> levels;
  for (const std::string& name : scenariosOf(matrix)) {
    scenario::SessionRequest request;
    request.scenario = name;
    levels.push_back({fs::is_regular_file(name) ? fs::path(name).stem().string() : name, request});
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

/// Levels of the factors that are chosen together.
struct Combination {
  std::string ego_planner;
  std::string cbv_planner;
  std::string mode;
  std::string guidance_profile;
};

Combination combinationOf(const std::string& text, const std::string& source) {
  Combination combination;
  std::map<std::string, std::string*> fields = {
      {"ego_planner", &combination.ego_planner},
      {"cbv_planner", &combination.cbv_planner},
      {"mode", &combination.mode},
      {"guidance_profile", &combination.guidance_profile}};
  for (const std::string& word : core::splitText(text, ' ')) {
    const std::size_t equals = word.find('=');
    const auto field = fields.find(word.substr(0, equals));
    if (equals == std::string::npos || field == fields.end() || !field->second->empty()) {
      throw InputError(source + ": key 'combinations' holds '" + text + "', where '" + word +
                       "' is wrong; expected ego_planner=, cbv_planner=, mode= and "
                       "guidance_profile=, each once at most");
    }
    *field->second = word.substr(equals + 1);
  }
  return combination;
}

/// A product of lists, of which an empty one leaves the factor as the scenario has it.
std::vector<Combination> productOf(const MatrixOptions& matrix) {
  const auto levels = [](const std::vector<std::string>& given) {
    return given.empty() ? std::vector<std::string>{""} : given;
  };
  std::vector<Combination> product;
  for (const std::string& ego : levels(matrix.ego_planners)) {
    for (const std::string& cbv : levels(matrix.cbv_planners)) {
      for (const std::string& mode : levels(matrix.modes)) {
        for (const std::string& profile : levels(matrix.guidance_profiles))
          product.push_back({ego, cbv, mode, profile});
      }
    }
  }
  return product;
}

std::vector<Combination> combinationsOf(const MatrixOptions& matrix, const std::string& source) {
  if (matrix.combinations.empty()) return productOf(matrix);
  for (const auto* list :
       {&matrix.ego_planners, &matrix.cbv_planners, &matrix.modes, &matrix.guidance_profiles}) {
    if (list->empty()) continue;
    throw InputError(source +
                     ": key 'combinations' stands instead of ego_planners, cbv_planners, modes "
                     "and guidance_profiles; give either it or them");
  }
  std::vector<Combination> combinations;
  for (const std::string& text : matrix.combinations)
    combinations.push_back(combinationOf(text, source));
  return combinations;
}

void checkSeeds(const std::vector<std::string>& seeds, const std::string& source) {
  for (const std::string& seed : seeds) {
    const bool digits = !seed.empty() && seed.find_first_not_of("0123456789") == std::string::npos;
    if (digits && seed.size() <= 10) continue;  // its range is that of the scenario's key
    throw InputError(source + ": key 'seeds' holds '" + seed +
                     "'; expected whole numbers from 0 on, e.g. [1, 2, 3]");
  }
}

/// The names are checked as those of any scenario.
void checkEgoPlanner(const std::string& name) {
  if (name == "external")
    throw InputError("ego_planner 'external' needs the node graph; a batch cannot run it");
}

/// Builds the product of all factors.
class Planner {
 public:
  Planner(const MatrixOptions& matrix, const std::string& source)
      : matrix_(matrix),
        source_(source),
        combinations_(combinationsOf(matrix, source)),
        variants_(variantsOf(matrix, source)) {
    checkSeeds(matrix.seeds, source);
  }

  std::vector<PlannedRun> plan() {
    for (const ScenarioLevel& level : scenarioLevels(matrix_, source_)) {
      for (const Combination& combination : combinations_) addVariants(level, combination);
    }
    requireDistinct();
    nameRuns();
    return std::move(runs_);
  }

 private:
  void addVariants(const ScenarioLevel& level, const Combination& combination) {
    for (const Variant& variant : variants_) {
      ScenarioLevel next = level;
      next.request.ego_planner = combination.ego_planner;
      next.request.cbv_planner = combination.cbv_planner;
      next.request.mode = combination.mode;
      auto& set = next.request.set = matrix_.set;
      const std::string& profile = combination.guidance_profile;
      if (!profile.empty()) set.push_back("guidance_profile=" + profile);
      set.insert(set.end(), variant.set.begin(), variant.set.end());
      next.request.set_source =
          source_ + (variant.name.empty() ? ": set" : ": set or variant '" + variant.name + "'");
      addSeeds(next, variant.name);
    }
  }

  void addSeeds(const ScenarioLevel& level, const std::string& variant) {
    const std::vector<std::string> as_given = {""};
    for (const std::string& seed : matrix_.seeds.empty() ? as_given : matrix_.seeds) {
      scenario::SessionRequest request = level.request;
      request.seed = seed;
      PlannedRun run = resolve(level.label, request);
      run.factors["variant"] = variant;
      for (std::int64_t repetition = 1; repetition <= matrix_.repetitions; ++repetition) {
        run.factors["repetition"] = std::to_string(repetition);
        runs_.push_back(run);
      }
    }
  }

  PlannedRun resolve(const std::string& label, const scenario::SessionRequest& request) const {
    try {
      const scenario::ScenarioOptions options = scenario::resolveRequest(request);
      checkEgoPlanner(options.ego_planner);
      const std::string& profile = options.guidance_profile;
      PlannedRun run;
      run.factors = {{"scenario", label},
                     {"ego_planner", options.ego_planner},
                     {"cbv_planner", options.cbv_planner},
                     {"mode", options.mode},
                     {"guidance_profile", profile.empty() ? options.mode : profile},
                     {"seed", std::to_string(options.seed)}};
      run.scenario_text = core::dumpOptions(options);
      run.scenario_sha256 = core::sha256(run.scenario_text);
      return run;
    } catch (const InputError& error) {
      const std::string text = error.what();
      throw InputError(text.rfind(source_, 0) == 0 ? text
                                                   : source_ + ", scenario " + label + ": " + text);
    }
  }

  /// A run that is there twice would count twice.
  void requireDistinct() const {
    std::set<std::map<std::string, std::string>> seen;
    for (const PlannedRun& run : runs_) {
      if (seen.insert(run.factors).second) continue;
      std::vector<std::string> levels;
      for (const std::string& factor : factorNames()) {
        const std::string& level = run.factors.at(factor);
        if (!level.empty()) levels.push_back(factor + " " + level);
      }
      throw InputError(source_ + ": a run is planned twice: " + core::joinText(levels, ", ") +
                       "; give every level once and every variant and scenario file a name of its "
                       "own (repetitions: 2 runs each twice)");
    }
  }

  /// The scenario first, then the levels of the factors that vary.
  void nameRuns() {
    std::map<std::string, std::set<std::string>> levels;
    for (const PlannedRun& run : runs_) {
      for (const auto& [factor, level] : run.factors) levels[factor].insert(level);
    }
    std::set<std::string> taken;
    for (PlannedRun& run : runs_) {
      std::vector<std::string> parts = {run.factors.at("scenario")};
      for (const std::string& factor : factorNames()) {
        if (factor == "scenario" || levels[factor].size() < 2) continue;
        const std::string& level = run.factors.at(factor);
        const bool number = factor == "seed" || factor == "repetition";
        parts.push_back(number ? factor + level : fs::path(level).stem().string());
      }
      const std::string id = core::fileName(core::joinText(parts, "__"));
      run.id = id;
      for (int i = 2; !taken.insert(run.id).second; ++i) run.id = id + "__" + std::to_string(i);
    }
  }

  const MatrixOptions& matrix_;
  std::string source_;
  std::vector<Combination> combinations_;
  std::vector<Variant> variants_;
  std::vector<PlannedRun> runs_;
};

}  // namespace

const std::vector<std::string>& factorNames() {
  static const std::vector<std::string> names = {"scenario", "ego_planner",      "cbv_planner",
                                                 "mode",     "guidance_profile", "variant",
                                                 "seed",     "repetition"};
  return names;
}

std::vector<PlannedRun> planRuns(const MatrixOptions& matrix, const std::string& source) {
  return Planner(matrix, source).plan();
}

}  // namespace cdiff::evaluation
