// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The part of the network behind the decoders: forecasts of the agents, and the plan.
#include <algorithm>

#include "planners/vad_mini/vad_mini_network.h"

namespace cdiff::planners {
namespace {

/// Six offsets in kOffsetUnit, added up from `start`.
EgoWaypoints waypointsOf(const float* offsets, const Eigen::Vector2d& start) {
  EgoWaypoints places;
  Eigen::Vector2d place = start;
  for (std::size_t i = 0; i < places.size(); ++i) {
    place += kOffsetUnit * Eigen::Vector2d(offsets[2 * i], offsets[2 * i + 1]);
    places[i] = place;
  }
  return places;
}

/// The point of a line that is nearest to the ego.
Eigen::Vector2d nearestPoint(const DetectedLine& line) {
  return *std::min_element(line.points.begin(), line.points.end(),
                           [](const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
                             return left.squaredNorm() < right.squaredNorm();
                           });
}

}  // namespace

void VadMiniNetwork::forecast(VadMiniOutput& output) {
  const std::int64_t width = architecture_.ego.width;
  modes_ = rowSums(agents_, mode_, width);
  std::vector<Eigen::Vector2d> places;
  for (const DetectedAgent& agent : output.agents) {
    for (std::int64_t mode = 0; mode < kMotionModes; ++mode)
      places.emplace_back(agent.box[0], agent.box[1]);
  }
  embedPlaces(places, positions_);
  motion_agents_.attention.attendSelf({{0, 1, modes_.rows()}}, modes_, positions_, memory_);
  motion_agents_.mix.apply(modes_, memory_);
  motion_map_.attention.attendTo(map_tokens_, modes_, memory_);
  motion_map_.mix.apply(modes_, memory_);
  motion_norm_.apply(modes_.view(), modes_.view(), modes_.rows());
  joined_.resize(modes_.rows(), 2 * width);
  for (std::int64_t row = 0; row < modes_.rows(); ++row) {
    std::copy_n(agents_.row(row / kMotionModes), width, joined_.row(row));
    std::copy_n(modes_.row(row), width, joined_.row(row) + width);
  }
  readForecasts(output);
}

void VadMiniNetwork::readForecasts(VadMiniOutput& output) {
  const std::int64_t rows = joined_.rows();
  head_.resize(rows, 2 * kEgoWaypoints);
  motion_offset_.apply(joined_.view(), head_.view(), rows, memory_.hidden);
  for (std::int64_t row = 0; row < rows; ++row) {
    DetectedAgent& agent = output.agents[static_cast<std::size_t>(row / kMotionModes)];
    agent.ways[static_cast<std::size_t>(row % kMotionModes)] =
        waypointsOf(head_.row(row), {agent.box[0], agent.box[1]});
  }
  head_.resize(rows, 1);
  motion_score_.apply(joined_.view(), head_.view(), rows, memory_.hidden);
  for (std::int64_t row = 0; row < rows; ++row)
    output.agents[static_cast<std::size_t>(row / kMotionModes)]
        .way_scores[static_cast<std::size_t>(row % kMotionModes)] = head_.row(row)[0];
}

/// The learned query and what the BEV holds at the ego's place.
void VadMiniNetwork::startEgo() {
  const std::int64_t width = architecture_.ego.width;
  const Eigen::Vector2f cell = architecture_.ego.bev.toCell(Eigen::Vector2d::Zero()).cast<float>();
  const inference::CellCorners corners(architecture_.ego.bev.grid(), 0, cell.x(), cell.y());
  ego_joined_.resize(1, width);
  std::fill_n(ego_joined_.row(0), width, 0.0F);
  for (int i = 0; i < 4; ++i) {
    for (std::int64_t c = 0; corners.row[i] >= 0 && c < width; ++c)
      ego_joined_.row(0)[c] += corners.share[i] * bev_->row(corners.row[i])[c];
  }
  ego_row_.resize(1, width);
  ego_bev_.apply(ego_joined_.view(), ego_row_.view(), 1);
  inference::addRow(ego_.row(0), width, ego_row_.row(0));
}

void VadMiniNetwork::plan(VadMiniOutput& output) {
  const std::int64_t width = architecture_.ego.width, agents = architecture_.agents;
  startEgo();
  // The rows of joined_ are dense, since 2 x width is a multiple of 16: an agent's modes side by
  // side are one row.
  tokens_.resize(agents, width);
  fuse_.apply({joined_.row(0), kMotionModes * joined_.stride()}, tokens_.view(), agents,
              memory_.hidden);
  std::vector<Eigen::Vector2d> places;
  for (const DetectedAgent& agent : output.agents) places.emplace_back(agent.box[0], agent.box[1]);
  embedPlaces(places, positions_);
  for (std::int64_t i = 0; i < agents; ++i)
    inference::addRow(positions_.row(i), width, tokens_.row(i));
  ego_agents_.attention.attendTo(tokens_, ego_row_, memory_);
  ego_agents_.mix.apply(ego_row_, memory_);
  ego_joined_.resize(1, 2 * width);
  std::copy_n(ego_row_.row(0), width, ego_joined_.row(0));
  places.clear();
  for (const DetectedLine& line : output.lines) places.push_back(nearestPoint(line));
  embedPlaces(places, positions_);
  for (std::int64_t i = 0; i < map_tokens_.rows(); ++i)
    inference::addRow(positions_.row(i), width, map_tokens_.row(i));
  ego_map_.attention.attendTo(map_tokens_, ego_row_, memory_);
  ego_map_.mix.apply(ego_row_, memory_);
  std::copy_n(ego_row_.row(0), width, ego_joined_.row(0) + width);
  ego_norm_.apply(ego_joined_.view(), ego_joined_.view(), 1);
  head_.resize(1, kRoadCommands * 2 * kEgoWaypoints);
  plan_.apply(ego_joined_.view(), head_.view(), 1, memory_.hidden);
  for (std::int64_t command = 0; command < kRoadCommands; ++command)
    output.plans[static_cast<std::size_t>(command)] =
        waypointsOf(head_.row(0) + command * 2 * kEgoWaypoints, Eigen::Vector2d::Zero());
}

}  // namespace cdiff::planners
