// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_batch.h"

#include <algorithm>
#include <map>
#include <utility>

namespace cdiff::planners {
namespace {

constexpr float kAbsent = -1e9F;

using Counts = std::vector<std::int64_t>;
using Floats = std::vector<float>;

std::size_t sizeOf(std::int64_t value) { return static_cast<std::size_t>(value); }

/// Fills a batch, moment after moment.
class BatchRows {
 public:
  BatchRows(const std::vector<const PlutoExample*>& examples, const PlutoDropout& dropout)
      : dropout_(dropout), b_(static_cast<std::int64_t>(examples.size())) {
    for (const PlutoExample* example : examples) {
      a_ = std::max(a_, static_cast<std::int64_t>(example->input.agents.size()));
      p_ = std::max(p_, static_cast<std::int64_t>(example->input.polygons.size()));
      r_ = std::max(r_, static_cast<std::int64_t>(example->input.lines.size()));
    }
    makeRoom();
    for (std::int64_t i = 0; i < b_; ++i) add(i, *examples[sizeOf(i)]);
    if (known_.empty()) {
      known_.emplace(std::make_pair(nullptr, 0U), 0);
      pieces_.resize(sizeOf(kPiecePoints * kPieceChannels));
    }
  }

  PlutoBatch tensors(const at::Device& device) const;

 private:
  void makeRoom();
  void add(std::int64_t i, const PlutoExample& example);
  void addMotion(std::int64_t i, const PlutoInput& input);
  void addAgents(std::int64_t i, const PlutoExample& example);
  void addPolygons(std::int64_t i, const PlutoExample& example);
  void addLines(std::int64_t i, const PlutoInput& input);
  void addTarget(std::int64_t i, const PlutoExample& example);
  void addPose(std::int64_t i, std::int64_t token, const PlutoPose& pose) {
    std::copy(pose.begin(), pose.end(), poses_.begin() + (i * tokens() + token) * kPoseNumbers);
    mask_[sizeOf(i * tokens() + token)] = 0.0F;
  }
  std::int64_t tokens() const { return 1 + a_ + p_; }

  const PlutoDropout& dropout_;
  std::int64_t b_, a_ = 1, p_ = 1, r_ = 1;  // at least one row, which may be padding
  Floats motion_, motion_mask_, history_, pieces_, limit_, poses_, mask_, lines_, point_mask_,
      line_poses_, line_mask_, future_, future_weight_, imitates_, agent_future_, agent_weight_;
  Counts kinds_, piece_of_, internal_, on_route_, light_, chosen_;
  std::map<std::pair<const PlutoWorld*, std::uint32_t>, std::int64_t> known_;
};

void BatchRows::makeRoom() {
  history_.resize(sizeOf(b_ * a_ * kPlutoHistory * kAgentChannels));
  kinds_.resize(sizeOf(b_ * a_));
  for (Counts* counts : {&piece_of_, &internal_, &on_route_, &light_})
    counts->resize(sizeOf(b_ * p_));
  limit_.resize(sizeOf(b_ * p_));
  poses_.resize(sizeOf(b_ * tokens() * kPoseNumbers));
  mask_.assign(sizeOf(b_ * tokens()), kAbsent);
  lines_.resize(sizeOf(b_ * r_ * kLineTokenPoints * kLineChannels));
  point_mask_.assign(sizeOf(b_ * r_ * kLineTokenPoints), kAbsent);
  for (std::int64_t line = 0; line < b_ * r_; ++line)
    point_mask_[sizeOf(line * kLineTokenPoints)] = 0.0F;  // of the padding, too
  line_poses_.resize(sizeOf(b_ * r_ * kPoseNumbers));
  line_mask_.assign(sizeOf(b_ * r_), kAbsent);
  future_.resize(sizeOf(b_ * kPlutoSteps * kPlutoChannels));
  future_weight_.resize(sizeOf(b_ * kPlutoSteps));
  agent_future_.resize(sizeOf(b_ * a_ * kPlutoSteps * kPlutoChannels));
  agent_weight_.resize(sizeOf(b_ * a_ * kPlutoSteps));
}

void BatchRows::add(std::int64_t i, const PlutoExample& example) {
  addMotion(i, example.input);
  addPose(i, 0, PlutoPose{});
  addAgents(i, example);
  addPolygons(i, example);
  addLines(i, example.input);
  addTarget(i, example);
}

void BatchRows::addMotion(std::int64_t i, const PlutoInput& input) {
  motion_.insert(motion_.end(), input.motion.begin(), input.motion.end());
  motion_mask_.push_back(0.0F);
  for (std::size_t n = 0; n < sizeOf(kMotionNumbers); ++n) {
    const bool hidden = sizeOf(i) < dropout_.motion.size() && dropout_.motion[sizeOf(i)][n];
    motion_mask_.push_back(hidden ? kAbsent : 0.0F);
  }
}

void BatchRows::addAgents(std::int64_t i, const PlutoExample& example) {
  const std::int64_t shown =
      sizeOf(i) < dropout_.history.size() ? dropout_.history[sizeOf(i)] : kPlutoHistory;
  const std::int64_t hidden = (kPlutoHistory - shown) * kAgentChannels;
  for (std::size_t n = 0; n < example.input.agents.size(); ++n) {
    const PlutoAgent& agent = example.input.agents[n];
    const std::int64_t row = i * a_ + static_cast<std::int64_t>(n);
    std::copy(agent.history.begin() + hidden, agent.history.end(),
              history_.begin() + row * kPlutoHistory * kAgentChannels + hidden);
    kinds_[sizeOf(row)] = agent.kind;
    addPose(i, 1 + static_cast<std::int64_t>(n), agent.pose);
    const AgentFuture& future = example.futures[n];
    std::copy_n(future.future.data(), kPlutoSteps * kPlutoChannels,
                agent_future_.begin() + row * kPlutoSteps * kPlutoChannels);
    for (std::int64_t step = 0; step < kPlutoSteps; ++step)
      agent_weight_[sizeOf(row * kPlutoSteps + step)] = future.known[sizeOf(step)] ? 1.0F : 0.0F;
  }
}

void BatchRows::addPolygons(std::int64_t i, const PlutoExample& example) {
  for (std::size_t n = 0; n < example.input.polygons.size(); ++n) {
    const PlutoPolygon& polygon = example.input.polygons[n];
    const auto [entry, added] = known_.emplace(std::make_pair(example.world, polygon.piece),
                                               static_cast<std::int64_t>(known_.size()));
    if (added) {
      const auto& points = example.world->builder.pieces().all()[polygon.piece].points;
      pieces_.insert(pieces_.end(), points.begin(), points.end());
    }
    const std::size_t row = sizeOf(i * p_) + n;
    piece_of_[row] = entry->second;
    internal_[row] = polygon.internal;
    on_route_[row] = polygon.on_route;
    light_[row] = polygon.light;
    limit_[row] = polygon.limit;
    addPose(i, 1 + a_ + static_cast<std::int64_t>(n), polygon.pose);
  }
}

void BatchRows::addLines(std::int64_t i, const PlutoInput& input) {
  for (std::size_t n = 0; n < input.lines.size(); ++n) {
    const PlutoLine& line = input.lines[n];
    const std::int64_t row = i * r_ + static_cast<std::int64_t>(n);
    std::copy(line.points.begin(), line.points.end(),
              lines_.begin() + row * kLineTokenPoints * kLineChannels);
    std::fill_n(point_mask_.begin() + row * kLineTokenPoints,
                line.points.size() / sizeOf(kLineChannels), 0.0F);
    std::copy(line.pose.begin(), line.pose.end(), line_poses_.begin() + row * kPoseNumbers);
    line_mask_[sizeOf(row)] = 0.0F;
  }
}

void BatchRows::addTarget(std::int64_t i, const PlutoExample& example) {
  const PlutoTarget& target = example.target;
  chosen_.push_back(static_cast<std::int64_t>(target.line) * kPlutoModes +
                    static_cast<std::int64_t>(target.mode));
  std::copy_n(target.future.data(), kPlutoSteps * kPlutoChannels,
              future_.begin() + i * kPlutoSteps * kPlutoChannels);
  std::fill_n(future_weight_.begin() + i * kPlutoSteps, target.steps, 1.0F);
  imitates_.push_back(example.imitates ? 1.0F : 0.0F);
}

PlutoBatch BatchRows::tensors(const at::Device& device) const {
  const auto floats = [&](const Floats& values, at::IntArrayRef shape) {
    return learning::toTensor(values, shape, device);
  };
  const auto counts = [&](const Counts& values, at::IntArrayRef shape) {
    return learning::toIndices(values, shape, device);
  };
  PlutoBatch batch;
  batch.motion = floats(motion_, {b_, kMotionNumbers});
  batch.motion_mask = floats(motion_mask_, {b_, 1, 1, kMotionNumbers + 1});
  batch.history = floats(history_, {b_, a_, kPlutoHistory, kAgentChannels});
  batch.kinds = counts(kinds_, {b_, a_});
  batch.pieces =
      floats(pieces_, {static_cast<std::int64_t>(known_.size()), kPiecePoints, kPieceChannels});
  batch.piece_of = counts(piece_of_, {b_, p_});
  batch.internal = counts(internal_, {b_, p_});
  batch.on_route = counts(on_route_, {b_, p_});
  batch.light = counts(light_, {b_, p_});
  batch.limit = floats(limit_, {b_, p_, 1});
  batch.poses = floats(poses_, {b_, tokens(), kPoseNumbers});
  batch.mask = floats(mask_, {b_, 1, 1, tokens()});
  batch.lines = floats(lines_, {b_, r_, kLineTokenPoints, kLineChannels});
  batch.point_mask = floats(point_mask_, {b_, r_, kLineTokenPoints, 1});
  batch.line_poses = floats(line_poses_, {b_, r_, kPoseNumbers});
  batch.line_mask = floats(line_mask_, {b_, r_});
  batch.chosen = counts(chosen_, {b_});
  batch.future = floats(future_, {b_, kPlutoSteps, kPlutoChannels});
  batch.future_weight = floats(future_weight_, {b_, kPlutoSteps, 1});
  batch.imitates = floats(imitates_, {b_});
  batch.agent_future = floats(agent_future_, {b_, a_, kPlutoSteps, kPlutoChannels});
  batch.agent_weight = floats(agent_weight_, {b_, a_, kPlutoSteps, 1});
  return batch;
}

}  // namespace

PlutoBatch plutoBatch(const std::vector<const PlutoExample*>& examples, const PlutoDropout& dropout,
                      const at::Device& device) {
  return BatchRows(examples, dropout).tensors(device);
}

}  // namespace cdiff::planners
