// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_weights.h"

#include "inference/transformer_layers.h"
#include "planners/pluto/pluto_scene.h"

namespace cdiff::planners {
namespace {

using inference::TensorList;

constexpr std::int64_t kPoseFeatures = kPoseNumbers * (2 * kPlutoFrequencies + 1);
constexpr std::int64_t kPolygonTypes = 2;
constexpr std::int64_t kAgentWidth1 = 32;  // of the first convolution over the history
constexpr std::int64_t kTimeTaps = 3;      // of each
constexpr std::int64_t kJoinedSteps = 5;   // rows of the last one
constexpr const char* kScoreHead = "score.";

void addTable(const std::string& name, std::int64_t rows, std::int64_t width, TensorList& list) {
  list.add("table." + name, {rows, width});
}

void addPointNet(const std::string& name, std::int64_t channels, std::int64_t width,
                 TensorList& list) {
  list.mlp(name + ".first", channels, width, width);
  list.mlp(name + ".second", 2 * width, width, width);
}

/// Of PreNormAttention.
void addAttention(const std::string& name, std::int64_t width, TensorList& list) {
  list.norm(name + ".norm", width);
  list.attention(name, width);
}

/// Of PreNormFeedForward.
void addMix(const std::string& name, const PlutoArchitecture& sizes, TensorList& list) {
  list.norm(name + ".norm", sizes.width);
  list.feedForward(name, sizes.width, sizes.hidden);
}

void addEncoder(const PlutoArchitecture& sizes, TensorList& list) {
  const std::int64_t width = sizes.width;
  addTable("own.query", 1, width, list);
  addTable("own.place", kMotionNumbers + 1, width, list);
  addTable("own.gain", kMotionNumbers, width, list);
  list.layer("own.key_value", {2 * width, width});
  list.layer("own.output", {width, width});
  list.layer("agent.conv1", {kAgentWidth1, kAgentChannels, kTimeTaps});
  list.layer("agent.conv2", {width, kAgentWidth1, kTimeTaps});
  list.layer("agent.conv3", {width, width, kTimeTaps});
  list.layer("agent.join", {width, kJoinedSteps * width});
  addTable("agent.kind", kAgentKinds, width, list);
  addPointNet("polygon", kPieceChannels, width, list);
  addTable("polygon.internal", kPolygonTypes, width, list);
  addTable("polygon.on_route", kPolygonTypes, width, list);
  addTable("polygon.light", kLightStates, width, list);
  addTable("polygon.limit", 1, width, list);
  addTable("position.frequency", kPoseNumbers, kPlutoFrequencies, list);
  list.mlp("position", kPoseFeatures, width, width);
  for (std::int64_t i = 0; i < sizes.encoder_layers; ++i) {
    const std::string layer = "encoder." + std::to_string(i);
    addAttention(layer + ".attention", width, list);
    addMix(layer + ".mix", sizes, list);
  }
  list.norm("encoder.norm", width);
}

void addDecoder(const PlutoArchitecture& sizes, TensorList& list) {
  const std::int64_t width = sizes.width;
  addPointNet("line", kLineChannels, width, list);
  addTable("mode", kPlutoModes, width, list);
  addTable("mode.position", kPlutoModes, width, list);
  list.layer("query", {width, 2 * width});
  for (std::int64_t i = 0; i < sizes.decoder_layers; ++i) {
    const std::string layer = "decoder." + std::to_string(i);
    addAttention(layer + ".lines", width, list);
    addAttention(layer + ".modes", width, list);
    addAttention(layer + ".scene", width, list);
    addMix(layer + ".mix", sizes, list);
  }
  list.norm("decoder.norm", width);
  list.layer("join", {width, 2 * width});
  for (const char* head : {"place", "heading", "velocity"})
    list.mlp(head, width, 2 * width, 2 * kPlutoSteps);
  list.mlp("score", width, width, 1);
  list.mlp("free", width, 2 * width, kFreeChannels * kPlutoSteps);
  // Of the training alone.
  list.mlp("forecast", width, 2 * width, kPlutoChannels * kPlutoSteps);
  list.mlp("contrast", width, width, width);
}

}  // namespace

void PlutoArchitecture::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "", "Width of a token."}, width, 16, 1024);
  visitor.integer({"heads", "", "Heads of attention."}, heads, 1, 64);
  visitor.integer({"hidden", "", "Width of the feed-forward networks."}, hidden, 16, 4096);
  visitor.integer({"encoder_layers", "", "Layers over the scene."}, encoder_layers, 1, 16);
  visitor.integer({"decoder_layers", "", "Layers over the queries."}, decoder_layers, 1, 16);
  visitor.integer({"agents", "", "Most vehicles that are tokens; the nearest are kept."}, agents, 0,
                  256);
  visitor.integer({"polygons", "", "Most pieces of lanes that are tokens; the nearest are kept."},
                  polygons, 0, 1024);
  visitor.integer({"lines", "", "Most reference lines."}, lines, 1, 16);
  visitor.number({"radius", "m", "Vehicles and lanes farther away are no tokens."}, radius, 1.0,
                 500.0);
}

void PlutoArchitecture::validate() const {
  inference::TransformerSizes{width, heads, hidden}.validate();
}

std::vector<inference::TensorShape> plutoTensors(const PlutoArchitecture& architecture) {
  TensorList list;
  addEncoder(architecture, list);
  addDecoder(architecture, list);
  return list.take();
}

bool ofScoreHead(const std::string& tensor) { return tensor.rfind(kScoreHead, 0) == 0; }

}  // namespace cdiff::planners
