// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini_motion.h"

#include <algorithm>
#include <cmath>

#include "planners/pluto/pluto_layers.h"

namespace cdiff::planners {
namespace {

using inference::LayerWeights;
using inference::Rows;

constexpr std::int64_t kAnchorNumbers = 6;  // what a mode's start is embedded from

void copyAll(const Rows& from, std::int64_t channels, const Rows& to, std::int64_t channel = 0) {
  for (std::int64_t row = 0; row < from.rows(); ++row)
    std::copy_n(from.row(row), channels, to.row(row) + channel);
}

/// Unit vector of a box's heading, from its sine and cosine as they were answered.
Eigen::Vector2d headingOf(const DetectedAgent& agent) {
  const auto sine = static_cast<double>(agent.box[6]), cosine = static_cast<double>(agent.box[7]);
  return Eigen::Vector2d(cosine, sine) / std::sqrt(cosine * cosine + sine * sine + 1e-6);
}

MotionGroup groupOf(const DetectedAgent& agent) {
  return motionGroupOf(std::exp(static_cast<double>(agent.box[3])),
                       std::exp(static_cast<double>(agent.box[2])));
}

/// Softmax as logits of each mode by itself, as DetectedAgent has them.
void toModeLogits(const std::array<float, kMotionModes>& scores, DetectedAgent& agent) {
  for (std::size_t mode = 0; mode < scores.size(); ++mode) {
    double others = 0.0;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (i != mode) others += std::exp(static_cast<double>(scores[i] - scores[mode]));
    }
    agent.way_scores[mode] = static_cast<float>(-std::log(others));
  }
}

}  // namespace

MotionDecoder::MotionDecoder(const UniadMiniArchitecture& architecture,
                             const WeightTensors& tensors, inference::InstructionSet set)
    : architecture_(architecture),
      anchors_(toAnchors(LayerWeights(set, tensors).named(kAnchorTable))),
      embed_({set, tensors}, "motion.anchor"),
      mode_(tableRows({set, tensors}, "mode")),
      place_({set, tensors}, architecture.ego) {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < architecture.motion_layers; ++i) {
    const std::string name = "motion." + std::to_string(i);
    layers_.push_back({{weights, name + ".agents", architecture.ego.transformer()},
                       {weights, name + ".map", architecture.ego.transformer()},
                       {weights, name + ".bev.norm"},
                       {weights, name + ".bev", querySizes(architecture.ego)},
                       {weights, name + ".fuse"},
                       {weights, name + ".norm"},
                       {weights, name + ".offset"},
                       {weights, name + ".score"}});
  }
}

/// Anchors at the places and headings of the tracks; numbers_ of what they are embedded from.
void MotionDecoder::turnAnchors(const DetectedTracks& seen) {
  turned_.clear();
  numbers_.resize(architecture_.rows() * kMotionModes, kAnchorNumbers);
  for (std::size_t row = 0; row < seen.centers.size(); ++row) {
    const bool ego = row == seen.agents.size();
    const Eigen::Vector2d forward = ego ? Eigen::Vector2d(1.0, 0.0) : headingOf(seen.agents[row]);
    const MotionGroup group = ego ? MotionGroup::kCar : groupOf(seen.agents[row]);
    for (const EgoWaypoints& anchor : anchors_[static_cast<std::size_t>(group)]) {
      float* numbers = numbers_.row(static_cast<std::int64_t>(turned_.size()));
      EgoWaypoints way;
      for (std::size_t i = 0; i < way.size(); ++i)
        way[i] = seen.centers[row] + forward * anchor[i].x() +
                 geometry::leftNormal(forward) * anchor[i].y();
      const Eigen::Vector2d own = anchor.back() / kAnchorUnit;
      const Eigen::Vector2d turned = (way.back() - seen.centers[row]) / kAnchorUnit;
      const Eigen::Vector2d share = architecture_.ego.bev.toShare(way.back());
      const double values[kAnchorNumbers] = {
          own.x(), own.y(), turned.x(), turned.y(), 2.0 * share.x() - 1.0, 2.0 * share.y() - 1.0};
      for (std::int64_t i = 0; i < kAnchorNumbers; ++i) numbers[i] = static_cast<float>(values[i]);
      turned_.push_back(way);
    }
  }
}

void MotionDecoder::start(UniadMemory& memory, const DetectedTracks& seen) {
  const std::int64_t width = architecture_.ego.width;
  turnAnchors(seen);
  ways_ = turned_;
  x_.resize(numbers_.rows(), width);
  embed_.apply(numbers_.view(), x_.view(), x_.rows(), memory.transformer.hidden);
  for (std::int64_t row = 0; row < x_.rows(); ++row) {
    inference::addRow(mode_.row(row % kMotionModes), width, x_.row(row));
    inference::addRow(seen.features.row(row / kMotionModes), width, x_.row(row));
  }
}

/// of_bev_ = x_ with deformable attention around the ends of the ways.
void MotionDecoder::readBev(const Layer& layer, const Rows& bev, UniadMemory& memory) {
  const std::int64_t width = architecture_.ego.width, rows = x_.rows();
  std::vector<float> cells;
  for (const EgoWaypoints& way : ways_) {
    const Eigen::Vector2f cell = architecture_.ego.bev.toCell(way.back()).cast<float>();
    cells.insert(cells.end(), {cell.x(), cell.y()});
  }
  Rows& normed = memory.transformer.normed;
  normed.resize(rows, width);
  layer.bev_norm.apply(x_.view(), normed.view(), rows);
  layer.bev.apply(normed, bev, architecture_.ego.bev.grid(),
                  inference::planAround(cells.data(), rows, kQueryPoints), memory.deformable,
                  of_bev_);
  for (std::int64_t row = 0; row < rows; ++row)
    inference::addRow(x_.row(row), width, of_bev_.row(row));
}

void MotionDecoder::run(const Layer& layer, const Rows& bev, const Rows& map, UniadMemory& memory,
                        const DetectedTracks& seen) {
  const std::int64_t width = architecture_.ego.width, rows = x_.rows();
  of_agents_.resize(rows, width);
  of_map_.resize(rows, width);
  copyAll(x_, width, of_agents_);
  copyAll(x_, width, of_map_);
  layer.agents.attendTo(context_, of_agents_, memory.transformer);
  layer.map.attendTo(map, of_map_, memory.transformer);
  readBev(layer, bev, memory);
  joined_.resize(rows, 4 * width);
  copyAll(of_agents_, width, joined_);
  copyAll(of_map_, width, joined_, width);
  copyAll(of_bev_, width, joined_, 2 * width);
  for (std::int64_t row = 0; row < rows; ++row)
    std::copy_n(seen.features.row(row / kMotionModes), width, joined_.row(row) + 3 * width);
  layer.fuse.apply(joined_.view(), x_.view(), rows, memory.transformer.hidden);
  addOffsets(layer, memory);
}

/// ways_ by the offsets that the layer answers.
void MotionDecoder::addOffsets(const Layer& layer, UniadMemory& memory) {
  const std::int64_t rows = x_.rows();
  Rows& normed = memory.transformer.normed;
  normed.resize(rows, architecture_.ego.width);
  layer.norm.apply(x_.view(), normed.view(), rows);
  memory.head.resize(rows, kGaussianNumbers * kEgoWaypoints);
  layer.offset.apply(normed.view(), memory.head.view(), rows, memory.transformer.hidden);
  for (std::int64_t row = 0; row < rows; ++row) {
    const auto index = static_cast<std::size_t>(row);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < ways_[index].size(); ++i) {
      const float* numbers = memory.head.row(row) + static_cast<std::int64_t>(i) * kGaussianNumbers;
      sum += kOffsetUnit * Eigen::Vector2d(numbers[0], numbers[1]);
      ways_[index][i] = turned_[index][i] + sum;
    }
  }
}

void MotionDecoder::readScores(UniadMemory& memory, const Rows& modes, DetectedTracks& seen) const {
  memory.head.resize(modes.rows(), 1);
  layers_.back().score.apply(modes.view(), memory.head.view(), modes.rows(),
                             memory.transformer.hidden);
  for (std::size_t row = 0; row < seen.agents.size(); ++row) {
    std::array<float, kMotionModes> scores;
    for (std::size_t mode = 0; mode < scores.size(); ++mode) {
      const std::size_t at = row * scores.size() + mode;
      scores[mode] = memory.head.row(static_cast<std::int64_t>(at))[0];
      seen.agents[row].ways[mode] = ways_[at];
    }
    toModeLogits(scores, seen.agents[row]);
  }
}

PredictedMotion MotionDecoder::see(const Rows& bev, const Rows& map, UniadMemory& memory,
                                   DetectedTracks& seen) {
  const std::int64_t width = architecture_.ego.width;
  PredictedMotion motion;
  place_.apply(seen.centers, memory, motion.places);
  context_.resize(architecture_.rows(), width);
  copyAll(seen.features, width, context_);
  for (std::int64_t row = 0; row < context_.rows(); ++row)
    inference::addRow(motion.places.row(row), width, context_.row(row));
  start(memory, seen);
  for (const Layer& layer : layers_) run(layer, bev, map, memory, seen);
  motion.modes.resize(x_.rows(), width);
  layers_.back().norm.apply(x_.view(), motion.modes.view(), x_.rows());
  readScores(memory, motion.modes, seen);
  return motion;
}

}  // namespace cdiff::planners
