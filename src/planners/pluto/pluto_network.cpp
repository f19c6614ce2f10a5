// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_network.h"

#include <algorithm>

namespace cdiff::planners {
namespace {

using inference::addRow;
using inference::LayerWeights;
using inference::PreNormAttention;
using inference::PreNormFeedForward;
using inference::RowSpan;
using inference::TransformerSizes;

TransformerSizes plutoSizes(const PlutoArchitecture& architecture) {
  return {architecture.width, architecture.heads, architecture.hidden};
}

std::string numbered(const char* name, std::int64_t index) {
  return std::string(name) + "." + std::to_string(index);
}

/// A head's rows [candidates, 2 x steps] into two channels of the trajectories.
void takeChannels(const inference::Rows& rows, double unit, Eigen::Index channel,
                  std::vector<PlutoTrajectory>& candidates) {
  const auto scale = static_cast<float>(unit);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const float* values = rows.row(static_cast<std::int64_t>(i));
    for (Eigen::Index step = 0; step < kPlutoSteps; ++step) {
      candidates[i](step, channel) = scale * values[2 * step];
      candidates[i](step, channel + 1) = scale * values[2 * step + 1];
    }
  }
}

}  // namespace

PlutoNetwork::PlutoNetwork(const PlutoModel& model, const std::vector<LanePiece>& pieces,
                           inference::InstructionSet set)
    : architecture_(model.architecture),
      own_({set, model.weights}, plutoSizes(model.architecture)),
      history_({set, model.weights}),
      polygon_net_({set, model.weights}, "polygon"),
      line_net_({set, model.weights}, "line"),
      position_({set, model.weights}),
      kind_(tableRows({set, model.weights}, "agent.kind")),
      internal_(tableRows({set, model.weights}, "polygon.internal")),
      on_route_(tableRows({set, model.weights}, "polygon.on_route")),
      light_(tableRows({set, model.weights}, "polygon.light")),
      limit_(tableRows({set, model.weights}, "polygon.limit")),
      mode_(tableRows({set, model.weights}, "mode")),
      mode_position_(tableRows({set, model.weights}, "mode.position")),
      encoder_norm_({set, model.weights}, "encoder.norm"),
      query_({set, model.weights}, "query"),
      decoder_norm_({set, model.weights}, "decoder.norm"),
      join_({set, model.weights}, "join"),
      place_({set, model.weights}, "place"),
      heading_({set, model.weights}, "heading"),
      velocity_({set, model.weights}, "velocity"),
      score_({set, model.weights}, "score"),
      free_({set, model.weights}, "free") {
  const LayerWeights weights(set, model.weights);
  const TransformerSizes sizes = plutoSizes(architecture_);
  for (std::int64_t i = 0; i < architecture_.encoder_layers; ++i) {
    const std::string name = numbered("encoder", i);
    encoder_.push_back({PreNormAttention(weights, name + ".attention", sizes),
                        PreNormFeedForward(weights, name + ".mix")});
  }
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = numbered("decoder", i);
    decoder_.push_back({PreNormAttention(weights, name + ".lines", sizes),
                        PreNormAttention(weights, name + ".modes", sizes),
                        PreNormAttention(weights, name + ".scene", sizes),
                        PreNormFeedForward(weights, name + ".mix")});
  }
  encodePieces(pieces);
}

void PlutoNetwork::encodePieces(const std::vector<LanePiece>& pieces) {
  piece_features_.resize(static_cast<std::int64_t>(pieces.size()), architecture_.width);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    polygon_net_.apply(pieces[i].points.data(), kPiecePoints, kPieceChannels,
                       piece_features_.row(static_cast<std::int64_t>(i)));
  }
}

/// The vehicle itself, then agents, then polygons; each with its position added.
void PlutoNetwork::embedTokens(const PlutoInput& input) {
  const std::int64_t width = architecture_.width;
  const auto agents = static_cast<std::int64_t>(input.agents.size());
  const auto count = 1 + agents + static_cast<std::int64_t>(input.polygons.size());
  tokens_.resize(count, width);
  own_.apply(input.motion, tokens_.view(), memory_);
  history_.apply(input.agents, agents_);
  std::vector<PlutoPose> poses = {PlutoPose{}};
  for (std::int64_t i = 0; i < agents; ++i) {
    const PlutoAgent& agent = input.agents[static_cast<std::size_t>(i)];
    std::copy_n(agents_.row(i), width, tokens_.row(1 + i));
    addRow(kind_.row(agent.kind), width, tokens_.row(1 + i));
    poses.push_back(agent.pose);
  }
  embedPolygons(input, 1 + agents);
  for (const PlutoPolygon& polygon : input.polygons) poses.push_back(polygon.pose);
  position_.apply(poses, positions_);
  for (std::int64_t i = 0; i < count; ++i) addRow(positions_.row(i), width, tokens_.row(i));
}

void PlutoNetwork::embedPolygons(const PlutoInput& input, std::int64_t first) {
  const std::int64_t width = architecture_.width;
  for (std::size_t i = 0; i < input.polygons.size(); ++i) {
    const PlutoPolygon& polygon = input.polygons[i];
    float* row = tokens_.row(first + static_cast<std::int64_t>(i));
    std::copy_n(piece_features_.row(polygon.piece), width, row);
    addRow(internal_.row(polygon.internal), width, row);
    addRow(on_route_.row(polygon.on_route), width, row);
    addRow(light_.row(polygon.light), width, row);
    for (std::int64_t c = 0; c < width; ++c) row[c] += polygon.limit * limit_.row(0)[c];
  }
}

void PlutoNetwork::encode() {
  const std::vector<RowSpan> whole = {{0, 1, tokens_.rows()}};
  for (const EncoderLayer& layer : encoder_) {
    layer.attention.attendSelf(whole, tokens_, none_, memory_);
    layer.mix.apply(tokens_, memory_);
  }
  encoder_norm_.apply(tokens_.view(), tokens_.view(), tokens_.rows());
}

/// A query for each line and mode: Linear(line, mode).
void PlutoNetwork::makeQueries(const PlutoInput& input) {
  const std::int64_t width = architecture_.width;
  const auto lines = static_cast<std::int64_t>(input.lines.size());
  lines_.resize(lines, width);
  std::vector<PlutoPose> poses;
  for (std::int64_t r = 0; r < lines; ++r) {
    const PlutoLine& line = input.lines[static_cast<std::size_t>(r)];
    const auto points = static_cast<std::int64_t>(line.points.size()) / kLineChannels;
    line_net_.apply(line.points.data(), points, kLineChannels, lines_.row(r));
    poses.push_back(line.pose);
  }
  position_.apply(poses, positions_);
  joined_.resize(lines * kPlutoModes, 2 * width);
  for (std::int64_t r = 0; r < lines; ++r) {
    addRow(positions_.row(r), width, lines_.row(r));
    for (std::int64_t m = 0; m < kPlutoModes; ++m) {
      float* row = joined_.row(r * kPlutoModes + m);
      std::copy_n(lines_.row(r), width, row);
      std::copy_n(mode_.row(m), width, row + width);
    }
  }
  queries_.resize(lines * kPlutoModes, width);
  query_.apply(joined_.view(), queries_.view(), lines * kPlutoModes);
}

void PlutoNetwork::decode(std::int64_t lines) {
  const std::int64_t width = architecture_.width;
  const std::int64_t count = lines * kPlutoModes;
  std::vector<RowSpan> across_lines;
  std::vector<RowSpan> across_modes;
  for (std::int64_t m = 0; m < kPlutoModes; ++m) across_lines.push_back({m, kPlutoModes, lines});
  for (std::int64_t r = 0; r < lines; ++r)
    across_modes.push_back({r * kPlutoModes, 1, kPlutoModes});
  for (const DecoderLayer& layer : decoder_) {
    layer.lines.attendSelf(across_lines, queries_, none_, memory_);
    layer.modes.attendSelf(across_modes, queries_, mode_position_, memory_);
    layer.scene.attendTo(tokens_, queries_, memory_);
    layer.mix.apply(queries_, memory_);
  }
  decoder_norm_.apply(queries_.view(), queries_.view(), count);
  for (std::int64_t i = 0; i < count; ++i) {
    std::copy_n(queries_.row(i), width, joined_.row(i));
    std::copy_n(tokens_.row(0), width, joined_.row(i) + width);
  }
  join_.apply(joined_.view(), queries_.view(), count);
}

void PlutoNetwork::readHeads(PlutoOutput& output) {
  const std::int64_t count = queries_.rows();
  output.candidates.resize(static_cast<std::size_t>(count));
  head_.resize(count, 2 * kPlutoSteps);
  Eigen::Index channel = 0;
  for (const inference::Mlp* head : {&place_, &heading_, &velocity_}) {
    const double unit = channel == 0 ? kPlutoPlaceUnit : channel == 2 ? 1.0 : kPlutoSpeedUnit;
    head->apply(queries_.view(), head_.view(), count, hidden_);
    takeChannels(head_, unit, channel, output.candidates);
    channel += 2;
  }
  head_.resize(count, 1);
  score_.apply(queries_.view(), head_.view(), count, hidden_);
  for (std::int64_t i = 0; i < count; ++i) {
    output.logits.push_back(head_.row(i)[0]);
    const float* feature = queries_.row(i);
    output.features.insert(output.features.end(), feature, feature + architecture_.width);
  }
  head_.resize(1, kFreeChannels * kPlutoSteps);
  free_.apply(tokens_.view(), head_.view(), 1, hidden_);
  output.free = Eigen::Map<const FreeTrajectory>(head_.row(0));
  output.free.leftCols<2>() *= static_cast<float>(kPlutoPlaceUnit);
}

PlutoOutput PlutoNetwork::forward(const PlutoInput& input) {
  PlutoOutput output;
  embedTokens(input);
  encode();
  makeQueries(input);
  decode(static_cast<std::int64_t>(input.lines.size()));
  readHeads(output);
  return output;
}

}  // namespace cdiff::planners
