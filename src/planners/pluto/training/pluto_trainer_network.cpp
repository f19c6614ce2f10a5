// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_trainer_network.h"

#include <cmath>
#include <vector>

#include "e2e_cdiff/core/angle.h"
#include "learning/layers.h"

namespace cdiff::planners {
namespace {

using learning::layerNorm;

/// Of a convolution over time with a kernel of 3, max(0, x) after it: [N, in, T] -> [N, out, T'].
at::Tensor timeConvolved(const learning::ParameterSet& parameters, const std::string& name,
                         const at::Tensor& x, std::int64_t stride) {
  const at::Tensor weight = parameters(name + ".weight").unsqueeze(3);
  return at::relu(
             at::conv2d(x.unsqueeze(3), weight, parameters(name + ".bias"), {stride, 1}, {1, 0}))
      .squeeze(3);
}

/// Evenly spaced in their logarithms: of places from a period of 160 m to one of 2 m, finer than
/// what tells a vehicle beside its lane from one on it; of headings from 4 pi to pi / 4 [3, 16].
at::Tensor firstFrequencies() {
  constexpr double kLowest = 0.5;
  constexpr double kHighestOfPlaces = 40.0;
  constexpr double kHighestOfHeadings = 8.0;
  std::vector<float> values;
  for (const double highest : {kHighestOfPlaces, kHighestOfPlaces, kHighestOfHeadings}) {
    for (std::int64_t i = 0; i < kPlutoFrequencies; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(kPlutoFrequencies - 1);
      values.push_back(static_cast<float>(kLowest * std::pow(highest / kLowest, share)));
    }
  }
  return learning::toTensor(values, {kPoseNumbers, kPlutoFrequencies}, at::kCPU);
}

}  // namespace

PlutoNet::PlutoNet(const PlutoArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture), parameters_(core::RandomStream(seed, "pluto start")) {
  constexpr double kTable = 0.1;  // bound of learned rows
  parameters_.declareAll(plutoTensors(architecture), [](const std::string&) { return kTable; });
  table("position.frequency").copy_(firstFrequencies());
}

at::Tensor PlutoNet::rows(const std::string& table_name, const at::Tensor& indices) const {
  std::vector<std::int64_t> shape = indices.sizes().vec();
  shape.push_back(architecture_.width);
  return table(table_name).index_select(0, indices.flatten()).reshape(shape);
}

at::Tensor PlutoNet::dense(const std::string& name, const at::Tensor& x) const {
  return learning::dense(parameters_, name, x);
}

at::Tensor PlutoNet::mlp(const std::string& name, const at::Tensor& x) const {
  return learning::mlp(parameters_, name, x);
}

/// points [N, L, channels], mask [N, L, 1] or undefined -> [N, width].
at::Tensor PlutoNet::pointNet(const std::string& name, const at::Tensor& points,
                              const at::Tensor& mask) const {
  const auto largest = [&](const at::Tensor& values) {
    return (mask.defined() ? values + mask : values).amax(1, true);
  };
  const at::Tensor first = mlp(name + ".first", points);
  const at::Tensor pooled = largest(first).expand_as(first);
  return largest(mlp(name + ".second", at::cat({first, pooled}, 2))).squeeze(1);
}

/// poses [..., 3] -> [..., width].
at::Tensor PlutoNet::position(const at::Tensor& poses) const {
  const at::Tensor x = poses.unsqueeze(-1);
  const at::Tensor angles = x * table("position.frequency") * (2.0 * core::kPi);
  return mlp("position", at::cat({at::cos(angles), at::sin(angles), x}, -1).flatten(-2));
}

/// [B, 1, width].
at::Tensor PlutoNet::own(const PlutoBatch& batch) const {
  const std::int64_t moments = batch.motion.size(0);
  const at::Tensor place = table("own.place").expand({moments, -1, -1});
  const at::Tensor scaled = batch.motion.unsqueeze(2) * table("own.gain");
  const at::Tensor tokens = place + at::constant_pad_nd(scaled, {0, 0, 1, 0});
  const at::Tensor query = table("own.query").expand({moments, 1, -1});
  const at::Tensor key_value = dense("own.key_value", tokens);
  return dense("own.output",
               learning::attend(query, key_value, architecture_.heads, batch.motion_mask).mixed);
}

/// [B, A, width].
at::Tensor PlutoNet::agents(const PlutoBatch& batch) const {
  const std::int64_t moments = batch.history.size(0);
  const std::int64_t count = batch.history.size(1);
  const at::Tensor history = batch.history.flatten(0, 1).transpose(1, 2).contiguous();
  at::Tensor x = timeConvolved(parameters_, "agent.conv1", history, 1);
  x = timeConvolved(parameters_, "agent.conv2", x, 2);
  x = timeConvolved(parameters_, "agent.conv3", x, 2);
  const at::Tensor joined = dense("agent.join", x.transpose(1, 2).flatten(1));
  return joined.reshape({moments, count, architecture_.width}) + rows("agent.kind", batch.kinds);
}

/// [B, P, width].
at::Tensor PlutoNet::polygons(const PlutoBatch& batch) const {
  const at::Tensor pieces = pointNet("polygon", batch.pieces, {});
  std::vector<std::int64_t> shape = batch.piece_of.sizes().vec();
  shape.push_back(architecture_.width);
  return pieces.index_select(0, batch.piece_of.flatten()).reshape(shape) +
         rows("polygon.internal", batch.internal) + rows("polygon.on_route", batch.on_route) +
         rows("polygon.light", batch.light) + batch.limit * table("polygon.limit");
}

/// What attention to `context` adds to x [B, N, width]; to itself where that is undefined.
at::Tensor PlutoNet::attention(const std::string& name, const at::Tensor& x,
                               const at::Tensor& position, const at::Tensor& context,
                               const at::Tensor& mask) const {
  at::Tensor normed = layerNorm(parameters_, name + ".norm", x);
  if (position.defined()) normed = normed + position;
  const at::Tensor query = dense(name + ".query", normed);
  const at::Tensor key_value = dense(name + ".key_value", context.defined() ? context : normed);
  return dense(name + ".output",
               learning::attend(query, key_value, architecture_.heads, mask).mixed);
}

at::Tensor PlutoNet::feedForward(const std::string& name, const at::Tensor& x) const {
  return dense(name + ".down",
               at::gelu(dense(name + ".up", layerNorm(parameters_, name + ".norm", x))));
}

/// [B, R x 12, width].
at::Tensor PlutoNet::decode(const PlutoBatch& batch, const at::Tensor& tokens) const {
  const std::int64_t b = batch.lines.size(0);
  const std::int64_t r = batch.lines.size(1);
  const std::int64_t width = architecture_.width;
  const at::Tensor lines =
      pointNet("line", batch.lines.flatten(0, 1), batch.point_mask.flatten(0, 1))
          .reshape({b, r, width}) +
      position(batch.line_poses);
  const at::Tensor both = at::cat({lines.unsqueeze(2).expand({b, r, kPlutoModes, width}),
                                   table("mode").expand({b, r, kPlutoModes, width})},
                                  3);
  at::Tensor q = dense("query", both);  // [B, R, M, width]
  const at::Tensor line_mask =
      batch.line_mask.unsqueeze(1).expand({b, kPlutoModes, r}).reshape({b * kPlutoModes, 1, 1, r});
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = "decoder." + std::to_string(i);
    const at::Tensor by_mode = q.transpose(1, 2).reshape({b * kPlutoModes, r, width});
    q = q + attention(name + ".lines", by_mode, {}, {}, line_mask)
                .reshape({b, kPlutoModes, r, width})
                .transpose(1, 2);
    q = q + attention(name + ".modes", q.flatten(0, 1), table("mode.position"), {}, {})
                .reshape({b, r, kPlutoModes, width});
    q = q + attention(name + ".scene", q.flatten(1, 2), {}, tokens, batch.mask).reshape(q.sizes());
    q = q + feedForward(name + ".mix", q);
  }
  const at::Tensor normed = layerNorm(parameters_, "decoder.norm", q.flatten(1, 2));
  return dense("join", at::cat({normed, tokens.narrow(1, 0, 1).expand_as(normed)}, 2));
}

PlutoNet::Features PlutoNet::forward(const PlutoBatch& batch, const LayerFactors& factors) const {
  at::Tensor x = at::cat({own(batch), agents(batch), polygons(batch)}, 1) + position(batch.poses);
  for (std::int64_t i = 0; i < architecture_.encoder_layers; ++i) {
    const std::string name = "encoder." + std::to_string(i);
    const auto kept = [&](const at::Tensor& change, std::size_t half) {
      const std::size_t index = 2 * static_cast<std::size_t>(i) + half;
      return index < factors.size() ? change * factors[index] : change;
    };
    x = x + kept(attention(name + ".attention", x, {}, {}, batch.mask), 0);
    x = x + kept(feedForward(name + ".mix", x), 1);
  }
  const at::Tensor tokens = layerNorm(parameters_, "encoder.norm", x);
  return {tokens, decode(batch, tokens)};
}

at::Tensor PlutoNet::trajectories(const at::Tensor& queries) const {
  const auto pairs = [&](const char* head) {
    return mlp(head, queries).reshape({queries.size(0), kPlutoSteps, 2});
  };
  return at::cat(
      {kPlutoPlaceUnit * pairs("place"), pairs("heading"), kPlutoSpeedUnit * pairs("velocity")}, 2);
}

at::Tensor PlutoNet::scores(const at::Tensor& queries) const {
  return mlp("score", queries).squeeze(1);
}

at::Tensor PlutoNet::freePlans(const at::Tensor& own_tokens) const {
  const at::Tensor plan =
      mlp("free", own_tokens).reshape({own_tokens.size(0), kPlutoSteps, kFreeChannels});
  return at::cat({kPlutoPlaceUnit * plan.narrow(2, 0, 2), plan.narrow(2, 2, 2)}, 2);
}

at::Tensor PlutoNet::forecasts(const at::Tensor& agent_tokens) const {
  const at::Tensor plan =
      mlp("forecast", agent_tokens).reshape({agent_tokens.size(0), kPlutoSteps, kPlutoChannels});
  return at::cat({kPlutoPlaceUnit * plan.narrow(2, 0, 2), plan.narrow(2, 2, 2),
                  kPlutoSpeedUnit * plan.narrow(2, 4, 2)},
                 2);
}

at::Tensor PlutoNet::contrasts(const at::Tensor& own_tokens) const {
  const at::Tensor hidden = mlp("contrast", own_tokens);
  return hidden / (hidden.norm(2, {1}, true) + 1e-6);
}

}  // namespace cdiff::planners
