// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_layers.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/pluto/pluto_weights.h"

namespace cdiff::planners {
namespace {

using inference::Activation;
using inference::Convolution;
using inference::Filter;
using inference::LayerWeights;
using inference::Rows;
using inference::Spacing;
using inference::View;

constexpr float kTwoPi = static_cast<float>(2.0 * core::kPi);

const std::vector<float>& tableValues(const LayerWeights& weights, const std::string& name) {
  return weights.named("table." + name).values;
}

Convolution timeConvolution(const LayerWeights& weights, const std::string& name,
                            std::int64_t stride) {
  return Convolution(weights.linear, Filter::ofConvolution(weights.named(name + ".weight")),
                     Spacing{stride, 1}, &weights.named(name + ".bias"));
}

Activation timeRows(const LayerWeights& weights, const std::string& name, std::int64_t axis,
                    std::int64_t rows) {
  const std::int64_t channels =
      weights.named(name + ".weight").shape[static_cast<std::size_t>(axis)];
  Activation activation({channels}, rows, 1);
  activation.resize(1);
  return activation;
}

void rectify(const View& rows, std::int64_t count) {
  for (std::int64_t i = 0; i < count * rows.row; ++i) rows.data[i] = std::max(0.0F, rows.data[i]);
}

/// The largest of each channel over rows.
void maxOverRows(const Rows& rows, std::int64_t channels, float* output) {
  std::copy_n(rows.row(0), channels, output);
  for (std::int64_t row = 1; row < rows.rows(); ++row) {
    const float* values = rows.row(row);
    for (std::int64_t c = 0; c < channels; ++c) output[c] = std::max(output[c], values[c]);
  }
}

}  // namespace

Rows tableRows(const LayerWeights& weights, const std::string& name) {
  const inference::Tensor& tensor = weights.named("table." + name);
  Rows rows;
  rows.resize(tensor.shape[0], tensor.shape[1]);
  for (std::int64_t row = 0; row < tensor.shape[0]; ++row)
    std::copy_n(tensor.values.data() + row * tensor.shape[1], tensor.shape[1], rows.row(row));
  return rows;
}

PositionEmbedding::PositionEmbedding(const LayerWeights& weights)
    : frequencies_(tableValues(weights, "position.frequency")), mlp_(weights, "position") {}

void PositionEmbedding::apply(const std::vector<PlutoPose>& poses, Rows& output) {
  const auto count = static_cast<std::int64_t>(poses.size());
  const auto frequencies = static_cast<std::size_t>(kPlutoFrequencies);
  features_.resize(count, kPoseNumbers * (2 * kPlutoFrequencies + 1));
  for (std::int64_t i = 0; i < count; ++i) {
    float* feature = features_.row(i);
    for (std::size_t n = 0; n < static_cast<std::size_t>(kPoseNumbers); ++n) {
      const float x = poses[static_cast<std::size_t>(i)][n];
      for (std::size_t f = 0; f < frequencies; ++f) {
        const float angle = x * frequencies_[n * frequencies + f] * kTwoPi;
        feature[f] = std::cos(angle);
        feature[frequencies + f] = std::sin(angle);
      }
      feature[2 * frequencies] = x;
      feature += 2 * frequencies + 1;
    }
  }
  output.resize(count, mlp_.outputs());
  mlp_.apply(features_.view(), output.view(), count, hidden_);
}

PointNet::PointNet(const LayerWeights& weights, const std::string& name)
    : first_(weights, name + ".first"), second_(weights, name + ".second") {}

void PointNet::apply(const float* points, std::int64_t count, std::int64_t channels,
                     float* output) {
  const std::int64_t width = first_.outputs();
  points_.resize(count, channels);
  middle_.resize(count, 2 * width);
  last_.resize(count, width);
  inference::copyIn(points, count, channels, points_.view());
  first_.apply(points_.view(), middle_.view(), count, hidden_);
  std::copy_n(middle_.row(0), width, output);
  for (std::int64_t row = 1; row < count; ++row) {
    const float* values = middle_.row(row);
    for (std::int64_t c = 0; c < width; ++c) output[c] = std::max(output[c], values[c]);
  }
  for (std::int64_t row = 0; row < count; ++row)
    std::copy_n(output, width, middle_.row(row) + width);
  second_.apply(middle_.view(), last_.view(), count, hidden_);
  maxOverRows(last_, width, output);
}

HistoryNet::HistoryNet(const LayerWeights& weights)
    : first_(timeConvolution(weights, "agent.conv1", 1)),
      second_(timeConvolution(weights, "agent.conv2", 2)),
      third_(timeConvolution(weights, "agent.conv3", 2)),
      join_(weights, "agent.join"),
      history_(timeRows(weights, "agent.conv1", 1, kPlutoHistory)),
      middle1_(timeRows(weights, "agent.conv1", 0, kPlutoHistory)),
      middle2_(timeRows(weights, "agent.conv2", 0, kPlutoHistory / 2)),
      middle3_(timeRows(weights, "agent.conv3", 0, kPlutoHistory / 4)) {}

void HistoryNet::apply(const std::vector<PlutoAgent>& agents, Rows& output) {
  const auto count = static_cast<std::int64_t>(agents.size());
  const std::int64_t joined = middle3_.rows() * middle3_.channels();
  output.resize(count, join_.outputs());
  joined_.resize(count, joined);
  for (std::int64_t i = 0; i < count; ++i) {
    inference::copyIn(agents[static_cast<std::size_t>(i)].history.data(), kPlutoHistory,
                      kAgentChannels, history_.view());
    first_.apply(history_.view(), middle1_.view(), middle1_.rows());
    rectify(middle1_.view(), middle1_.rows());
    second_.apply(middle1_.view(), middle2_.view(), middle2_.rows());
    rectify(middle2_.view(), middle2_.rows());
    third_.apply(middle2_.view(), middle3_.view(), middle3_.rows());
    rectify(middle3_.view(), middle3_.rows());
    std::copy_n(middle3_.row(0), joined, joined_.row(i));
  }
  join_.apply(joined_.view(), output.view(), count);
}

OwnStateEncoder::OwnStateEncoder(const LayerWeights& weights,
                                 const inference::TransformerSizes& sizes)
    : kernels_(&weights.kernels),
      sizes_(sizes),
      query_(tableRows(weights, "own.query")),
      place_(tableValues(weights, "own.place")),
      gain_(tableValues(weights, "own.gain")),
      key_value_(weights, "own.key_value"),
      output_(weights, "own.output") {}

void OwnStateEncoder::apply(const std::array<float, kMotionNumbers>& motion, const View& output,
                            inference::TransformerMemory& memory) {
  const std::int64_t width = sizes_.width;
  constexpr std::int64_t kTokens = kMotionNumbers + 1;
  tokens_.resize(kTokens, width);
  memory.query.resize(1, width);
  memory.key_value.resize(kTokens, 2 * width);
  memory.mixed.resize(1, width);
  std::copy_n(query_.row(0), width, memory.query.row(0));
  for (std::int64_t token = 0; token < kTokens; ++token) {
    float* row = tokens_.row(token);
    std::copy_n(place_.data() + token * width, width, row);
    if (token == 0) continue;
    const float value = motion[static_cast<std::size_t>(token - 1)];
    const float* gain = gain_.data() + (token - 1) * width;
    for (std::int64_t i = 0; i < width; ++i) row[i] += value * gain[i];
  }
  key_value_.apply(tokens_.view(), memory.key_value.view(), kTokens);
  inference::attendRows(*kernels_, sizes_, {0, 1, 1}, {0, 1, kTokens}, memory);
  output_.apply(memory.mixed.view(), output, 1);
}

}  // namespace cdiff::planners
