// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/vad_mini_weights.h"

namespace cdiff::planners {
namespace {

using inference::TensorList;

void addAgents(const VadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  list.add("table.agent.content", {a.agents, width});
  list.add("table.agent.position", {a.agents, width});
  list.add("table.agent.reference", {a.agents, 2});
  for (std::int64_t i = 0; i < a.decoder_layers; ++i) {
    const std::string name = "agent." + std::to_string(i);
    addQueryLayer(name, a.ego, list);
    list.norm(name + ".norm", width);
    list.layer(name + ".class", {1, width});
    list.mlp(name + ".box", width, width, kBoxNumbers);
  }
}

void addMap(const VadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  for (const char* part : {"content", "position"}) {
    list.add(std::string("table.map.line_") + part, {a.map_lines, width});
    list.add(std::string("table.map.point_") + part, {kMapPoints, width});
  }
  list.add("table.map.reference", {a.map_lines * kMapPoints, 2});
  for (std::int64_t i = 0; i < a.decoder_layers; ++i) {
    const std::string name = "map." + std::to_string(i);
    addQueryLayer(name, a.ego, list);
    list.norm(name + ".norm", width);
    list.layer(name + ".class", {kMapKinds, width});
    list.mlp(name + ".point", width, width, 2);
  }
  list.mlp("map.shape", 2, width, width);
}

void addInteraction(const std::string& name, const VadMiniArchitecture& a, TensorList& list) {
  addPreNormAttention(name, a.ego.width, list);
  addPreNormMix(name + ".mix", a.ego, list);
}

void addMotionAndPlan(const VadMiniArchitecture& a, TensorList& list) {
  const std::int64_t width = a.ego.width;
  const std::int64_t places = 2 * kEgoWaypoints;
  list.mlp("place", 2, width, width);
  list.add("table.mode", {kMotionModes, width});
  addInteraction("motion.agents", a, list);
  addInteraction("motion.map", a, list);
  list.norm("motion.norm", width);
  list.mlp("motion.offset", 2 * width, width, places);
  list.mlp("motion.score", 2 * width, width, 1);
  list.mlp("fuse", kMotionModes * 2 * width, width, width);
  list.add("table.ego", {1, width});
  list.layer("ego.bev", {width, width});
  addInteraction("ego.agents", a, list);
  addInteraction("ego.map", a, list);
  list.norm("ego.norm", 2 * width);
  list.mlp("plan", 2 * width, 2 * width, kRoadCommands * places);
}

}  // namespace

void VadMiniArchitecture::describe(core::OptionsVisitor& visitor) {
  ego.describe(visitor);
  visitor.integer({"agents", "", "Agent queries."}, agents, 1, 400);
  visitor.integer({"map_lines", "", "Map queries."}, map_lines, 1, 200);
  visitor.integer({"decoder_layers", "", "Layers of the decoders of agents and of the map."},
                  decoder_layers, 1, 8);
}

std::vector<inference::TensorShape> vadMiniTensors(const VadMiniArchitecture& architecture) {
  TensorList list;
  addBevEncoder(architecture.ego, list);
  addAgents(architecture, list);
  addMap(architecture, list);
  addMotionAndPlan(architecture, list);
  return list.take();
}

}  // namespace cdiff::planners
