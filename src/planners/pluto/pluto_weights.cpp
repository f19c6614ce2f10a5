// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_weights.h"

#include <system_error>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/pluto/pluto_scene.h"

namespace cdiff::planners {
namespace {

using inference::TensorShape;

constexpr std::int64_t kPoseFeatures = kPoseNumbers * (2 * kPlutoFrequencies + 1);
constexpr std::int64_t kPolygonTypes = 2;
constexpr std::int64_t kAgentWidth1 = 32;  // of the first convolution over the history
constexpr std::int64_t kTimeTaps = 3;      // of each
constexpr std::int64_t kJoinedSteps = 5;   // rows of the last one
constexpr const char* kScoreHead = "score.";

/// Collects names and shapes.
class TensorList {
 public:
  void table(const std::string& name, std::int64_t rows, std::int64_t width) {
    list_.push_back({"table." + name, {rows, width}});
  }
  void linear(const std::string& name, std::int64_t in, std::int64_t out) {
    list_.push_back({name + ".weight", {out, in}});
    list_.push_back({name + ".bias", {out}});
  }
  void convolution(const std::string& name, std::int64_t in, std::int64_t out) {
    list_.push_back({name + ".weight", {out, in, kTimeTaps}});
    list_.push_back({name + ".bias", {out}});
  }
  void norm(const std::string& name, std::int64_t width) {
    list_.push_back({name + ".weight", {width}});
    list_.push_back({name + ".bias", {width}});
  }
  void mlp(const std::string& name, std::int64_t in, std::int64_t hidden, std::int64_t out) {
    linear(name + ".in", in, hidden);
    norm(name + ".norm", hidden);
    linear(name + ".out", hidden, out);
  }
  void attention(const std::string& name, std::int64_t width) {
    norm(name + ".norm", width);
    linear(name + ".query", width, width);
    linear(name + ".key_value", width, 2 * width);
    linear(name + ".output", width, width);
  }
  void feedForward(const std::string& name, std::int64_t width, std::int64_t hidden) {
    norm(name + ".norm", width);
    linear(name + ".up", width, hidden);
    linear(name + ".down", hidden, width);
  }
  void pointNet(const std::string& name, std::int64_t channels, std::int64_t width) {
    mlp(name + ".first", channels, width, width);
    mlp(name + ".second", 2 * width, width, width);
  }
  std::vector<TensorShape> take() { return std::move(list_); }

 private:
  std::vector<TensorShape> list_;
};

void addEncoder(const PlutoArchitecture& sizes, TensorList& list) {
  const std::int64_t width = sizes.width;
  list.table("own.query", 1, width);
  list.table("own.place", kMotionNumbers + 1, width);
  list.table("own.gain", kMotionNumbers, width);
  list.linear("own.key_value", width, 2 * width);
  list.linear("own.output", width, width);
  list.convolution("agent.conv1", kAgentChannels, kAgentWidth1);
  list.convolution("agent.conv2", kAgentWidth1, width);
  list.convolution("agent.conv3", width, width);
  list.linear("agent.join", kJoinedSteps * width, width);
  list.table("agent.kind", kAgentKinds, width);
  list.pointNet("polygon", kPieceChannels, width);
  list.table("polygon.internal", kPolygonTypes, width);
  list.table("polygon.on_route", kPolygonTypes, width);
  list.table("polygon.light", kLightStates, width);
  list.table("polygon.limit", 1, width);
  list.table("position.frequency", kPoseNumbers, kPlutoFrequencies);
  list.mlp("position", kPoseFeatures, width, width);
  for (std::int64_t i = 0; i < sizes.encoder_layers; ++i) {
    const std::string layer = "encoder." + std::to_string(i);
    list.attention(layer + ".attention", width);
    list.feedForward(layer + ".mix", width, sizes.hidden);
  }
  list.norm("encoder.norm", width);
}

void addDecoder(const PlutoArchitecture& sizes, TensorList& list) {
  const std::int64_t width = sizes.width;
  list.pointNet("line", kLineChannels, width);
  list.table("mode", kPlutoModes, width);
  list.table("mode.position", kPlutoModes, width);
  list.linear("query", 2 * width, width);
  for (std::int64_t i = 0; i < sizes.decoder_layers; ++i) {
    const std::string layer = "decoder." + std::to_string(i);
    list.attention(layer + ".lines", width);
    list.attention(layer + ".modes", width);
    list.attention(layer + ".scene", width);
    list.feedForward(layer + ".mix", width, sizes.hidden);
  }
  list.norm("decoder.norm", width);
  list.linear("join", 2 * width, width);
  for (const char* head : {"place", "heading", "velocity"})
    list.mlp(head, width, 2 * width, 2 * kPlutoSteps);
  list.mlp("score", width, width, 1);
  list.mlp("free", width, 2 * width, kFreeChannels * kPlutoSteps);
  // Of the training alone.
  list.mlp("forecast", width, 2 * width, kPlutoChannels * kPlutoSteps);
  list.mlp("contrast", width, width, width);
}

}  // namespace

std::vector<TensorShape> plutoTensors(const PlutoArchitecture& architecture) {
  TensorList list;
  addEncoder(architecture, list);
  addDecoder(architecture, list);
  return list.take();
}

bool ofScoreHead(const std::string& tensor) { return tensor.rfind(kScoreHead, 0) == 0; }

std::filesystem::path plutoWeightFile(const PlutoKind& kind, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kind.file;
  std::error_code error;
  if (std::filesystem::exists(file, error)) return file;
  throw core::InputError("planner '" + std::string(kind.planner) +
                         "' has no weights: there is no file '" + file.string() +
                         "'; train them with cdiff train --task " + kind.planner +
                         " --data FOLDER --output " + folder.string());
}

std::map<std::string, std::string> plutoMetadata(const PlutoKind& kind,
                                                 const PlutoArchitecture& architecture) {
  return {{"format", kind.format}, {"architecture", core::dumpOptions(architecture)}};
}

namespace {

void requireFormat(const PlutoKind& kind, const std::map<std::string, std::string>& metadata,
                   const std::string& source) {
  const auto format = metadata.find("format");
  if (format != metadata.end() && format->second == kind.format) return;
  throw core::InputError(source + ": its format is " +
                         (format == metadata.end() ? "not named" : "'" + format->second + "'") +
                         ", not '" + kind.format +
                         "': these are not weights of this version's planner '" + kind.planner +
                         "'; train them with cdiff train --task " + kind.planner);
}

}  // namespace

PlutoModel readPlutoModel(const PlutoKind& kind, const std::filesystem::path& folder) {
  const std::filesystem::path file = plutoWeightFile(kind, folder);
  const std::string source = "weight file '" + file.string() + "'";
  PlutoModel model;
  const auto expected = [&](const std::map<std::string, std::string>& metadata) {
    requireFormat(kind, metadata, source);
    const auto sizes = metadata.find("architecture");
    if (sizes == metadata.end())
      throw core::InputError(source + ": its metadata lacks the key 'architecture'");
    core::loadOptions({source + ", architecture", sizes->second}, model.architecture);
    model.architecture.validate();
    return plutoTensors(model.architecture);
  };
  model.weights = inference::readSafetensors(file, expected).tensors;
  return model;
}

}  // namespace cdiff::planners
