// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini_weights.h"

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {
namespace {

using inference::TensorList;

void addUniadTracks(const UniadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  list.add("table.track.content", {a.tracks, width});
  list.add("table.track.reference", {a.tracks, 2});
  list.add("table.ego.content", {1, width});
  list.mlp("place", 2, width, width);
  for (std::int64_t i = 0; i < a.decoder_layers; ++i) {
    const std::string name = "track." + std::to_string(i);
    addQueryLayer(name, a.ego, list);
    list.norm(name + ".norm", width);
    list.layer(name + ".class", {1, width});
    list.mlp(name + ".box", width, width, kBoxNumbers);
  }
  addPreNormAttention("track.update", width, list);
  addPreNormMix("track.update.mix", a.ego, list);
}

void addUniadMap(const UniadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  list.add("table.map.content", {a.map_lines, width});
  list.add("table.map.position", {a.map_lines, width});
  list.add("table.map.reference", {a.map_lines, 2 * kMapPoints});
  for (std::int64_t i = 0; i < a.decoder_layers; ++i) {
    const std::string name = "map." + std::to_string(i);
    addQueryLayer(name, a.ego, list);
    list.norm(name + ".norm", width);
    list.layer(name + ".class", {kMapKinds, width});
    list.mlp(name + ".points", width, width, 2 * kMapPoints);
  }
}

void addUniadMotion(const UniadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  list.mlp("motion.anchor", 6, width, width);
  list.add("table.mode", {kMotionModes, width});
  for (std::int64_t i = 0; i < a.motion_layers; ++i) {
    const std::string name = "motion." + std::to_string(i);
    addPreNormAttention(name + ".agents", width, list);
    addPreNormAttention(name + ".map", width, list);
    list.norm(name + ".bev.norm", width);
    inference::addDeformable(name + ".bev", querySizes(a.ego), width, list);
    list.mlp(name + ".fuse", 4 * width, width, width);
    list.norm(name + ".norm", width);
    list.mlp(name + ".offset", width, width, kGaussianNumbers * kEgoWaypoints);
    list.mlp(name + ".score", width, width, 1);
  }
}

void addUniadOccupancy(const UniadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width, cell = kOccupancyWidth;
  list.layer("occupancy.bev", {cell, width});
  list.layer("occupancy.fine", {cell, width});
  list.norm("occupancy.fine.norm", cell);
  list.mlp("occupancy.agent", 2 * width, width, width);
  for (std::int64_t i = 0; i < kOccupancySteps; ++i) {
    const std::string name = "occupancy." + std::to_string(i);
    list.norm(name + ".conv.norm", cell);
    list.layer(name + ".conv", {cell, kTaps * cell});
    list.norm(name + ".norm", cell);
    list.layer(name + ".query", {cell, cell});
    for (const char* part : {".key", ".value", ".mask"}) list.layer(name + part, {cell, width});
    list.layer(name + ".output", {cell, cell});
    list.norm(name + ".mix.norm", cell);
    list.feedForward(name + ".mix", cell, 2 * cell);
  }
}

void addUniadPlan(const UniadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  list.add("table.command", {kRoadCommands, width});
  list.mlp("plan.query", 3 * width, width, width);
  list.layer("plan.adapter.in", {width / 2, kTaps * width});
  list.layer("plan.adapter.out", {width, width / 2});
  list.norm("plan.bev.norm", width);
  for (std::int64_t i = 0; i < a.plan_layers; ++i) {
    const std::string name = "plan." + std::to_string(i);
    addPreNormAttention(name, width, list);
    addPreNormMix(name + ".mix", a.ego, list);
  }
  list.norm("plan.norm", width);
  list.mlp("plan.way", width, width, 2 * kEgoWaypoints);
}

}  // namespace

void UniadMiniArchitecture::describe(core::OptionsVisitor& visitor) {
  ego.describe(visitor);
  visitor.integer({"tracks", "", "Track queries without that of the ego."}, tracks, 1, 400);
  visitor.integer({"map_lines", "", "Map queries."}, map_lines, 1, 200);
  visitor.integer({"decoder_layers", "", "Layers of the decoders of tracks and of the map."},
                  decoder_layers, 1, 8);
  visitor.integer({"motion_layers", "", "Layers of the motion forecasts."}, motion_layers, 1, 8);
  visitor.integer({"plan_layers", "", "Layers by which the planner looks at the BEV."}, plan_layers,
                  1, 8);
}

void UniadMiniArchitecture::validate() const {
  ego.validate();
  if (ego.bev.rows % 2 == 0 && ego.bev.columns % 2 == 0) return;
  throw core::InputError("rows and columns are " + std::to_string(ego.bev.rows) + " and " +
                         std::to_string(ego.bev.columns) +
                         "; uniad_mini needs even ones, since occupancy halves them");
}

std::vector<inference::TensorShape> uniadBevTensors(const UniadMiniArchitecture& architecture) {
  TensorList list;
  addBevEncoder(architecture.ego, list);
  return list.take();
}

std::vector<inference::TensorShape> uniadTrackTensors(const UniadMiniArchitecture& architecture) {
  TensorList list;
  addUniadTracks(architecture, list);
  addUniadMap(architecture, list);
  return list.take();
}

std::vector<inference::TensorShape> uniadPlanTensors(const UniadMiniArchitecture& architecture) {
  TensorList list;
  addUniadMotion(architecture, list);
  addUniadOccupancy(architecture, list);
  addUniadPlan(architecture, list);
  return list.take();
}

std::vector<inference::TensorShape> uniadMiniTensors(const UniadMiniArchitecture& architecture) {
  std::vector<inference::TensorShape> all = uniadBevTensors(architecture);
  for (const auto& part : {uniadTrackTensors(architecture), uniadPlanTensors(architecture)})
    all.insert(all.end(), part.begin(), part.end());
  all.push_back({kAnchorTable, {kMotionGroups * kMotionModes, 2 * kEgoWaypoints}});
  return all;
}

}  // namespace cdiff::planners
