// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_plan.h"

#include <link.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/matrix.h"
#include "evaluation/suite_selection.h"
#include "map/import/network_import.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"
#include "session/closed_loop.h"
#include "session/demand_file.h"
#include "session/session_request.h"
#include "session/unfit_combination.h"
#include "storyboard/scenario_reader.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::InputError;

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
  for (const plugins::PluginLibrary& plugin : plugins::findPlugins())
    parts["plug-in " + core::sha256(core::readFile(plugin.file, "plug-in"))] = plugin.file;
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

const std::string& InputHasher::ofStoryboard(const std::string& file) {
  std::string& hash = storyboards_[file];
  if (!hash.empty()) return hash;
  core::Sha256 all;
  for (const std::string& part : storyboard::readScenario(file, true).files)
    all.update(ofFile(part, "OpenSCENARIO"));
  return hash = all.finish();
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
  if (session::hasDemandFile(options)) hashes["demand"] = ofFile(options.demand, "demand");
  if (!options.storyboard.file.empty())
    hashes["storyboard"] = ofStoryboard(options.storyboard.file);
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

std::string changedInputs(const InputHashes& before, const InputHashes& now,
                          const std::set<std::string>& others) {
  std::set<std::string> changed;
  for (const auto& [name, hash] : now) {
    const auto earlier = before.find(name);
    if (earlier == before.end() || earlier->second != hash) changed.insert(name);
  }
  for (const auto& [name, hash] : before) {
    if (now.count(name) == 0) changed.insert(name);
  }
  for (const std::string& name : others) changed.erase(name);
  return core::joinText({changed.begin(), changed.end()}, ", ");
}

namespace {

/// The names are checked as those of any scenario.
void checkPlanner(const std::string& key, const std::string& name) {
  if (name == planning::kExternalPlanner)
    throw InputError(key + " 'external' needs the node graph; a batch cannot run it");
}

/// Builds the product of all factors.
class RunPlanner {
 public:
  /// `skips_unfit`: whether levels that do not fit together are left out, not an error.
  RunPlanner(const MatrixOptions& matrix, const std::string& source, bool skips_unfit)
      : matrix_(matrix),
        source_(source),
        skips_unfit_(skips_unfit),
        combinations_(combinationsOf(matrix, source)),
        variants_(variantsOf(matrix, source)),
        named_(namedVariants(combinations_, variants_, source)) {
    checkSeeds(matrix.seeds, source);
  }

  std::vector<PlannedRun> plan() {
    const std::vector<ScenarioLevel> levels = scenarioLevels(matrix_, source_);
    requireFeasible(levels.size());
    for (const ScenarioLevel& level : levels) {
      for (const Combination& combination : combinations_) addVariants(level, combination);
    }
    if (runs_.empty()) throw InputError(leftOut().front());
    requireDistinct();
    nameRuns();
    return std::move(runs_);
  }

  /// A line for each reason to leave runs out.
  std::vector<std::string> leftOut() const {
    std::vector<std::string> lines;
    for (const auto& [reason, count] : unfit_) {
      lines.push_back(std::to_string(count) + (count == 1 ? " run" : " runs") + " of " + source_ +
                      ": " + reason);
    }
    return lines;
  }

 private:
  /// Checked before anything is resolved.
  void requireFeasible(std::size_t scenarios) const {
    const auto as_double = [](std::size_t count) { return static_cast<double>(count); };
    const double runs = as_double(scenarios) * as_double(combinations_.size()) *
                        as_double(variants_.size()) *
                        as_double(std::max<std::size_t>(1, matrix_.seeds.size())) *
                        static_cast<double>(matrix_.repetitions);
    if (runs <= as_double(kMostRuns)) return;
    throw InputError(source_ + ": " + core::formatFixed(runs, 0) + " runs would be planned (" +
                     std::to_string(scenarios) + " scenarios x " +
                     std::to_string(combinations_.size()) +
                     " combinations of planners, modes, "
                     "methods and profiles x " +
                     std::to_string(variants_.size()) + " variants x " +
                     std::to_string(std::max<std::size_t>(1, matrix_.seeds.size())) + " seeds x " +
                     std::to_string(matrix_.repetitions) + " repetitions); at most " +
                     std::to_string(kMostRuns) + " were expected: divide the matrix");
  }

  void addVariants(const ScenarioLevel& level, const Combination& combination) {
    for (const Variant& variant : variantsFor(combination, variants_, named_)) {
      ScenarioLevel next = level;
      next.request.ego_planner = combination.ego_planner;
      next.request.cbv_planner = combination.cbv_planner;
      next.request.mode = combination.mode;
      auto& set = next.request.set;
      const std::string& profile = combination.guidance_profile;
      if (!combination.method.empty()) set.push_back("method=" + combination.method);
      if (!profile.empty()) set.push_back("guidance_profile=" + profile);
      set.insert(set.end(), matrix_.set.begin(), matrix_.set.end());
      set.insert(set.end(), variant.set.begin(), variant.set.end());
      next.request.set_source =
          source_ + (variant.name.empty() ? ": set" : ": set or variant '" + variant.name + "'");
      addSeeds(next, variant.name);
    }
  }

  void addSeeds(const ScenarioLevel& level, const std::string& variant) {
    for (const PlannedRun& seeded : resolve(level)) {
      PlannedRun run = seeded;
      run.factors["variant"] = variant;
      for (std::int64_t repetition = 1; repetition <= matrix_.repetitions; ++repetition) {
        run.factors["repetition"] = std::to_string(repetition);
        runs_.push_back(run);
      }
    }
  }

  /// One run per seed. What else a scenario holds is resolved once.
  std::vector<PlannedRun> resolve(const ScenarioLevel& level) {
    const std::vector<std::string>& seeds = matrix_.seeds;
    try {
      session::SessionRequest request = level.request;
      if (!seeds.empty()) request.seed = seeds.front();
      session::ScenarioOptions options = session::resolveRequest(request);
      checkPlanner("ego_planner", options.ego_planner);
      checkPlanner("cbv_planner", options.cbv_planner);
      session::requireLockstep(options);
      std::vector<PlannedRun> runs = {runOf(level.label, options)};
      // An override of the seed ranks above the matrix's seeds.
      const bool overridden = std::any_of(
          request.set.begin(), request.set.end(),
          [](const std::string& assignment) { return assignment.rfind("seed=", 0) == 0; });
      for (std::size_t i = 1; i < seeds.size(); ++i) {
        if (!overridden) core::overrideOption("seed=" + seeds[i], "argument 'seed'", options);
        runs.push_back(runOf(level.label, options));
      }
      return runs;
    } catch (const session::UnfitCombination& error) {
      if (!skips_unfit_)
        throw InputError(source_ + ", scenario " + level.label + ": " + error.what());
      unfit_[error.what()] +=
          std::max<std::size_t>(1, seeds.size()) * static_cast<std::size_t>(matrix_.repetitions);
      return {};
    } catch (const InputError& error) {
      const std::string text = error.what();
      const bool named = text.rfind(source_, 0) == 0;
      throw InputError(named ? text : source_ + ", scenario " + level.label + ": " + text);
    }
  }

  PlannedRun runOf(const std::string& label, const session::ScenarioOptions& options) {
    const std::string& profile = options.guidance_profile;
    const session::MethodOptions method = session::loadMethod(options.method);
    PlannedRun run;
    run.factors = {{"scenario", label},
                   {"ego_planner", options.ego_planner},
                   {"cbv_planner", options.cbv_planner},
                   {"mode", options.mode},
                   {"method", options.method},
                   {"guidance_profile", profile.empty() ? method.profileOf(options.mode) : profile},
                   {"seed", std::to_string(options.seed)}};
    run.scenario_text = core::dumpOptions(options);
    run.scenario_sha256 = core::sha256(run.scenario_text);
    run.inputs = hasher_.hashes(options);
    return run;
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

  /// The scenario and the factors that vary, without those that say in every run the same as one
  /// before them, as the guidance profile repeats the mode where nothing else sets it.
  std::vector<std::string> namingFactors() const {
    std::vector<std::string> naming;
    for (const std::string& factor : factorNames()) {
      std::set<std::string> levels;
      for (const PlannedRun& run : runs_) levels.insert(run.factors.at(factor));
      const bool repeats = std::any_of(naming.begin(), naming.end(), [&](const std::string& other) {
        return std::all_of(runs_.begin(), runs_.end(), [&](const PlannedRun& run) {
          return run.factors.at(factor) == run.factors.at(other);
        });
      });
      if (factor == "scenario" || (levels.size() > 1 && !repeats)) naming.push_back(factor);
    }
    return naming;
  }

  /// The scenario first, then the levels of the factors that vary.
  void nameRuns() {
    const std::vector<std::string> naming = namingFactors();
    std::set<std::string> taken;
    for (PlannedRun& run : runs_) {
      std::vector<std::string> parts;
      for (const std::string& factor : naming) {
        const std::string& level = run.factors.at(factor);
        const bool number = factor == "seed" || factor == "repetition";
        parts.push_back(number ? factor + level : levelName(factor, level));
      }
      const std::string id = core::fileName(core::joinText(parts, "__"));
      run.id = id;
      for (int i = 2; !taken.insert(run.id).second; ++i) run.id = id + "__" + std::to_string(i);
    }
  }

  const MatrixOptions& matrix_;
  std::string source_;
  bool skips_unfit_;
  std::map<std::string, std::size_t> unfit_;  ///< runs that were left out, by reason
  InputHasher hasher_;
  std::vector<Combination> combinations_;
  std::vector<Variant> variants_;
  std::set<std::string> named_;  ///< variants that a combination names
  std::vector<PlannedRun> runs_;
};

}  // namespace

const std::vector<std::string>& factorNames() {
  static const std::vector<std::string> names = {"scenario", "ego_planner", "cbv_planner",
                                                 "mode",     "method",      "guidance_profile",
                                                 "variant",  "seed",        "repetition"};
  return names;
}

std::string levelName(const std::string& factor, const std::string& level) {
  const bool file = core::endsWith(level, ".yaml") || level.find('/') != std::string::npos;
  return file && factor != "variant" ? fs::path(level).stem().string() : level;
}

std::vector<PlannedRun> planRuns(const MatrixOptions& matrix, const std::string& source) {
  requireOpeningReason(matrix, source);
  return RunPlanner(matrix, source, false).plan();
}

std::vector<PlannedRun> planFittingRuns(const MatrixOptions& matrix, const std::string& source,
                                        std::vector<std::string>& left_out) {
  requireOpeningReason(matrix, source);
  RunPlanner planner(matrix, source, true);
  std::vector<PlannedRun> runs = planner.plan();
  left_out = planner.leftOut();
  return runs;
}

namespace {

/// Throws InputError unless a run has this level.
void requireLevel(const std::string& factor, const std::string& level,
                  const std::vector<PlannedRun>& plan) {
  std::set<std::string> levels;
  for (const PlannedRun& run : plan) levels.insert(run.factors.at(factor));
  if (levels.count(level) != 0) return;
  throw InputError("--only " + factor + "=" + level + ": no run of the matrix has it; levels are " +
                   core::joinText({levels.begin(), levels.end()}, ", "));
}

}  // namespace

ChosenLevels chosenLevels(const std::vector<std::string>& texts,
                          const std::vector<PlannedRun>& plan) {
  ChosenLevels chosen;
  const std::vector<std::string>& factors = factorNames();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string factor = text.substr(0, equals);
    const std::vector<std::string> levels = equals == std::string::npos
                                                ? std::vector<std::string>()
                                                : core::splitText(text.substr(equals + 1), ',');
    if (levels.empty() || std::find(factors.begin(), factors.end(), factor) == factors.end()) {
      throw InputError("--only '" + text + "': expected FACTOR=LEVEL[,LEVEL...] with a factor of " +
                       core::joinText(factors, ", "));
    }
    for (const std::string& level : levels) {
      requireLevel(factor, level, plan);
      chosen[factor].insert(level);
    }
  }
  return chosen;
}

bool isChosen(const PlannedRun& run, const ChosenLevels& levels) {
  return std::all_of(levels.begin(), levels.end(), [&run](const auto& factor) {
    return factor.second.count(run.factors.at(factor.first)) != 0;
  });
}

}  // namespace cdiff::evaluation
