// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/bev_trainer_network.h"

#include "learning/parameters.h"
#include "planners/camera_ego/training/ego_layers.h"

namespace cdiff::planners {
namespace {

constexpr std::int64_t kGroup = 16;  // channels
constexpr double kNormEpsilon = 1e-5;

}  // namespace

BevNet::BevNet(const EgoLayers& layers)
    : layers_(layers),
      cameras_(static_cast<std::int64_t>(layers.sizes().cameras().cameras.size())) {
  camera_plan_ = std::make_shared<inference::SamplingPlan>(
      cameraPlan(layers.sizes().bev, layers.sizes().cameras(), inference::BackboneSizes::kStride));
}

at::Tensor BevNet::convolved(const std::string& name, const at::Tensor& x, std::int64_t stride,
                             std::int64_t padding) const {
  const at::Tensor weight =
      layers_.tensor(name + ".weight").contiguous(at::MemoryFormat::ChannelsLast);
  return at::conv2d(x, weight, {}, stride, padding);
}

at::Tensor BevNet::groupNorm(const std::string& name, const at::Tensor& x) const {
  return at::group_norm(x, x.size(1) / kGroup, layers_.tensor(name + ".weight"),
                        layers_.tensor(name + ".bias"), kNormEpsilon);
}

at::Tensor BevNet::block(const std::string& name, const at::Tensor& x, std::int64_t stride) const {
  at::Tensor h = at::relu(groupNorm(name + ".norm1", convolved(name + ".conv1", x, stride, 1)));
  h = groupNorm(name + ".norm2", convolved(name + ".conv2", h, 1, 1));
  if (stride == 1) return at::relu(h + x);
  return at::relu(h + groupNorm(name + ".down.norm", convolved(name + ".down.conv", x, stride, 0)));
}

/// images [N, 3, H, W] -> [N x cells, width].
at::Tensor BevNet::features(const at::Tensor& images) const {
  at::Tensor x = images.contiguous(at::MemoryFormat::ChannelsLast);
  x = at::relu(groupNorm("stem.norm", convolved("stem.conv", x, 2, 3)));
  x = at::max_pool2d(x, 3, 2, 1);
  at::Tensor middle;
  for (std::size_t stage = 0; stage < inference::BackboneSizes::kChannels.size(); ++stage) {
    for (std::int64_t b = 0; b < inference::BackboneSizes::kBlocks; ++b)
      x = block("layer" + std::to_string(stage + 1) + "." + std::to_string(b), x,
                stage > 0 && b == 0 ? 2 : 1);
    if (stage == 1) middle = x;
  }
  const at::Tensor high = convolved("pyramid.high", x, 1, 0);
  const at::Tensor low = convolved("pyramid.low", middle, 1, 0);
  x = low + at::upsample_nearest2d(high, {low.size(2), low.size(3)});
  x = at::relu(groupNorm("pyramid.smooth.norm", convolved("pyramid.smooth.conv", x, 1, 1)));
  return x.permute({0, 2, 3, 1}).reshape({-1, layers_.sizes().width});
}

at::Tensor BevNet::encode(const BevBatch& batch, const at::Tensor& past) const {
  const CameraEgoSizes& s = layers_.sizes();
  const std::int64_t samples = batch.motion.size(0), cells = s.bev.cells(), width = s.width;
  const at::Tensor cameras = layers_.table("camera")
                                 .reshape({1, cameras_, 1, width})
                                 .expand({samples, cameras_, s.backbone().grid().cells(), width});
  const at::Tensor features = this->features(batch.images) + cameras.reshape({-1, width});
  at::Tensor bev =
      layers_.table("bev.query") + layers_.mlp("bev.motion", batch.motion).unsqueeze(1);
  at::Tensor before = bev;  // [B, cells, width], in place of a past BEV
  if (past.defined())
    before = batch.has_past * past.reshape(bev.sizes()) + (1.0 - batch.has_past) * bev;
  BatchReading temporal{temporalSizes(s), s.bev.grid(), 2, batch.temporal};
  BatchReading cameras_read{cameraSizes(s), s.backbone().grid(), cameras_, {}};
  cameras_read.plans.assign(static_cast<std::size_t>(samples), camera_plan_);
  for (std::int64_t i = 0; i < s.bev_layers; ++i) {
    const std::string name = "bev." + std::to_string(i);
    const at::Tensor both = at::stack({before, bev}, 1).reshape({-1, width});
    const at::Tensor asking = at::cat({before, bev + layers_.table("bev.position")}, 2);
    at::Tensor change =
        layers_.deformable(name + ".temporal", asking.flatten(0, 1), both, temporal);
    at::Tensor rows = layers_.norm(name + ".temporal.norm", bev.reshape({-1, width}) + change);
    change = layers_.deformable(name + ".cameras", rows, features, cameras_read);
    rows = layers_.norm(name + ".cameras.norm", rows + change);
    rows = layers_.norm(name + ".mix.norm", rows + layers_.feedForward(name + ".mix", rows));
    bev = rows.reshape({samples, cells, width});
  }
  return bev.reshape({-1, width});
}

}  // namespace cdiff::planners
