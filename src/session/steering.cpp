// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/steering.h"

#include "core/text.h"
#include "core/yaml_text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {
namespace {

constexpr double kLastTime = 1e6;        // [s]
constexpr double kLargestWeight = 1000;  // as guidance::WeightedObjective
constexpr double kFastest = 60.0;        // [m/s]

}  // namespace

std::string toText(const PlacedVehicle& vehicle) {
  return vehicle.id + " " + vehicle.lane + " " + core::formatNumber(vehicle.position) + " " +
         core::formatNumber(vehicle.speed);
}

PlacedVehicle placedVehicle(const std::string& text) {
  const std::vector<std::string> parts = core::splitText(text, ' ');
  if (parts.size() == 4 && !parts[0].empty()) {
    const auto position = core::parseNumber(parts[2]);
    const auto speed = core::parseNumber(parts[3]);
    if (position && speed) return {parts[0], parts[1], *position, *speed};
  }
  throw core::InputError("a vehicle to place is '" + core::shortened(text) +
                         "'; expected 'ID LANE POSITION SPEED', e.g. 'probe edge_0 12.5 8'");
}

void SteeringEntry::describe(core::OptionsVisitor& visitor) {
  visitor.number({"at", "s", "Simulated time."}, at, 0.0, kLastTime);
  visitor.text({"profile", "", "Guidance profile of the CBVs from now on."}, profile, {});
  visitor.text({"mode", "", "Mode whose profile the CBVs follow from now on."}, mode, {});
  visitor.text({"objective", "", "Objective that gets `weight`."}, objective, {});
  visitor.number({"weight", "", "Its weight."}, weight, 0.0, kLargestWeight);
  visitor.number({"target_speed", "m/s", "Target speed of all CBVs."}, target_speed, 0.0, 40.0);
  visitor.text({"choose", "", "Vehicle that becomes a CBV."}, choose, {});
  visitor.text({"release", "", "CBV that becomes traffic again."}, release, {});
  visitor.text({"remove", "", "Vehicle that is taken away."}, remove, {});
  visitor.text({"place", "", "Vehicle that is added."}, place, {});
  visitor.text({"lane", "", "Lane that it is placed on."}, lane, {});
  visitor.number({"position", "m", "Place of its center along the lane."}, position, 0.0, 1e5);
  visitor.number({"speed", "m/s", "Its speed."}, speed, 0.0, kFastest);
}

std::vector<SteeringRequest> requestsOf(const SteeringEntry& entry) {
  std::vector<SteeringRequest> requests;
  const auto ask = [&](const std::string& what, const std::string& value) {
    if (!value.empty()) requests.push_back({traffic::kSteeredByScenario, what, value});
  };
  ask(steered::kProfile, entry.profile);
  ask(steered::kMode, entry.mode);
  if (!entry.objective.empty())
    ask(steered::kWeight + entry.objective, core::formatNumber(entry.weight));
  if (entry.target_speed > 0.0) ask(steered::kTargetSpeed, core::formatNumber(entry.target_speed));
  ask(steered::kChoose, entry.choose);
  ask(steered::kRelease, entry.release);
  ask(steered::kRemove, entry.remove);
  if (!entry.place.empty())
    ask(steered::kPlace, toText({entry.place, entry.lane, entry.position, entry.speed}));
  return requests;
}

SteeringEntry entryOf(const traffic::SteeringChange& change, double at) {
  SteeringEntry entry;
  entry.at = at;
  const std::string weight = steered::kWeight;
  if (change.what == steered::kProfile) entry.profile = change.after;
  if (change.what == steered::kMode) entry.mode = change.after;
  if (change.what == steered::kTargetSpeed)
    entry.target_speed = core::parseNumber(change.after).value_or(0.0);
  if (change.what.rfind(weight, 0) == 0) {
    entry.objective = change.what.substr(weight.size());
    entry.weight = core::parseNumber(change.after).value_or(0.0);
  }
  if (change.what == steered::kChoose) entry.choose = change.after;
  if (change.what == steered::kRelease) entry.release = change.before;
  if (change.what == steered::kRemove) entry.remove = change.before;
  if (change.what == steered::kPlace) {
    const PlacedVehicle vehicle = placedVehicle(change.after);
    entry.place = vehicle.id;
    entry.lane = vehicle.lane;
    entry.position = vehicle.position;
    entry.speed = vehicle.speed;
  }
  return entry;
}

std::string flowText(const SteeringEntry& entry) {
  std::string text = "{at: " + core::formatNumber(entry.at);
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += std::string(", ") + key + ": " + value;
  };
  const auto addText = [&](const char* key, const std::string& value) {
    if (!value.empty()) add(key, core::yamlQuoted(value));
  };
  addText("profile", entry.profile);
  addText("mode", entry.mode);
  addText("objective", entry.objective);
  if (!entry.objective.empty()) add("weight", core::formatNumber(entry.weight));
  if (entry.target_speed > 0.0) add("target_speed", core::formatNumber(entry.target_speed));
  addText("choose", entry.choose);
  addText("release", entry.release);
  addText("remove", entry.remove);
  addText("place", entry.place);
  if (!entry.place.empty()) {
    addText("lane", entry.lane);
    add("position", core::formatNumber(entry.position));
    add("speed", core::formatNumber(entry.speed));
  }
  return text + "}";
}

}  // namespace cdiff::session
