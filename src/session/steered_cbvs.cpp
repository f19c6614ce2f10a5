// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/steered_cbvs.h"

#include <algorithm>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "session/session_request.h"

namespace cdiff::session {
namespace {

using core::InputError;

constexpr double kLeastTargetSpeed = 0.5;     // as the scenario's [m/s]
constexpr double kLargestTargetSpeed = 40.0;  // likewise

bool isWeight(const std::string& what) { return what.rfind(steered::kWeight, 0) == 0; }

std::string objectiveOf(const std::string& what) {
  return what.substr(std::string(steered::kWeight).size());
}

guidance::GuidanceOptions shippedProfile(const std::string& name) {
  const std::vector<std::string> known = guidance::shippedProfiles();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw InputError("profile '" + core::shortened(name) + "' is no shipped one; expected one of " +
                     core::joinText(known, ", ") + core::didYouMean(name, known));
  }
  return guidance::loadProfile(name);
}

double targetSpeedFrom(const std::string& text) {
  const auto speed = core::parseNumber(text);
  if (speed && *speed >= kLeastTargetSpeed && *speed <= kLargestTargetSpeed) return *speed;
  throw InputError("target_speed '" + core::shortened(text) + "'; expected a number in [" +
                   core::formatNumber(kLeastTargetSpeed) + ", " +
                   core::formatNumber(kLargestTargetSpeed) + "] m/s");
}

/// The profile that a scenario's CBVs begin with; a recording's method may no longer be shipped.
std::string firstProfile(const ScenarioOptions& options) {
  if (!options.guidance_profile.empty()) return options.guidance_profile;
  const std::vector<std::string> methods = shippedMethods();
  if (std::find(methods.begin(), methods.end(), options.method) == methods.end()) return "";
  return loadMethod(options.method).profileOf(options.mode);
}

}  // namespace

SteeredCbvs::SteeredCbvs(const ScenarioOptions& options)
    : options_(options),
      now_{options.mode, firstProfile(options), options.guidance, std::nullopt} {}

bool SteeredCbvs::concerns(const std::string& what) {
  return what == steered::kProfile || what == steered::kMode || what == steered::kTargetSpeed ||
         isWeight(what);
}

void SteeredCbvs::apply(const std::string& what, const std::string& value, State& state) const {
  if (what == steered::kTargetSpeed) {
    state.target_speed = targetSpeedFrom(value);
    return;
  }
  if (!planners::canBeGuided(options_.cbv_planner)) {
    throw InputError(what + " steers guidance, and cbv_planner '" + options_.cbv_planner +
                     "' is not guided; expected one of " +
                     core::joinText(planners::guidedPlannerNames(), ", "));
  }
  if (what == steered::kProfile) {
    state.guidance = shippedProfile(value);
    state.profile = value;
  } else if (what == steered::kMode) {
    ScenarioOptions checked;
    core::overrideOption("mode=" + value, "steering", checked);
    state.mode = checked.mode;
    state.profile = loadMethod(options_.method).profileOf(state.mode);
    state.guidance = guidance::loadProfile(state.profile);
  } else {
    state.guidance.find(objectiveOf(what));
    core::overrideOption(objectiveOf(what) + ".weight=" + value, "steering", state.guidance);
  }
}

std::string SteeredCbvs::valueOf(const std::string& what, const State& state) const {
  if (what == steered::kProfile) return state.profile;
  if (what == steered::kMode) return state.mode;
  if (what == steered::kTargetSpeed) {
    if (state.target_speed) return core::formatNumber(*state.target_speed);
    return options_.cbv_target_speed.drawn() ? "drawn" : core::formatNumber(options_.target_speed);
  }
  const std::string objective = objectiveOf(what);
  for (const guidance::WeightedObjective& entry : state.guidance.objectives) {
    if (entry.name == objective) return core::formatNumber(entry.weight);
  }
  return "";
}

traffic::SteeringChange SteeredCbvs::changeBy(const SteeringRequest& request) const {
  State after = now_;
  apply(request.what, request.value, after);
  return {request.by, request.what, valueOf(request.what, now_), valueOf(request.what, after)};
}

bool SteeredCbvs::follow(const traffic::SteeringChange& change) {
  if (!concerns(change.what)) return false;
  apply(change.what, change.after, now_);
  return change.what != steered::kTargetSpeed;
}

namespace {

std::string entryPlace(std::size_t index) {
  return "key 'steering[" + std::to_string(index) + "]': ";
}

void validateEntry(const SteeringEntry& entry, const SteeredCbvs& cbvs) {
  const std::vector<SteeringRequest> requests = requestsOf(entry);
  if (requests.empty()) {
    throw InputError(
        "it changes nothing; expected one of profile, mode, objective, target_speed, choose, "
        "release, remove, place");
  }
  if (entry.objective.empty() && entry.weight != 0.0)
    throw InputError("'weight' is given; expected 'objective' beside it");
  const bool has_place = !entry.lane.empty() || entry.position != 0.0 || entry.speed != 0.0;
  if (entry.place.empty() && has_place)
    throw InputError("'lane', 'position' or 'speed' is given; expected 'place' beside it");
  for (const SteeringRequest& request : requests) {
    if (SteeredCbvs::concerns(request.what)) cbvs.changeBy(request);
    const bool traffic = request.what == steered::kPlace || request.what == steered::kRemove;
    if (traffic && entry.at <= 0.0)
      throw InputError(
          "'at' is 0, and a session begins with the traffic of its scenario; "
          "expected a later time");
  }
}

}  // namespace

void validateSteering(const ScenarioOptions& options) {
  if (options.steering.empty()) return;
  const SteeredCbvs cbvs(options);
  for (std::size_t i = 0; i < options.steering.size(); ++i) {
    try {
      validateEntry(options.steering[i], cbvs);
    } catch (const InputError& error) {
      throw InputError(entryPlace(i) + error.what());
    }
  }
}

}  // namespace cdiff::session
