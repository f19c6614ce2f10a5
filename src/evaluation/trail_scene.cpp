// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/trail_scene.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/json_file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_plan.h"
#include "evaluation/run_record.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

using nlohmann::json;
using record::TraceRow;
using traffic::VehicleRole;

/// Runs of one scene by planner.
using PlannersOfScene = std::map<std::string, const BatchRun*>;

/// How well a scene shows planners of egos: how many there are, and their mean score, negative.
std::pair<std::ptrdiff_t, double> rankOfEgos(const PlannersOfScene& scene) {
  double sum = 0.0;
  for (const auto& [planner, run] : scene)
    sum += run->number(metrics::known::kDrivingScore.place).value_or(0.0);
  return {scene.size(), -sum / static_cast<double>(scene.size())};
}

/// How well a scene shows planners: how many drove a CBV, and their smallest distance, negative.
std::pair<std::ptrdiff_t, double> rankOfScene(const PlannersOfScene& scene, TrailsOf who) {
  if (who == TrailsOf::kEgo) return rankOfEgos(scene);
  std::ptrdiff_t driven = 0;
  double nearest = 1e9;
  for (const auto& [planner, run] : scene) {
    const auto distance = run->number(metrics::known::kCbvMinimumDistance.place);
    driven += distance.has_value();
    nearest = std::min(nearest, distance.value_or(nearest));
  }
  return {driven, -nearest};
}

/// Empty where no scene was driven by two planners.
PlannersOfScene bestScene(const std::vector<BatchRun>& runs, TrailsOf who) {
  std::map<Factors, PlannersOfScene> scenes;
  for (const BatchRun& run : runs) {
    if (run.record.complete())
      scenes[sceneOf(run, who)].emplace(run.record.factors.at(factorOf(who)), &run);
  }
  PlannersOfScene best;
  for (const auto& [factors, scene] : scenes) {
    if (scene.size() < 2) continue;
    if (best.empty() || rankOfScene(scene, who) > rankOfScene(best, who)) best = scene;
  }
  return best;
}

const TraceRow* lastRowAsCbv(const std::vector<TraceRow>& rows, const json& selection) {
  const std::string id = selection.at("vehicle_id");
  const std::uint64_t begin = selection.at("selected_tick");
  const json& released = selection.at("released_tick");
  const std::uint64_t end = released.is_null() ? rows.back().tick : released.get<std::uint64_t>();
  const TraceRow* last = nullptr;
  for (const TraceRow& row : rows) {
    const bool within = begin <= row.tick && row.tick <= end;
    if (within && row.role == VehicleRole::kCbv && row.id == id) last = &row;
  }
  return last;
}

/// A CBV that touches a vehicle other than the ego is gone at the next tick: the contact is midway
/// between where the two were last.
std::optional<TouchPlace> touchOf(const json& selection, const std::vector<TraceRow>& rows) {
  const json& partner = selection.at("contact_with");
  if (partner.is_null() || partner == traffic::kEgoId || rows.empty()) return std::nullopt;
  const TraceRow* last = lastRowAsCbv(rows, selection);
  if (last == nullptr) return std::nullopt;
  TouchPlace touch{last->tick, last->id, partner.get<std::string>(), last->position};
  for (const TraceRow& row : rows) {
    if (row.tick == touch.tick && row.id == touch.partner)
      touch.position = 0.5 * (last->position + row.position);
  }
  return touch;
}

/// Those of the ego, then those of CBVs with others; of two CBVs once.
std::vector<TouchPlace> touchesIn(const json& summary, const std::vector<TraceRow>& rows) {
  std::vector<TouchPlace> touches;
  for (const json& contact : summary.at("ego").at("contacts")) {
    const Eigen::Vector2d place(contact.at("x").get<double>(), contact.at("y").get<double>());
    touches.push_back({contact.at("tick"), traffic::kEgoId, contact.at("with"), place});
  }
  for (const json& selection : summary.at("cbv").at("selections")) {
    const auto touch = touchOf(selection, rows);
    const auto same = [&](const TouchPlace& other) {
      return other.tick == touch->tick && other.vehicle == touch->partner &&
             other.partner == touch->vehicle;
    };
    if (touch && std::none_of(touches.begin(), touches.end(), same)) touches.push_back(*touch);
  }
  return touches;
}

DrivenScene drivenScene(const std::string& planner, const BatchRun& run) {
  DrivenScene scene{planner, &run, scenarioOf(run).simulation_step, {}, {}};
  scene.rows = record::readTrace(run.folder / "trace.csv");
  const auto file = run.folder / "summary.json";
  try {
    scene.touches = touchesIn(core::readJson(file, "summary"), scene.rows);
  } catch (const json::exception& error) {
    throw core::InputError("'" + file.string() +
                           "' is no summary of a session: " + core::jsonFault(error) +
                           "; expected the result of a session of this version");
  }
  return scene;
}

}  // namespace

std::string factorOf(TrailsOf who) { return who == TrailsOf::kEgo ? "ego_planner" : "cbv_planner"; }

Factors sceneOf(const BatchRun& run, TrailsOf who) {
  Factors scene = run.record.factors;
  scene.erase(factorOf(who));
  return scene;
}

std::vector<DrivenScene> chosenScene(const std::vector<BatchRun>& runs, TrailsOf who) {
  std::vector<DrivenScene> scenes;
  for (const auto& [planner, run] : bestScene(runs, who))
    scenes.push_back(drivenScene(planner, *run));
  return scenes;
}

}  // namespace cdiff::evaluation
