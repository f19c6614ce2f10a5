// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/vad_mini_network.h"

#include <algorithm>
#include <cmath>

#include "planners/pluto/pluto_layers.h"

namespace cdiff::planners {
namespace {

using inference::LayerWeights;
using inference::Rows;

void copyRows(const Rows& from, std::int64_t channels, Rows& to) {
  to.resize(from.rows(), channels);
  for (std::int64_t row = 0; row < from.rows(); ++row)
    std::copy_n(from.row(row), channels, to.row(row));
}

Eigen::Vector2d shareOf(const float* reference) {
  return {logistic(reference[0]), logistic(reference[1])};
}

/// Where references lie on the BEV, (column, row) in cells.
std::vector<float> cellsOf(const BevGrid& bev, const Rows& references) {
  std::vector<float> cells;
  for (std::int64_t row = 0; row < references.rows(); ++row) {
    const Eigen::Vector2d cell = bev.toCell(bev.fromShare(shareOf(references.row(row))));
    cells.push_back(static_cast<float>(cell.x()));
    cells.push_back(static_cast<float>(cell.y()));
  }
  return cells;
}

bool allFinite(const EgoWaypoints& places) {
  return std::all_of(places.begin(), places.end(),
                     [](const Eigen::Vector2d& place) { return place.allFinite(); });
}

}  // namespace

double logistic(float logit) { return 1.0 / (1.0 + std::exp(-static_cast<double>(logit))); }

Rows rowSums(const Rows& first, const Rows& second, std::int64_t channels) {
  Rows sums;
  sums.resize(first.rows() * second.rows(), channels);
  for (std::int64_t row = 0; row < sums.rows(); ++row) {
    std::copy_n(first.row(row / second.rows()), channels, sums.row(row));
    inference::addRow(second.row(row % second.rows()), channels, sums.row(row));
  }
  return sums;
}

bool VadMiniOutput::finite() const {
  const auto agent_finite = [](const DetectedAgent& agent) {
    return std::isfinite(agent.score) &&
           std::all_of(agent.box.begin(), agent.box.end(),
                       [](float x) { return std::isfinite(x); }) &&
           std::all_of(agent.ways.begin(), agent.ways.end(), allFinite);
  };
  return std::all_of(plans.begin(), plans.end(), allFinite) &&
         std::all_of(agents.begin(), agents.end(), agent_finite);
}

VadMiniNetwork::VadMiniNetwork(const VadMiniModel& model, inference::InstructionSet set)
    : architecture_(model.architecture),
      encoder_(model.architecture.ego, model.weights, set),
      agent_decoders_(decodersOf({set, model.weights}, "agent", ".box")),
      map_decoders_(decodersOf({set, model.weights}, "map", ".point")),
      agent_content_(tableRows({set, model.weights}, "agent.content")),
      agent_position_(tableRows({set, model.weights}, "agent.position")),
      agent_reference_(tableRows({set, model.weights}, "agent.reference")),
      map_content_(rowSums(tableRows({set, model.weights}, "map.line_content"),
                           tableRows({set, model.weights}, "map.point_content"),
                           model.architecture.ego.width)),
      map_position_(rowSums(tableRows({set, model.weights}, "map.line_position"),
                            tableRows({set, model.weights}, "map.point_position"),
                            model.architecture.ego.width)),
      map_reference_(tableRows({set, model.weights}, "map.reference")),
      shape_({set, model.weights}, "map.shape"),
      place_({set, model.weights}, "place"),
      mode_(tableRows({set, model.weights}, "mode")),
      motion_agents_({set, model.weights}, "motion.agents", model.architecture.ego),
      motion_map_({set, model.weights}, "motion.map", model.architecture.ego),
      motion_norm_({set, model.weights}, "motion.norm"),
      motion_offset_({set, model.weights}, "motion.offset"),
      motion_score_({set, model.weights}, "motion.score"),
      fuse_({set, model.weights}, "fuse"),
      ego_(tableRows({set, model.weights}, "ego")),
      ego_bev_({set, model.weights}, "ego.bev"),
      ego_agents_({set, model.weights}, "ego.agents", model.architecture.ego),
      ego_map_({set, model.weights}, "ego.map", model.architecture.ego),
      ego_norm_({set, model.weights}, "ego.norm"),
      plan_({set, model.weights}, "plan") {}

std::vector<VadMiniNetwork::Decoder> VadMiniNetwork::decodersOf(const LayerWeights& weights,
                                                                const std::string& name,
                                                                const char* change) const {
  std::vector<Decoder> decoders;
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string layer = name + "." + std::to_string(i);
    decoders.push_back({{weights, layer, architecture_.ego},
                        {weights, layer + ".norm"},
                        {weights, layer + ".class"},
                        {weights, layer + change}});
  }
  return decoders;
}

void VadMiniNetwork::embedPlaces(const std::vector<Eigen::Vector2d>& places, Rows& rows) {
  const auto count = static_cast<std::int64_t>(places.size());
  points_.resize(count, 2);
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::Vector2d share =
        architecture_.ego.bev.toShare(places[static_cast<std::size_t>(i)]);
    points_.row(i)[0] = static_cast<float>(2.0 * share.x() - 1.0);
    points_.row(i)[1] = static_cast<float>(2.0 * share.y() - 1.0);
  }
  rows.resize(count, architecture_.ego.width);
  place_.apply(points_.view(), rows.view(), count, memory_.hidden);
}

void VadMiniNetwork::seeAgents(VadMiniOutput& output) {
  const BevGrid& bev = architecture_.ego.bev;
  const std::int64_t width = architecture_.ego.width, count = architecture_.agents;
  Rows reference;
  copyRows(agent_reference_, 2, reference);
  copyRows(agent_content_, width, x_);
  for (const Decoder& decoder : agent_decoders_) {
    decoder.layer.run(x_, agent_position_, cellsOf(bev, reference), *bev_, bev.grid(), memory_,
                      deformable_);
    agents_.resize(count, width);
    decoder.norm.apply(x_.view(), agents_.view(), count);
    head_.resize(count, kBoxNumbers);
    decoder.change.apply(agents_.view(), head_.view(), count, memory_.hidden);
    for (std::int64_t i = 0; i < count; ++i) inference::addRow(head_.row(i), 2, reference.row(i));
  }
  output.agents.resize(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    DetectedAgent& agent = output.agents[static_cast<std::size_t>(i)];
    std::copy_n(head_.row(i), kBoxNumbers, agent.box.begin());
    const Eigen::Vector2f center = bev.fromShare(shareOf(reference.row(i))).cast<float>();
    agent.box[0] = center.x();
    agent.box[1] = center.y();
    agent.box[8] *= static_cast<float>(kVelocityUnit);
    agent.box[9] *= static_cast<float>(kVelocityUnit);
  }
  head_.resize(count, 1);
  agent_decoders_.back().kind.apply(agents_.view(), head_.view(), count);
  for (std::int64_t i = 0; i < count; ++i)
    output.agents[static_cast<std::size_t>(i)].score = head_.row(i)[0];
}

void VadMiniNetwork::seeMap(VadMiniOutput& output) {
  const BevGrid& bev = architecture_.ego.bev;
  const std::int64_t width = architecture_.ego.width, count = map_content_.rows();
  Rows reference;
  copyRows(map_reference_, 2, reference);
  copyRows(map_content_, width, x_);
  for (const Decoder& decoder : map_decoders_) {
    decoder.layer.run(x_, map_position_, cellsOf(bev, reference), *bev_, bev.grid(), memory_,
                      deformable_);
    map_points_.resize(count, width);
    decoder.norm.apply(x_.view(), map_points_.view(), count);
    head_.resize(count, 2);
    decoder.change.apply(map_points_.view(), head_.view(), count, memory_.hidden);
    for (std::int64_t i = 0; i < count; ++i) inference::addRow(head_.row(i), 2, reference.row(i));
  }
  output.lines.resize(static_cast<std::size_t>(architecture_.map_lines));
  for (std::int64_t i = 0; i < count; ++i)
    output.lines[static_cast<std::size_t>(i / kMapPoints)]
        .points[static_cast<std::size_t>(i % kMapPoints)] =
        bev.fromShare(shareOf(reference.row(i)));
  scoreLines(map_decoders_.back(), output);
}

/// Mean features of the lines to map_tokens_, and their classes.
void VadMiniNetwork::scoreLines(const Decoder& decoder, VadMiniOutput& output) {
  const std::int64_t width = architecture_.ego.width, lines = architecture_.map_lines;
  map_tokens_.resize(lines, width);
  for (std::int64_t line = 0; line < lines; ++line) {
    float* mean = map_tokens_.row(line);
    std::fill_n(mean, width, 0.0F);
    for (std::int64_t point = 0; point < kMapPoints; ++point)
      inference::addRow(map_points_.row(line * kMapPoints + point), width, mean);
    for (std::int64_t c = 0; c < width; ++c) mean[c] /= static_cast<float>(kMapPoints);
  }
  head_.resize(lines, kMapKinds);
  decoder.kind.apply(map_tokens_.view(), head_.view(), lines);
  for (std::int64_t line = 0; line < lines; ++line)
    std::copy_n(head_.row(line), kMapKinds,
                output.lines[static_cast<std::size_t>(line)].scores.begin());
}

/// Adds the shapes of the lines, the largest of their points' features, to map_tokens_.
void VadMiniNetwork::makeMapTokens(const VadMiniOutput& output) {
  const std::int64_t width = architecture_.ego.width;
  points_.resize(kMapPoints, 2);
  for (std::size_t line = 0; line < output.lines.size(); ++line) {
    for (std::int64_t i = 0; i < kMapPoints; ++i) {
      const Eigen::Vector2d share =
          architecture_.ego.bev.toShare(output.lines[line].points[static_cast<std::size_t>(i)]);
      points_.row(i)[0] = static_cast<float>(2.0 * share.x() - 1.0);
      points_.row(i)[1] = static_cast<float>(2.0 * share.y() - 1.0);
    }
    head_.resize(kMapPoints, width);
    shape_.apply(points_.view(), head_.view(), kMapPoints, memory_.hidden);
    float* token = map_tokens_.row(static_cast<std::int64_t>(line));
    for (std::int64_t c = 0; c < width; ++c) {
      float largest = head_.row(0)[c];
      for (std::int64_t i = 1; i < kMapPoints; ++i) largest = std::max(largest, head_.row(i)[c]);
      token[c] += largest;
    }
  }
}

VadMiniOutput VadMiniNetwork::forward(const VadMiniInput& input) {
  VadMiniOutput output;
  bev_ = &encoder_.encode(input.images, input.motion, input.poses, input.past);
  seeAgents(output);
  seeMap(output);
  makeMapTokens(output);
  forecast(output);
  plan(output);
  return output;
}

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
