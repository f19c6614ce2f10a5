// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_trainer_network.h"

namespace cdiff::planners {
namespace {

/// [..., 12] offsets in kOffsetUnit -> [..., 6, 2] places [m].
at::Tensor placesOf(const at::Tensor& offsets) {
  std::vector<std::int64_t> shape = offsets.sizes().vec();
  shape.back() = kEgoWaypoints;
  shape.push_back(2);
  return at::cumsum(kOffsetUnit * offsets.reshape(shape), -2);
}

/// [N, width] for each of B samples: [B, N, width].
at::Tensor repeated(const at::Tensor& rows, std::int64_t samples) {
  return rows.unsqueeze(0).expand({samples, rows.size(0), rows.size(1)});
}

}  // namespace

VadMiniNet::VadMiniNet(const VadMiniArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture),
      parameters_(core::RandomStream(seed, "vad_mini start")),
      layers_(parameters_, architecture.ego),
      bev_(layers_) {
  declareCameraEgo(vadMiniTensors(architecture), architecture.ego.heads, parameters_);
}

void VadMiniNet::seeAgents(const at::Tensor& bev, std::int64_t samples, VadMiniAnswer& answer,
                           Detections& seen) const {
  const BevGrid& grid = architecture_.ego.bev;
  at::Tensor x = repeated(layers_.table("agent.content"), samples);
  at::Tensor reference = repeated(layers_.table("agent.reference"), samples);
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = "agent." + std::to_string(i);
    x = layers_.queryLayer(name, x, layers_.table("agent.position"),
                           cellsOfShares(grid, at::sigmoid(reference)), bev);
    seen.agents = layers_.norm(name + ".norm", x);
    const at::Tensor box = layers_.mlp(name + ".box", seen.agents);
    reference = reference + box.narrow(2, 0, 2);
    const at::Tensor shares = at::sigmoid(reference);
    answer.agent_logits.push_back(layers_.linear(name + ".class", seen.agents));
    answer.boxes.push_back(at::cat(
        {metersOfShares(grid, shares), box.narrow(2, 2, 6), kVelocityUnit * box.narrow(2, 8, 2)},
        2));
    seen.centers = shares.detach();
    reference = reference.detach();
  }
}

void VadMiniNet::seeMap(const at::Tensor& bev, std::int64_t samples, VadMiniAnswer& answer,
                        Detections& seen) const {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t width = architecture_.ego.width, lines = architecture_.map_lines;
  const auto queries = [&](const char* part) {
    return (layers_.table(std::string("map.line_") + part).unsqueeze(1) +
            layers_.table(std::string("map.point_") + part))
        .reshape({lines * kMapPoints, width});
  };
  const at::Tensor position = queries("position");
  at::Tensor x = repeated(queries("content"), samples);
  at::Tensor reference = repeated(layers_.table("map.reference"), samples);
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = "map." + std::to_string(i);
    x = layers_.queryLayer(name, x, position, cellsOfShares(grid, at::sigmoid(reference)), bev);
    const at::Tensor normed = layers_.norm(name + ".norm", x);
    reference = reference + layers_.mlp(name + ".point", normed);
    seen.tokens = normed.reshape({samples, lines, kMapPoints, width}).mean(2);
    answer.line_logits.push_back(layers_.linear(name + ".class", seen.tokens));
    answer.lines.push_back(at::sigmoid(reference).reshape({samples, lines, kMapPoints, 2}));
    reference = reference.detach();
  }
  const at::Tensor shape = layers_.mlp("map.shape", 2.0 * answer.lines.back().detach() - 1.0);
  seen.tokens = seen.tokens + shape.amax(2);
  seen.nearest = nearestPoints(answer.lines.back().detach());
}

at::Tensor VadMiniNet::nearestPoints(const at::Tensor& lines) const {
  const at::Tensor meters = metersOfShares(architecture_.ego.bev, lines);
  const at::Tensor index = meters.square().sum(3).argmin(2, true).unsqueeze(3);
  return lines.gather(2, index.expand({-1, -1, 1, 2})).squeeze(2);
}

at::Tensor VadMiniNet::interact(const std::string& name, const at::Tensor& x,
                                const at::Tensor& position, const at::Tensor& context) const {
  const at::Tensor y = x + layers_.attention(name, x, position, context);
  return y + layers_.mix(name + ".mix", y);
}

at::Tensor VadMiniNet::forecast(const Detections& seen, VadMiniAnswer& answer) const {
  const std::int64_t samples = seen.agents.size(0), agents = architecture_.agents,
                     width = architecture_.ego.width;
  const at::Tensor own = seen.agents.unsqueeze(2).expand({samples, agents, kMotionModes, width});
  at::Tensor x = (own + layers_.table("mode")).reshape({samples, agents * kMotionModes, width});
  const at::Tensor position = place(seen.centers)
                                  .unsqueeze(2)
                                  .expand({samples, agents, kMotionModes, width})
                                  .reshape(x.sizes());
  x = interact("motion.agents", x, position, {});
  x = interact("motion.map", x, {}, seen.tokens);
  const at::Tensor joined = at::cat({own.reshape(x.sizes()), layers_.norm("motion.norm", x)}, 2);
  answer.ways = placesOf(layers_.mlp("motion.offset", joined))
                    .reshape({samples, agents, kMotionModes, kEgoWaypoints, 2});
  answer.way_logits = layers_.mlp("motion.score", joined).reshape({samples, agents, kMotionModes});
  return joined;
}

void VadMiniNet::plan(const at::Tensor& bev, const Detections& seen, const at::Tensor& joined,
                      VadMiniAnswer& answer) const {
  const std::int64_t samples = seen.agents.size(0), width = architecture_.ego.width;
  const Eigen::Vector2f cell = architecture_.ego.bev.toCell(Eigen::Vector2d::Zero()).cast<float>();
  const inference::CellCorners corners(architecture_.ego.bev.grid(), 0, cell.x(), cell.y());
  const at::Tensor cells = bev.reshape({samples, architecture_.ego.bev.cells(), width});
  at::Tensor below = at::zeros({samples, 1, width}, bev.options());
  for (int i = 0; i < 4; ++i) {
    if (corners.row[i] >= 0) below = below + corners.share[i] * cells.narrow(1, corners.row[i], 1);
  }
  at::Tensor ego = layers_.table("ego") + layers_.linear("ego.bev", below);
  const at::Tensor fused = layers_.mlp(
      "fuse", joined.reshape({samples, architecture_.agents, kMotionModes * 2 * width}));
  const at::Tensor first = interact("ego.agents", ego, {}, fused + place(seen.centers));
  const at::Tensor second = interact("ego.map", first, {}, seen.tokens + place(seen.nearest));
  const at::Tensor both = layers_.norm("ego.norm", at::cat({first, second}, 2));
  answer.plans =
      placesOf(layers_.mlp("plan", both).reshape({samples, kRoadCommands, 2 * kEgoWaypoints}));
}

VadMiniAnswer VadMiniNet::answer(const at::Tensor& bev, std::int64_t samples) const {
  VadMiniAnswer answer;
  Detections seen;
  seeAgents(bev, samples, answer, seen);
  seeMap(bev, samples, answer, seen);
  const at::Tensor joined = forecast(seen, answer);
  plan(bev, seen, joined, answer);
  return answer;
}

}  // namespace cdiff::planners
