// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "planners/uniad_mini/neighbor_cells.h"
#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"

namespace cdiff::planners {
namespace {

/// [B, cells, channels] of the halved map -> of the fine one.
at::Tensor stretched(const inference::MapGrid& fine, const at::Tensor& x) {
  std::vector<std::int64_t> index;
  for (std::int64_t cell = 0; cell < fine.cells(); ++cell) index.push_back(halvedCell(fine, cell));
  return x.index_select(1, learning::toIndices(index, {fine.cells()}, x.device()));
}

/// [B, cells, channels] -> of the halved map.
at::Tensor halved(const inference::MapGrid& fine, const at::Tensor& x) {
  const std::int64_t channels = x.size(2);
  return x.reshape({x.size(0), fine.height / 2, 2, fine.width / 2, 2, channels})
      .mean({2, 4})
      .reshape({x.size(0), fine.cells() / 4, channels});
}

}  // namespace

at::Tensor neighborsOf(const inference::MapGrid& grid, const at::Tensor& x) {
  std::vector<std::int64_t> index = neighborCells(grid);
  for (std::int64_t& cell : index) cell = cell < 0 ? grid.cells() : cell;
  const at::Tensor padded = at::cat({x, at::zeros_like(x.narrow(1, 0, 1))}, 1);
  const auto count = static_cast<std::int64_t>(index.size());
  return padded.index_select(1, learning::toIndices(index, {count}, x.device()))
      .reshape({x.size(0), grid.cells(), kTaps * x.size(2)});
}

at::Tensor UniadMiniNet::agentShares(const TrackAnswer& tracks, const MotionAnswer& motion,
                                     std::int64_t step) const {
  const std::int64_t slots = architecture_.tracks;
  const at::Tensor centers = tracks.centers.narrow(1, 0, slots);
  if (step == 0) return centers;
  const at::Tensor ways = motion.ways.back().narrow(1, 0, slots).select(3, step - 1).detach();
  const at::Tensor best =
      motion.logits.back().narrow(1, 0, slots).argmax(2, true).unsqueeze(3).expand({-1, -1, 1, 2});
  const at::Tensor meters = metersOfShares(architecture_.ego.bev, centers);
  return sharesOfMeters(architecture_.ego.bev, meters + ways.gather(2, best).squeeze(2));
}

at::Tensor UniadMiniNet::nextState(const std::string& name, const at::Tensor& state,
                                   const at::Tensor& placed, const at::Tensor& sure) const {
  const BevGrid& bev = architecture_.ego.bev;
  const inference::MapGrid half = {bev.rows / 2, bev.columns / 2};
  const double mask_logit = std::log(kOccupancyMask / (1.0 - kOccupancyMask));
  at::Tensor next =
      state +
      plans_.linear(name + ".conv", neighborsOf(half, plans_.norm(name + ".conv.norm", state)));
  const at::Tensor normed = plans_.norm(name + ".norm", next);
  const auto product = [](const at::Tensor& cells, const at::Tensor& agents) {
    return at::bmm(cells, agents.transpose(1, 2));  // [B, c, A]
  };
  const at::Tensor masks = product(normed, plans_.linear(name + ".mask", placed));
  const at::Tensor admitted = masks.ge(mask_logit) & sure.unsqueeze(1).gt(0.5);
  const at::Tensor scores =
      product(plans_.linear(name + ".query", normed), plans_.linear(name + ".key", placed)) /
      std::sqrt(static_cast<double>(kOccupancyWidth));
  // Where none is admitted all weights are equal, and then 0.
  const at::Tensor weights = at::softmax(scores.masked_fill(admitted.logical_not(), -1e30), 2) *
                             admitted.to(scores.scalar_type());
  const at::Tensor mixed = at::bmm(weights, plans_.linear(name + ".value", placed));
  next = next + plans_.linear(name + ".output", mixed);
  return next + plans_.mix(name + ".mix", next);
}

at::Tensor UniadMiniNet::occupancy(const at::Tensor& bev, const TrackAnswer& tracks,
                                   const MotionAnswer& motion, const at::Tensor& sure) const {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  const std::int64_t slots = architecture_.tracks, samples = sure.size(0);
  const at::Tensor modes = motion.modes.narrow(1, 0, slots).amax(2);
  const at::Tensor agents =
      plans_.mlp("occupancy.agent", at::cat({tracks.features.narrow(1, 0, slots), modes}, 2));
  const auto onCells = [&](const char* name) {
    return plans_.linear(name, bev).reshape({samples, grid.cells(), kOccupancyWidth});
  };
  at::Tensor state = halved(grid, onCells("occupancy.bev"));
  const at::Tensor base = onCells("occupancy.fine");
  std::vector<at::Tensor> logits;
  for (std::int64_t step = 0; step < kOccupancySteps; ++step) {
    const std::string name = "occupancy." + std::to_string(step);
    const at::Tensor placed = agents + place(agentShares(tracks, motion, step));
    state = nextState(name, state, placed, sure);
    const at::Tensor cells = plans_.norm("occupancy.fine.norm", base + stretched(grid, state));
    logits.push_back(at::bmm(plans_.linear(name + ".mask", placed), cells.transpose(1, 2)));
  }
  return at::stack(logits, 1);
}

at::Tensor UniadMiniNet::plan(const at::Tensor& bev, const TrackAnswer& tracks,
                              const MotionAnswer& motion, const at::Tensor& commands) const {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  const std::int64_t samples = commands.size(0), width = architecture_.ego.width;
  const at::Tensor cells = bev.reshape({samples, grid.cells(), width});
  const at::Tensor narrow = at::relu(plans_.linear("plan.adapter.in", neighborsOf(grid, cells)));
  const at::Tensor tokens =
      plans_.norm("plan.bev.norm", cells + plans_.linear("plan.adapter.out", narrow)) +
      bev_layers_.table("bev.position");
  const at::Tensor modes = motion.modes.select(1, architecture_.tracks);  // [B, M, width]
  const at::Tensor ego = tracks.features.narrow(1, architecture_.tracks, 1).expand(modes.sizes());
  const at::Tensor command =
      plans_.table("command").index_select(0, commands).unsqueeze(1).expand(modes.sizes());
  at::Tensor x = plans_.mlp("plan.query", at::cat({modes, ego, command}, 2)).amax(1, true);
  for (std::int64_t i = 0; i < architecture_.plan_layers; ++i) {
    const std::string name = "plan." + std::to_string(i);
    x = x + plans_.attention(name, x, {}, tokens);
    x = x + plans_.mix(name + ".mix", x);
  }
  const at::Tensor offsets = plans_.mlp("plan.way", plans_.norm("plan.norm", x));
  return at::cumsum(kOffsetUnit * offsets.reshape({samples, kEgoWaypoints, 2}), 1);
}

}  // namespace cdiff::planners
