// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini_network.h"

#include <algorithm>
#include <cmath>

#include "planners/pluto/pluto_layers.h"

namespace cdiff::planners {
namespace {

using inference::LayerWeights;
using inference::Rows;

bool isFinite(const Eigen::Vector2d& place) { return place.allFinite(); }

bool isFinite(const EgoWaypoints& way) {
  return std::all_of(way.begin(), way.end(), [](const auto& place) { return isFinite(place); });
}

bool isFinite(const DetectedAgent& agent) {
  return std::isfinite(agent.score) &&
         std::all_of(agent.box.begin(), agent.box.end(),
                     [](float n) { return std::isfinite(n); }) &&
         std::all_of(agent.ways.begin(), agent.ways.end(),
                     [](const EgoWaypoints& way) { return isFinite(way); }) &&
         std::none_of(agent.way_scores.begin(), agent.way_scores.end(),
                      [](float score) { return std::isnan(score); });
}

bool isFinite(const DetectedLine& line) {
  return std::all_of(line.scores.begin(), line.scores.end(),
                     [](float n) { return std::isfinite(n); }) &&
         std::all_of(line.points.begin(), line.points.end(),
                     [](const Eigen::Vector2d& point) { return isFinite(point); });
}

}  // namespace

bool UniadMiniOutput::finite() const {
  return isFinite(plan) && occupancy.finite() &&
         std::all_of(agents.begin(), agents.end(),
                     [](const DetectedAgent& agent) { return isFinite(agent); }) &&
         std::all_of(lines.begin(), lines.end(),
                     [](const DetectedLine& line) { return isFinite(line); });
}

PlanDecoder::PlanDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
                         inference::InstructionSet set)
    : architecture_(architecture),
      command_(tableRows({set, tensors}, "command")),
      positions_(tableRows({set, tensors}, "bev.position")),
      query_({set, tensors}, "plan.query"),
      narrow_({set, tensors}, "plan.adapter.in"),
      widen_({set, tensors}, "plan.adapter.out"),
      bev_norm_({set, tensors}, "plan.bev.norm"),
      norm_({set, tensors}, "plan.norm"),
      way_({set, tensors}, "plan.way"),
      neighbors_(neighborCells(architecture.ego.bev.grid())) {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < architecture.plan_layers; ++i) {
    const std::string name = "plan." + std::to_string(i);
    layers_.push_back({{weights, name, architecture.ego.transformer()}, {weights, name + ".mix"}});
  }
}

/// tokens_ = LN(bev + widen(max(0, convolution(bev)))) + positions.
void PlanDecoder::adapt(const Rows& bev) {
  const std::int64_t width = architecture_.ego.width, cells = architecture_.ego.bev.cells();
  gatherNeighbors(neighbors_, bev, width, gathered_);
  narrowed_.resize(cells, width / 2);
  narrow_.apply(gathered_.view(), narrowed_.view(), cells);
  float* values = narrowed_.row(0);
  for (std::int64_t i = 0; i < cells * narrowed_.stride(); ++i)
    values[i] = std::max(0.0F, values[i]);
  tokens_.resize(cells, width);
  widen_.apply(narrowed_.view(), tokens_.view(), cells);
  bev_norm_.apply(tokens_.view(), bev.view(), tokens_.view(), cells);
  for (std::int64_t cell = 0; cell < cells; ++cell)
    inference::addRow(positions_.row(cell), width, tokens_.row(cell));
}

/// x_ = the planner's query.
void PlanDecoder::ask(const DetectedTracks& tracks, const PredictedMotion& motion,
                      RoadCommand command, UniadMemory& memory) {
  const std::int64_t width = architecture_.ego.width, ego = architecture_.tracks;
  joined_.resize(kMotionModes, 3 * width);
  for (std::int64_t mode = 0; mode < kMotionModes; ++mode) {
    float* row = joined_.row(mode);
    std::copy_n(motion.modes.row(ego * kMotionModes + mode), width, row);
    std::copy_n(tracks.features.row(ego), width, row + width);
    std::copy_n(command_.row(static_cast<std::int64_t>(command)), width, row + 2 * width);
  }
  asked_.resize(kMotionModes, width);
  query_.apply(joined_.view(), asked_.view(), kMotionModes, memory.transformer.hidden);
  x_.resize(1, width);
  std::copy_n(asked_.row(0), width, x_.row(0));
  for (std::int64_t mode = 1; mode < kMotionModes; ++mode) {
    for (std::int64_t c = 0; c < width; ++c)
      x_.row(0)[c] = std::max(x_.row(0)[c], asked_.row(mode)[c]);
  }
}

EgoWaypoints PlanDecoder::plan(const Rows& bev, const DetectedTracks& tracks,
                               const PredictedMotion& motion, RoadCommand command,
                               UniadMemory& memory) {
  adapt(bev);
  ask(tracks, motion, command, memory);
  for (const Layer& layer : layers_) {
    layer.attention.attendTo(tokens_, x_, memory.transformer);
    layer.mix.apply(x_, memory.transformer);
  }
  norm_.apply(x_.view(), x_.view(), 1);
  memory.head.resize(1, 2 * kEgoWaypoints);
  way_.apply(x_.view(), memory.head.view(), 1, memory.transformer.hidden);
  EgoWaypoints plan;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const float* offset = memory.head.row(0) + 2 * i;
    place += kOffsetUnit * Eigen::Vector2d(offset[0], offset[1]);
    plan[i] = place;
  }
  return plan;
}

UniadMiniNetwork::UniadMiniNetwork(const UniadMiniModel& model, inference::InstructionSet set)
    : encoder_(model.architecture.ego, model.weights, set),
      tracks_(model.architecture, model.weights, set),
      map_(model.architecture, model.weights, set),
      motion_(model.architecture, model.weights, set),
      occupancy_(model.architecture, model.weights, set),
      plan_(model.architecture, model.weights, set) {}

UniadMiniOutput UniadMiniNetwork::forward(const UniadMiniInput& input) {
  UniadMiniOutput output;
  bev_ = &encoder_.encode(input.images, input.motion, input.poses, input.past);
  DetectedTracks tracks;
  tracks_.see(*bev_, input.poses, input.past_tracks, memory_, tracks);
  output.lines = map_.see(*bev_, memory_, map_tokens_);
  const PredictedMotion motion = motion_.see(*bev_, map_tokens_, memory_, tracks);
  occupancy_.see(*bev_, tracks, motion, memory_, output.occupancy);
  output.plan = plan_.plan(*bev_, tracks, motion, input.command, memory_);
  output.agents = std::move(tracks.agents);
  output.tracks = std::move(tracks.kept);
  return output;
}

}  // namespace cdiff::planners
