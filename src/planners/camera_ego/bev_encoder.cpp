// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/bev_encoder.h"

#include <algorithm>

#include "e2e_cdiff/core/angle.h"
#include "planners/pluto/pluto_layers.h"

namespace cdiff::planners {

using inference::LayerWeights;
using inference::Rows;

EgoMotion egoMotion(double speed, double yaw_rate, const EgoPoses& poses) {
  EgoMotion motion{};
  std::array<double, kEgoMotionNumbers> numbers = {speed, yaw_rate, 0.0, 0.0, 0.0};
  if (poses.past) {
    const Eigen::Vector2d way = poses.past->toBody(poses.present.position);
    numbers[2] = way.x();
    numbers[3] = way.y();
    numbers[4] = core::wrapAngle(poses.present.heading - poses.past->heading);
  }
  for (std::size_t i = 0; i < motion.size(); ++i)
    motion[i] = static_cast<float>(numbers[i] / kEgoMotionUnits[i]);
  return motion;
}

BevEncoder::BevEncoder(const CameraEgoSizes& sizes, const WeightTensors& tensors,
                       inference::InstructionSet set)
    : sizes_(sizes),
      backbone_(sizes.backbone(), tensors),
      camera_table_(tableRows({set, tensors}, "camera")),
      queries_(tableRows({set, tensors}, "bev.query")),
      positions_(tableRows({set, tensors}, "bev.position")),
      motion_(LayerWeights(set, tensors), "bev.motion"),
      camera_plan_(cameraPlan(sizes.bev, sizes.cameras(), inference::BackboneSizes::kStride)) {
  const LayerWeights weights(set, tensors);
  for (std::int64_t i = 0; i < sizes.bev_layers; ++i) {
    const std::string name = "bev." + std::to_string(i);
    layers_.push_back({{weights, name + ".temporal", temporalSizes(sizes)},
                       {weights, name + ".temporal.norm"},
                       {weights, name + ".cameras", cameraSizes(sizes)},
                       {weights, name + ".cameras.norm"},
                       {weights, name + ".mix"},
                       {weights, name + ".mix.norm"}});
  }
}

void BevEncoder::lookAtImages(const std::vector<const std::uint8_t*>& images) {
  const std::int64_t cells = sizes_.backbone().grid().cells();
  features_.resize(static_cast<std::int64_t>(images.size()) * cells, sizes_.width);
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    const auto index = static_cast<std::int64_t>(camera);
    backbone_.encode(images[camera], features_.view(index * cells));
    for (std::int64_t cell = 0; cell < cells; ++cell)
      inference::addRow(camera_table_.row(index), sizes_.width,
                        features_.row(index * cells + cell));
  }
}

void BevEncoder::startQueries(const EgoMotion& motion) {
  motion_rows_.resize(1, kEgoMotionNumbers);
  std::copy(motion.begin(), motion.end(), motion_rows_.row(0));
  change_.resize(1, sizes_.width);
  motion_.apply(motion_rows_.view(), change_.view(), 1, memory_.hidden);
  bev_.resize(sizes_.bev.cells(), sizes_.width);
  first_.resize(sizes_.bev.cells(), sizes_.width);
  for (std::int64_t cell = 0; cell < sizes_.bev.cells(); ++cell) {
    std::copy_n(queries_.row(cell), sizes_.width, bev_.row(cell));
    inference::addRow(change_.row(0), sizes_.width, bev_.row(cell));
    std::copy_n(bev_.row(cell), sizes_.width, first_.row(cell));
  }
}

void BevEncoder::run(const Layer& layer, const inference::SamplingPlan& temporal,
                     const Rows* past) {
  const std::int64_t cells = sizes_.bev.cells();
  const std::int64_t width = sizes_.width;
  const Rows& before = past != nullptr ? *past : first_;
  both_.resize(2 * cells, width);
  asking_.resize(cells, 2 * width);
  for (std::int64_t cell = 0; cell < cells; ++cell) {
    std::copy_n(before.row(cell), width, both_.row(cell));
    std::copy_n(bev_.row(cell), width, both_.row(cells + cell));
    std::copy_n(before.row(cell), width, asking_.row(cell));
    std::copy_n(bev_.row(cell), width, asking_.row(cell) + width);
    inference::addRow(positions_.row(cell), width, asking_.row(cell) + width);
  }
  layer.temporal.apply(asking_, both_, sizes_.bev.grid(), temporal, deformable_, change_);
  layer.temporal_norm.apply(bev_.view(), change_.view(), bev_.view(), cells);
  layer.cameras.apply(bev_, features_, sizes_.backbone().grid(), camera_plan_, deformable_,
                      change_);
  layer.cameras_norm.apply(bev_.view(), change_.view(), bev_.view(), cells);
  layer.mix.apply(bev_, memory_);
  layer.mix_norm.apply(bev_.view(), memory_.change.view(), bev_.view(), cells);
}

const Rows& BevEncoder::encode(const std::vector<const std::uint8_t*>& images,
                               const EgoMotion& motion, const EgoPoses& poses, const Rows* past) {
  const bool has_past = sizes_.past_bev && past != nullptr && poses.past.has_value();
  const inference::SamplingPlan temporal =
      temporalPlan(sizes_.bev, poses.present, has_past ? *poses.past : poses.present);
  lookAtImages(images);
  return runLayers(motion, temporal, has_past ? past : nullptr);
}

const Rows& BevEncoder::encodeAlone(const EgoMotion& motion) {
  EgoMotion alone{};
  std::copy_n(motion.begin(), 2, alone.begin());
  return runLayers(alone, temporalPlan(sizes_.bev, {}, {}), nullptr);
}

const Rows& BevEncoder::runLayers(const EgoMotion& motion, const inference::SamplingPlan& temporal,
                                  const Rows* past) {
  startQueries(motion);
  for (const Layer& layer : layers_) run(layer, temporal, past);
  return bev_;
}

QueryLayer::QueryLayer(const LayerWeights& weights, const std::string& name,
                       const CameraEgoSizes& sizes)
    : self_(weights, name + ".self", sizes.transformer()),
      cross_norm_(weights, name + ".cross.norm"),
      cross_(weights, name + ".cross", querySizes(sizes)),
      mix_(weights, name + ".mix") {}

// NOLINTNEXTLINE(readability-function-size): two of seven parameters are scratch memory
void QueryLayer::run(const Rows& x, const Rows& position, const std::vector<float>& places,
                     const Rows& bev, const inference::MapGrid& grid,
                     inference::TransformerMemory& memory,
                     inference::DeformableMemory& deformable) const {
  const std::int64_t rows = x.rows();
  const std::int64_t width = cross_.sizes().width;
  self_.attendSelf({{0, 1, rows}}, x, position, memory);
  memory.normed.resize(rows, width);
  cross_norm_.apply(x.view(), memory.normed.view(), rows);
  for (std::int64_t row = 0; row < rows; ++row)
    inference::addRow(position.row(row), width, memory.normed.row(row));
  cross_.apply(memory.normed, bev, grid, inference::planAround(places.data(), rows, kQueryPoints),
               deformable, memory.change);
  for (std::int64_t row = 0; row < rows; ++row)
    inference::addRow(memory.change.row(row), width, x.row(row));
  mix_.apply(x, memory);
}

}  // namespace cdiff::planners
