// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini_tracks.h"

#include <algorithm>

#include "planners/pluto/pluto_layers.h"

namespace cdiff::planners {
namespace {

using inference::LayerWeights;
using inference::Rows;

void copyQueries(const Rows& from, std::int64_t count, std::int64_t channels, const Rows& to) {
  for (std::int64_t row = 0; row < count; ++row) std::copy_n(from.row(row), channels, to.row(row));
}

Eigen::Vector2d placeOf(const BevGrid& bev, const float* reference) {
  return bev.fromShare({logistic(reference[0]), logistic(reference[1])});
}

void addCell(const BevGrid& bev, const Eigen::Vector2d& place, std::vector<float>& cells) {
  const Eigen::Vector2f cell = bev.toCell(place).cast<float>();
  cells.insert(cells.end(), {cell.x(), cell.y()});
}

}  // namespace

void PlaceEmbedding::apply(const std::vector<Eigen::Vector2d>& places, UniadMemory& memory,
                           Rows& rows) const {
  const auto count = static_cast<std::int64_t>(places.size());
  memory.shares.resize(count, 2);
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::Vector2d share = bev_.toShare(places[static_cast<std::size_t>(i)]);
    memory.shares.row(i)[0] = static_cast<float>(2.0 * share.x() - 1.0);
    memory.shares.row(i)[1] = static_cast<float>(2.0 * share.y() - 1.0);
  }
  rows.resize(count, width_);
  place_.apply(memory.shares.view(), rows.view(), count, memory.transformer.hidden);
}

TrackDecoder::TrackDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
                           inference::InstructionSet set)
    : architecture_(architecture),
      content_(tableRows({set, tensors}, "track.content")),
      reference_(tableRows({set, tensors}, "track.reference")),
      ego_(tableRows({set, tensors}, "ego.content")),
      place_({set, tensors}, architecture.ego),
      update_({set, tensors}, "track.update", architecture.ego.transformer()),
      update_mix_({set, tensors}, "track.update.mix") {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < architecture.decoder_layers; ++i) {
    const std::string name = "track." + std::to_string(i);
    layers_.push_back({{weights, name, architecture.ego},
                       {weights, name + ".norm"},
                       {weights, name + ".class"},
                       {weights, name + ".box"}});
  }
}

/// Queries, their references and positions before the first layer.
void TrackDecoder::start(const EgoPoses& poses, const TrackSet* past, UniadMemory& memory) {
  const BevGrid& bev = architecture_.ego.bev;
  const std::int64_t slots = architecture_.tracks, width = architecture_.ego.width;
  x_.resize(slots + 1, width);
  start_.resize(slots, 2);
  copyQueries(content_, slots, width, x_);
  copyQueries(reference_, slots, 2, start_);
  std::copy_n(past != nullptr ? past->content.row(slots) : ego_.row(0), width, x_.row(slots));
  held_.assign(static_cast<std::size_t>(slots), false);
  std::vector<Eigen::Vector2d> places;
  for (std::int64_t row = 0; row < slots; ++row) {
    const auto slot = static_cast<std::size_t>(row);
    const auto moved = past != nullptr ? movedCenter(*past, slot, poses, bev) : std::nullopt;
    if (moved) {
      held_[slot] = true;
      std::copy_n(past->content.row(row), width, x_.row(row));
      const std::array<float, 2> reference = referenceAt(bev, *moved);
      std::copy_n(reference.data(), 2, start_.row(row));
    }
    places.push_back(placeOf(bev, start_.row(row)));
  }
  places.emplace_back(0.0, 0.0);
  place_.apply(places, memory, position_);
}

void TrackDecoder::decode(const Rows& bev, UniadMemory& memory, DetectedTracks& seen) {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t slots = architecture_.tracks;
  seen.features.resize(slots + 1, architecture_.ego.width);
  for (const Layer& layer : layers_) {
    std::vector<float> cells;
    for (std::int64_t row = 0; row < slots; ++row)
      addCell(grid, placeOf(grid, start_.row(row)), cells);
    addCell(grid, Eigen::Vector2d::Zero(), cells);
    layer.layer.run(x_, position_, cells, bev, grid.grid(), memory.transformer, memory.deformable);
    layer.norm.apply(x_.view(), seen.features.view(), slots + 1);
    memory.head.resize(slots, kBoxNumbers);
    layer.box.apply(seen.features.view(), memory.head.view(), slots, memory.transformer.hidden);
    for (std::int64_t row = 0; row < slots; ++row)
      inference::addRow(memory.head.row(row), 2, start_.row(row));
  }
}

/// Boxes of the last layer, which are in memory.head, and scores.
void TrackDecoder::answer(UniadMemory& memory, DetectedTracks& seen) const {
  const std::int64_t slots = architecture_.tracks;
  seen.agents.assign(static_cast<std::size_t>(slots), {});
  seen.centers.clear();
  for (std::int64_t row = 0; row < slots; ++row) {
    DetectedAgent& agent = seen.agents[static_cast<std::size_t>(row)];
    std::copy_n(memory.head.row(row), kBoxNumbers, agent.box.begin());
    seen.centers.push_back(placeOf(architecture_.ego.bev, start_.row(row)));
    agent.box[0] = static_cast<float>(seen.centers.back().x());
    agent.box[1] = static_cast<float>(seen.centers.back().y());
    agent.box[8] *= static_cast<float>(kVelocityUnit);
    agent.box[9] *= static_cast<float>(kVelocityUnit);
  }
  seen.centers.emplace_back(0.0, 0.0);
  memory.head.resize(slots, 1);
  layers_.back().score.apply(seen.features.view(), memory.head.view(), slots);
  for (std::int64_t row = 0; row < slots; ++row)
    seen.agents[static_cast<std::size_t>(row)].score = memory.head.row(row)[0];
}

/// What the next decision starts from: contents updated by attention among all queries.
void TrackDecoder::keep(UniadMemory& memory, DetectedTracks& seen) const {
  const std::int64_t rows = architecture_.rows(), width = architecture_.ego.width;
  TrackSet& kept = seen.kept;
  kept.content.resize(rows, width);
  copyQueries(seen.features, rows, width, kept.content);
  update_.attendSelf({{0, 1, rows}}, kept.content, position_, memory.transformer);
  update_mix_.apply(kept.content, memory.transformer);
  kept.live.clear();
  kept.centers.clear();
  kept.velocities.clear();
  for (std::size_t slot = 0; slot < seen.agents.size(); ++slot) {
    const DetectedAgent& agent = seen.agents[slot];
    kept.live.push_back(holdsTrack(held_[slot], logistic(agent.score)));
    kept.centers.push_back(seen.centers[slot]);
    kept.velocities.emplace_back(agent.box[8], agent.box[9]);
  }
}

void TrackDecoder::see(const Rows& bev, const EgoPoses& poses, const TrackSet* past,
                       UniadMemory& memory, DetectedTracks& seen) {
  start(poses, past, memory);
  decode(bev, memory, seen);
  answer(memory, seen);
  keep(memory, seen);
}

MapDecoder::MapDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
                       inference::InstructionSet set)
    : architecture_(architecture),
      content_(tableRows({set, tensors}, "map.content")),
      position_(tableRows({set, tensors}, "map.position")),
      reference_(tableRows({set, tensors}, "map.reference")) {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < architecture.decoder_layers; ++i) {
    const std::string name = "map." + std::to_string(i);
    layers_.push_back({{weights, name, architecture.ego},
                       {weights, name + ".norm"},
                       {weights, name + ".class"},
                       {weights, name + ".points"}});
  }
}

/// The points of a line as they are now.
std::array<Eigen::Vector2d, kMapPoints> MapDecoder::pointsOf(std::int64_t line) const {
  std::array<Eigen::Vector2d, kMapPoints> places;
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = placeOf(architecture_.ego.bev, points_.row(line) + 2 * static_cast<int>(i));
  return places;
}

void MapDecoder::decode(const Rows& bev, UniadMemory& memory, const Rows& tokens) {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t lines = architecture_.map_lines, numbers = 2 * kMapPoints;
  for (const Layer& layer : layers_) {
    std::vector<float> cells;
    for (std::int64_t line = 0; line < lines; ++line) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& point : pointsOf(line)) sum += point;
      addCell(grid, sum / static_cast<double>(kMapPoints), cells);
    }
    layer.layer.run(x_, position_, cells, bev, grid.grid(), memory.transformer, memory.deformable);
    layer.norm.apply(x_.view(), tokens.view(), lines);
    memory.head.resize(lines, numbers);
    layer.points.apply(tokens.view(), memory.head.view(), lines, memory.transformer.hidden);
    for (std::int64_t line = 0; line < lines; ++line)
      inference::addRow(memory.head.row(line), numbers, points_.row(line));
  }
}

std::vector<DetectedLine> MapDecoder::see(const Rows& bev, UniadMemory& memory, Rows& tokens) {
  const std::int64_t lines = architecture_.map_lines, numbers = 2 * kMapPoints;
  x_.resize(lines, architecture_.ego.width);
  points_.resize(lines, numbers);
  tokens.resize(lines, architecture_.ego.width);
  copyQueries(content_, lines, architecture_.ego.width, x_);
  copyQueries(reference_, lines, numbers, points_);
  decode(bev, memory, tokens);
  memory.head.resize(lines, kMapKinds);
  layers_.back().kinds.apply(tokens.view(), memory.head.view(), lines);
  std::vector<DetectedLine> seen(static_cast<std::size_t>(lines));
  for (std::int64_t line = 0; line < lines; ++line) {
    DetectedLine& one = seen[static_cast<std::size_t>(line)];
    one.points = pointsOf(line);
    std::copy_n(memory.head.row(line), kMapKinds, one.scores.begin());
  }
  return seen;
}

}  // namespace cdiff::planners
