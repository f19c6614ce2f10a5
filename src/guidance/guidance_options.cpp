// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/guidance/guidance_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "guidance/objective_registry.h"

namespace cdiff::guidance {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr double kLargestWeight = 1000.0;
constexpr double kLargestCap = 1e6;
constexpr double kLeastRegion = 0.01;     // of trust_region, in units of r_k
constexpr double kLargestRegion = 100.0;  // likewise
constexpr std::int64_t kLastDiffusionStep = 10000;
constexpr std::int64_t kMostCandidates = 64;
constexpr double kLongestHorizon = 10.0;  // of road_horizon [s]

fs::path profileFolder() { return core::shareFolder() / "config" / "guidance"; }

/// Checks a value that code may have set without describe(), which checks what is loaded.
void requireRange(const std::string& key, double value, double maximum) {
  if (value >= 0.0 && value <= maximum) return;
  throw InputError("key '" + key + "' is " + core::formatNumber(value) +
                   "; expected a number in [0, " + core::formatNumber(maximum) + "]");
}

void validateEntry(const WeightedObjective& entry, const std::string& group) {
  requireRange(group + entry.name + ".weight", entry.weight, kLargestWeight);
  requireRange(group + entry.name + ".gradient_cap", entry.gradient_cap, kLargestCap);
  if (entry.last_step < 1 || (entry.first_step != 0 && entry.first_step < entry.last_step)) {
    throw InputError("key '" + group + entry.name + ".first_step' is " +
                     std::to_string(entry.first_step) + " and last_step is " +
                     std::to_string(entry.last_step) +
                     "; diffusion steps count down: expected first_step >= last_step >= 1, or "
                     "first_step 0 to act from the first step on");
  }
  try {
    entry.objective->validate();
  } catch (const InputError& error) {
    throw InputError("objective '" + entry.name + "': " + error.what());
  }
}

/// Throws InputError when a bound of a window exceeds K.
void requireStep(const std::string& key, std::int64_t step, int diffusion_steps) {
  if (step <= diffusion_steps) return;
  throw InputError("key '" + key + "' is " + std::to_string(step) + "; expected at most " +
                   std::to_string(diffusion_steps) + ", the model's number of diffusion steps K");
}

/// Throws InputError when the sampler visits no diffusion step of the objective's window.
void requireVisit(const GuidanceOptions& options, const WeightedObjective& entry,
                  const std::string& group, const std::vector<int>& visited) {
  std::vector<std::string> names;
  for (const int step : visited) {
    if (options.acts(entry, step)) return;
    names.push_back(std::to_string(step));
  }
  const bool own = entry.last_step >= options.last_step;
  throw InputError("key '" + group + (own ? entry.name + "." : "") + "last_step' is " +
                   std::to_string(own ? entry.last_step : options.last_step) + " and first_step " +
                   (own ? "" : "of '" + entry.name + "' ") + "is " +
                   std::to_string(entry.first_step) +
                   "; the sampler visits none of these diffusion steps, so the objective would "
                   "never act; visited: " +
                   core::joinText(names, ", "));
}

}  // namespace

void WeightedObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"weight", "", "Weight in the sum; 0 switches the objective off."}, weight, 0.0,
                 kLargestWeight);
  visitor.integer({"first_step", "", "Acts at diffusion steps up to this one; 0: from the first."},
                  first_step, 0, kLastDiffusionStep);
  visitor.integer({"last_step", "", "Acts at diffusion steps down to this one."}, last_step, 1,
                  kLastDiffusionStep);
  visitor.number(
      {"gradient_cap", "", "Largest norm of weight x gradient in normalized units; 0: none."},
      gradient_cap, 0.0, kLargestCap);
  objective->describe(visitor);
}

GuidanceOptions::GuidanceOptions() {
  for (const std::string& name : objectiveNames()) {
    WeightedObjective entry;
    entry.name = name;
    entry.objective = makeObjective(name);
    objectives.push_back(std::move(entry));
  }
}

GuidanceOptions::GuidanceOptions(const GuidanceOptions& other)
    : trust_region(other.trust_region),
      last_step(other.last_step),
      noise_correlation(other.noise_correlation),
      candidates(other.candidates),
      road_horizon(other.road_horizon),
      challenge(other.challenge) {
  for (const WeightedObjective& entry : other.objectives) {
    objectives.push_back({entry.name, entry.weight, entry.first_step, entry.last_step,
                          entry.gradient_cap, entry.objective->clone()});
  }
}

GuidanceOptions& GuidanceOptions::operator=(const GuidanceOptions& other) {
  GuidanceOptions copy(other);
  objectives = std::move(copy.objectives);
  trust_region = copy.trust_region;
  last_step = copy.last_step;
  noise_correlation = copy.noise_correlation;
  candidates = copy.candidates;
  road_horizon = copy.road_horizon;
  challenge = copy.challenge;
  return *this;
}

WeightedObjective& GuidanceOptions::find(const std::string& name) {
  std::vector<std::string> known;
  for (WeightedObjective& entry : objectives) {
    if (entry.name == name) return entry;
    known.push_back(entry.name);
  }
  throw InputError("unknown guidance objective '" + name + "'; the nearest known objective is '" +
                   core::nearestName(name, known) + "'");
}

bool GuidanceOptions::isActive(const std::string& name) const {
  return std::any_of(objectives.begin(), objectives.end(), [&](const WeightedObjective& entry) {
    return entry.name == name && entry.weight > 0.0;
  });
}

void GuidanceOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number(
      {"trust_region", "",
       "Farthest that a step of sampler mode real_time moves an action, in units of r_k."},
      trust_region, kLeastRegion, kLargestRegion);
  visitor.integer({"last_step", "",
                   "No objective acts at diffusion steps below this one, whatever its window."},
                  last_step, 1, kLastDiffusionStep);
  visitor.number({"noise_correlation", "",
                  "Correlation of a vehicle's noise between any two of its decisions."},
                 noise_correlation, 0.0, 1.0);
  visitor.integer({"candidates", "", "Samples per vehicle and decision; the best of them drives."},
                  candidates, 1, kMostCandidates);
  visitor.number({"road_horizon", "s",
                  "Candidates that keep on the road for so long come first; 0: no such rule."},
                 road_horizon, 0.0, kLongestHorizon);
  visitor.text(
      {"challenge", "",
       "Candidates must be answerable by a careful driver in the ego's place, with so much "
       "to spare; off: no such rule."},
      challenge, {"off", "easy", "medium", "hard"});
  for (WeightedObjective& entry : objectives) {
    visitor.group({entry.name.c_str(), "", objectiveText(entry.name)}, entry);
  }
}

void GuidanceOptions::validate(const std::string& group) const {
  if (!(trust_region >= kLeastRegion && trust_region <= kLargestRegion)) {
    throw InputError("key '" + group + "trust_region' is " + core::formatNumber(trust_region) +
                     "; expected a number in [0.01, 100]");
  }
  if (last_step < 1) {
    throw InputError("key '" + group + "last_step' is " + std::to_string(last_step) +
                     "; diffusion steps count down to 1, so at least 1 is expected");
  }
  if (!(noise_correlation >= 0.0 && noise_correlation <= 1.0)) {
    throw InputError("key '" + group + "noise_correlation' is " +
                     core::formatNumber(noise_correlation) + "; expected a number in [0, 1]");
  }
  if (candidates < 1 || candidates > kMostCandidates) {
    throw InputError("key '" + group + "candidates' is " + std::to_string(candidates) +
                     "; expected an integer in [1, " + std::to_string(kMostCandidates) + "]");
  }
  requireRange(group + "road_horizon", road_horizon, kLongestHorizon);
  for (const WeightedObjective& entry : objectives) validateEntry(entry, group);
}

void GuidanceOptions::validateWindows(int diffusion_steps, const std::vector<int>& visited,
                                      const std::string& group) const {
  for (const WeightedObjective& entry : objectives) {
    if (!(entry.weight > 0.0)) continue;
    const std::string key = group + entry.name;
    requireStep(key + ".first_step", entry.first_step, diffusion_steps);
    requireStep(key + ".last_step", entry.last_step, diffusion_steps);
    requireStep(group + "last_step", last_step, diffusion_steps);
    requireVisit(*this, entry, group, visited);
  }
}

GuidanceOptions loadProfile(const std::string& name_or_file) {
  const fs::path file = core::shippedOrFile(profileFolder(), name_or_file, "guidance profile");
  GuidanceOptions options;
  core::loadOptions(
      {file.string(), core::readFile(file, "guidance profile", core::kLargestOptionsFile)},
      options);
  try {
    options.validate();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return options;
}

std::vector<std::string> shippedProfiles() { return core::shippedNames(profileFolder()); }

}  // namespace cdiff::guidance
