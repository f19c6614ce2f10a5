// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"

namespace cdiff::planners {
namespace {

/// Unit vectors (cosine, sine) of boxes' headings [B, A, 2].
at::Tensor headingsOf(const at::Tensor& boxes) {
  const at::Tensor heading = at::stack({boxes.select(2, 7), boxes.select(2, 6)}, 2);
  return heading / at::sqrt(heading.square().sum(2, true) + 1e-6);
}

/// MotionGroup of boxes [B, A].
at::Tensor groupsOf(const at::Tensor& boxes) {
  std::vector<std::int64_t> groups;
  const std::vector<float> numbers = learning::toVector(boxes.to(at::kCPU).contiguous());
  for (std::size_t i = 0; i < numbers.size(); i += kBoxNumbers)
    groups.push_back(
        static_cast<std::int64_t>(motionGroupOf(std::exp(static_cast<double>(numbers[i + 3])),
                                                std::exp(static_cast<double>(numbers[i + 2])))));
  return learning::toIndices(groups, {boxes.size(0), boxes.size(1)}, boxes.device());
}

}  // namespace

at::Tensor UniadMiniNet::readBev(const std::string& name, const at::Tensor& x,
                                 const at::Tensor& shares, const at::Tensor& bev) const {
  const CameraEgoSizes& sizes = architecture_.ego;
  BatchReading reading{querySizes(sizes), sizes.bev.grid(), 1, {}};
  const at::Tensor cells = cellsOfShares(sizes.bev, shares.detach()).to(at::kCPU).contiguous();
  for (std::int64_t b = 0; b < x.size(0); ++b)
    reading.plans.push_back(std::make_shared<inference::SamplingPlan>(inference::planAround(
        cells.data_ptr<float>() + b * x.size(1) * 2, x.size(1), kQueryPoints)));
  const at::Tensor asking = plans_.norm(name + ".norm", x).flatten(0, 1);
  return plans_.deformable(name, asking, bev, reading).reshape(x.sizes());
}

std::pair<at::Tensor, at::Tensor> UniadMiniNet::startModes(const TrackAnswer& tracks) const {
  const at::Tensor boxes = tracks.boxes.back().detach();
  const std::int64_t samples = boxes.size(0), rows = architecture_.rows();
  const at::Tensor ego_group =
      learning::toIndices(std::vector<std::int64_t>(static_cast<std::size_t>(samples), 0),
                          {samples, 1}, boxes.device());
  const at::Tensor groups = at::cat({groupsOf(boxes), ego_group}, 1).reshape({-1});
  const at::Tensor own =
      anchors_.index_select(0, groups).reshape({samples, rows, kMotionModes, kEgoWaypoints, 2});
  const at::Tensor ahead =
      learning::toTensor({1.0F, 0.0F}, {1, 1, 2}, boxes.device()).expand({samples, 1, 2});
  const at::Tensor forward =
      at::cat({headingsOf(boxes), ahead}, 1).reshape({samples, rows, 1, 1, 2});
  const at::Tensor left = at::stack({-forward.select(4, 1), forward.select(4, 0)}, 4);
  const at::Tensor turned = forward * own.narrow(4, 0, 1) + left * own.narrow(4, 1, 1);
  const auto end = [](const at::Tensor& ways) { return ways.select(3, kEgoWaypoints - 1); };
  const at::Tensor centers = metersOfShares(architecture_.ego.bev, tracks.centers).unsqueeze(2);
  const at::Tensor shares = sharesOfMeters(architecture_.ego.bev, centers + end(turned));
  const at::Tensor numbers =
      at::cat({end(own) / kAnchorUnit, end(turned) / kAnchorUnit, 2.0 * shares - 1.0}, 3);
  return {turned, plans_.mlp("motion.anchor", numbers) + plans_.table("mode") +
                      tracks.features.unsqueeze(2)};
}

at::Tensor UniadMiniNet::fuse(const std::string& name, const at::Tensor& x,
                              const at::Tensor& shares, const MotionSurroundings& around) const {
  const at::Tensor of_agents = x + plans_.attention(name + ".agents", x, {}, around.tracks);
  const at::Tensor of_map = x + plans_.attention(name + ".map", x, {}, around.map);
  const at::Tensor of_bev = x + readBev(name + ".bev", x, shares, around.bev);
  return plans_.mlp(name + ".fuse", at::cat({of_agents, of_map, of_bev, around.own}, 2));
}

MotionAnswer UniadMiniNet::forecast(const at::Tensor& bev, const TrackAnswer& tracks,
                                    const MapAnswer& map) const {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t samples = tracks.features.size(0), rows = architecture_.rows(),
                     width = architecture_.ego.width;
  const at::Tensor centers = metersOfShares(grid, tracks.centers).unsqueeze(2);
  const auto [turned, start] = startModes(tracks);
  at::Tensor x = start.reshape({samples, rows * kMotionModes, width});
  const MotionSurroundings around = {
      bev, tracks.features + place(tracks.centers), map.tokens,
      tracks.features.unsqueeze(2).expand({samples, rows, kMotionModes, width}).reshape(x.sizes())};
  at::Tensor ways = turned;
  MotionAnswer answer;
  for (std::int64_t i = 0; i < architecture_.motion_layers; ++i) {
    const std::string name = "motion." + std::to_string(i);
    const at::Tensor ends = centers + ways.select(3, kEgoWaypoints - 1);
    x = fuse(name, x, sharesOfMeters(grid, ends).reshape({samples, -1, 2}), around);
    const at::Tensor normed = plans_.norm(name + ".norm", x);
    const at::Tensor numbers =
        plans_.mlp(name + ".offset", normed)
            .reshape({samples, rows, kMotionModes, kEgoWaypoints, kGaussianNumbers});
    ways = turned + at::cumsum(kOffsetUnit * numbers.narrow(4, 0, 2), 3);
    answer.ways.push_back(ways);
    answer.spreads.push_back(numbers.narrow(4, 2, 3));
    answer.logits.push_back(
        plans_.mlp(name + ".score", normed).reshape({samples, rows, kMotionModes}));
    answer.modes = normed.reshape({samples, rows, kMotionModes, width});
  }
  return answer;
}

}  // namespace cdiff::planners
