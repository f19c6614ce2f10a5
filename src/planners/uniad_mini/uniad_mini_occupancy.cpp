// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini_occupancy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cdiff::planners {
namespace {

using inference::LayerWeights;
using inference::Rows;

const float kMaskLogit = static_cast<float>(std::log(kOccupancyMask / (1.0 - kOccupancyMask)));

/// Product of two rows of kOccupancyWidth, summed in 16 lanes.
float dotOf(const float* a, const float* b) {
  constexpr std::int64_t kLanes = 16;
  float lanes[kLanes] = {};
  for (std::int64_t c = 0; c < kOccupancyWidth; c += kLanes) {
    for (std::int64_t i = 0; i < kLanes; ++i) lanes[i] += a[c + i] * b[c + i];
  }
  float sum = 0.0F;
  for (const float lane : lanes) sum += lane;
  return sum;
}

/// Where an agent will be at a step by its most probable way.
Eigen::Vector2d placeAt(const DetectedAgent& agent, std::size_t step) {
  if (step == 0) return {agent.box[0], agent.box[1]};
  const auto best = std::max_element(agent.way_scores.begin(), agent.way_scores.end());
  return agent.ways[static_cast<std::size_t>(best - agent.way_scores.begin())][step - 1];
}

}  // namespace

std::vector<float> PredictedOccupancy::probability(std::size_t step) const {
  constexpr float kNever = -std::numeric_limits<float>::infinity();
  std::vector<float> largest(static_cast<std::size_t>(cells), kNever);
  for (std::size_t i = 0; i < logits[step].size(); ++i) {
    float& cell = largest[i % largest.size()];
    if (sure[i / largest.size()]) cell = std::max(cell, logits[step][i]);
  }
  for (float& cell : largest) cell = static_cast<float>(logistic(cell));
  return largest;
}

bool PredictedOccupancy::finite() const {
  return std::all_of(logits.begin(), logits.end(), [](const std::vector<float>& step) {
    return std::all_of(step.begin(), step.end(), [](float logit) { return std::isfinite(logit); });
  });
}

OccupancyDecoder::OccupancyDecoder(const UniadMiniArchitecture& architecture,
                                   const WeightTensors& tensors, inference::InstructionSet set)
    : architecture_(architecture),
      bev_({set, tensors}, "occupancy.bev"),
      fine_({set, tensors}, "occupancy.fine"),
      fine_norm_({set, tensors}, "occupancy.fine.norm"),
      agent_({set, tensors}, "occupancy.agent"),
      place_({set, tensors}, architecture.ego),
      neighbors_(neighborCells({architecture.ego.bev.rows / 2, architecture.ego.bev.columns / 2})) {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < kOccupancySteps; ++i) {
    const std::string name = "occupancy." + std::to_string(i);
    steps_.push_back({{weights, name + ".conv.norm"},
                      {weights, name + ".conv"},
                      {weights, name + ".norm"},
                      {weights, name + ".query"},
                      {weights, name + ".key"},
                      {weights, name + ".value"},
                      {weights, name + ".mask"},
                      {weights, name + ".output"},
                      {weights, name + ".mix"}});
  }
}

/// Features of each agent beside the largest of its modes', fused.
void OccupancyDecoder::fuseAgents(const DetectedTracks& tracks, const PredictedMotion& motion,
                                  UniadMemory& memory) {
  const std::int64_t width = architecture_.ego.width, slots = architecture_.tracks;
  joined_.resize(slots, 2 * width);
  for (std::int64_t row = 0; row < slots; ++row) {
    float* largest = joined_.row(row) + width;
    std::copy_n(tracks.features.row(row), width, joined_.row(row));
    std::copy_n(motion.modes.row(row * kMotionModes), width, largest);
    for (std::int64_t mode = 1; mode < kMotionModes; ++mode) {
      const float* of_mode = motion.modes.row(row * kMotionModes + mode);
      for (std::int64_t c = 0; c < width; ++c) largest[c] = std::max(largest[c], of_mode[c]);
    }
  }
  agents_.resize(slots, width);
  agent_.apply(joined_.view(), agents_.view(), slots, memory.transformer.hidden);
}

void OccupancyDecoder::placeAgents(const DetectedTracks& tracks, std::size_t step,
                                   UniadMemory& memory) {
  const std::int64_t width = architecture_.ego.width;
  std::vector<Eigen::Vector2d> places;
  for (const DetectedAgent& agent : tracks.agents) places.push_back(placeAt(agent, step));
  place_.apply(places, memory, places_);
  placed_.resize(agents_.rows(), width);
  for (std::int64_t row = 0; row < agents_.rows(); ++row) {
    std::copy_n(agents_.row(row), width, placed_.row(row));
    inference::addRow(places_.row(row), width, placed_.row(row));
  }
}

/// mixed_ = for each cell the values of the agents that are there and that the mask admits,
/// weighted by softmax; zeros where none is.
void OccupancyDecoder::attend(const std::vector<bool>& sure) {
  const float scale = 1.0F / std::sqrt(static_cast<float>(kOccupancyWidth));
  mixed_.resize(normed_.rows(), kOccupancyWidth);
  std::vector<float> scores(sure.size());
  for (std::int64_t cell = 0; cell < normed_.rows(); ++cell) {
    float largest = -1e30F, sum = 0.0F;
    std::vector<std::size_t> admitted;
    for (std::size_t agent = 0; agent < sure.size(); ++agent) {
      const auto row = static_cast<std::int64_t>(agent);
      if (!sure[agent] || dotOf(masks_.row(row), normed_.row(cell)) < kMaskLogit) continue;
      scores[agent] = scale * dotOf(queries_.row(cell), keys_.row(row));
      largest = std::max(largest, scores[agent]);
      admitted.push_back(agent);
    }
    float* mixed = mixed_.row(cell);
    std::fill_n(mixed, kOccupancyWidth, 0.0F);
    for (const std::size_t agent : admitted) {
      scores[agent] = std::exp(scores[agent] - largest);
      sum += scores[agent];
    }
    for (const std::size_t agent : admitted) {
      const float* value = values_.row(static_cast<std::int64_t>(agent));
      for (std::int64_t c = 0; c < kOccupancyWidth; ++c) mixed[c] += scores[agent] / sum * value[c];
    }
  }
}

/// state_ of the next step.
void OccupancyDecoder::run(const Step& step, UniadMemory& memory, const std::vector<bool>& sure) {
  const std::int64_t cells = state_.rows(), agents = placed_.rows(), width = kOccupancyWidth;
  normed_.resize(cells, width);
  change_.resize(cells, width);
  step.conv_norm.apply(state_.view(), normed_.view(), cells);
  gatherNeighbors(neighbors_, normed_, width, gathered_);
  step.conv.apply(gathered_.view(), change_.view(), cells);
  for (std::int64_t cell = 0; cell < cells; ++cell)
    inference::addRow(change_.row(cell), width, state_.row(cell));
  step.norm.apply(state_.view(), normed_.view(), cells);
  queries_.resize(cells, width);
  step.query.apply(normed_.view(), queries_.view(), cells);
  const std::pair<const inference::Linear*, Rows*> of_agents[] = {
      {&step.key, &keys_}, {&step.value, &values_}, {&step.mask, &masks_}};
  for (const auto& [layer, rows] : of_agents) {
    rows->resize(agents, width);
    layer->apply(placed_.view(), rows->view(), agents);
  }
  attend(sure);
  step.output.apply(mixed_.view(), change_.view(), cells);
  for (std::int64_t cell = 0; cell < cells; ++cell)
    inference::addRow(change_.row(cell), width, state_.row(cell));
  step.mix.apply(state_, memory.transformer);
}

/// The masks of all agents on the BEV's own cells.
void OccupancyDecoder::answer(std::vector<float>& logits) {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  cells_.resize(grid.cells(), kOccupancyWidth);
  for (std::int64_t cell = 0; cell < grid.cells(); ++cell) {
    std::copy_n(base_.row(cell), kOccupancyWidth, cells_.row(cell));
    inference::addRow(state_.row(halvedCell(grid, cell)), kOccupancyWidth, cells_.row(cell));
  }
  fine_norm_.apply(cells_.view(), cells_.view(), grid.cells());
  logits.clear();
  logits.reserve(static_cast<std::size_t>(masks_.rows() * grid.cells()));
  for (std::int64_t agent = 0; agent < masks_.rows(); ++agent) {
    for (std::int64_t cell = 0; cell < grid.cells(); ++cell)
      logits.push_back(dotOf(masks_.row(agent), cells_.row(cell)));
  }
}

void OccupancyDecoder::see(const Rows& bev, const DetectedTracks& tracks,
                           const PredictedMotion& motion, UniadMemory& memory,
                           PredictedOccupancy& occupancy) {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  occupancy.cells = grid.cells();
  occupancy.sure.clear();
  for (const DetectedAgent& agent : tracks.agents)
    occupancy.sure.push_back(logistic(agent.score) >= kKeepScore);
  fuseAgents(tracks, motion, memory);
  base_.resize(grid.cells(), kOccupancyWidth);
  bev_.apply(bev.view(), base_.view(), grid.cells());
  halveMap(grid, base_, kOccupancyWidth, state_);
  fine_.apply(bev.view(), base_.view(), grid.cells());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    placeAgents(tracks, i, memory);
    run(steps_[i], memory, occupancy.sure);
    answer(occupancy.logits[i]);
  }
}

}  // namespace cdiff::planners
