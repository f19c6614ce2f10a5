// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/deformable_attention.h"
#include "inference/image_backbone.h"
#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// What the BEV is given besides images (body frame, in kEgoMotionUnits).
using EgoMotion = std::array<float, kEgoMotionNumbers>;

/// A pose of the ego now and, where there is a past BEV, then (map frame).
struct EgoPoses {
  geometry::Pose2d present;
  std::optional<geometry::Pose2d> past;
};

/// The numbers of a motion: speed [m/s], yaw rate [rad/s], and what lies between the poses.
EgoMotion egoMotion(double speed, double yaw_rate, const EgoPoses& poses);

/// Camera images to BEV features at run time (Li et al. 2022, BEVFormer): queries of the cells plus
/// the ego's motion; in each layer deformable attention to the past and the present BEV, then to
/// the images that see the cell's pillar, then a feed-forward network, each followed by a
/// normalization of the sum. Without a past BEV the present queries stand for it, as published.
/// Float32, deterministic; one object per thread. The networks of vad_mini and uniad_mini hold one
/// each and call it at each decision. Cells are those of BevGrid, row by row.
class BevEncoder {
 public:
  BevEncoder(const CameraEgoSizes& sizes, const WeightTensors& tensors,
             inference::InstructionSet set);

  /// `images`: rgb8 of the rig's cameras in order, image_width x image_height pixels each; `past`:
  /// the BEV at poses.past, [cells, width], or nullptr. Returns [cells, width], which lasts until
  /// the next call.
  const inference::Rows& encode(const std::vector<const std::uint8_t*>& images,
                                const EgoMotion& motion, const EgoPoses& poses,
                                const inference::Rows* past);
  /// The BEV of the last images as if there were no past one, for the decisions to come. `motion`:
  /// of which speed and yaw rate count.
  const inference::Rows& encodeAlone(const EgoMotion& motion);

 private:
  struct Layer {
    inference::DeformableAttention temporal;
    inference::LayerNorm temporal_norm;
    inference::DeformableAttention cameras;
    inference::LayerNorm cameras_norm;
    inference::FeedForward mix;
    inference::LayerNorm mix_norm;
  };
  void lookAtImages(const std::vector<const std::uint8_t*>& images);
  void startQueries(const EgoMotion& motion);
  const inference::Rows& runLayers(const EgoMotion& motion, const inference::SamplingPlan& temporal,
                                   const inference::Rows* past);
  void run(const Layer& layer, const inference::SamplingPlan& temporal,
           const inference::Rows* past);

  CameraEgoSizes sizes_;
  inference::ImageBackbone backbone_;
  inference::Rows camera_table_;
  inference::Rows queries_;    ///< learned, by cell
  inference::Rows positions_;  ///< learned, by cell
  inference::Mlp motion_;
  std::vector<Layer> layers_;
  inference::SamplingPlan camera_plan_;
  inference::Rows features_;  ///< of the images: camera after camera
  inference::Rows bev_;
  inference::Rows first_;   ///< the queries before the first layer, in place of a past BEV
  inference::Rows both_;    ///< past, then present
  inference::Rows asking_;  ///< [cells, 2 width]: past beside present with positions
  inference::Rows change_;
  inference::Rows motion_rows_;
  inference::DeformableMemory deformable_;
  inference::TransformerMemory memory_;
};

/// A layer of a decoder of queries: x += attention(LN(x) + position) among the queries, x +=
/// deformable attention of LN(x) + position to the BEV, x += W_2 gelu(W_1 LN(x)).
class QueryLayer {
 public:
  QueryLayer(const inference::LayerWeights& weights, const std::string& name,
             const CameraEgoSizes& sizes);
  /// `places`: [rows of x, 2] (column, row) in cells of the BEV.
  void run(const inference::Rows& x, const inference::Rows& position,
           const std::vector<float>& places, const inference::Rows& bev,
           const inference::MapGrid& grid, inference::TransformerMemory& memory,
           inference::DeformableMemory& deformable) const;

 private:
  inference::PreNormAttention self_;
  inference::LayerNorm cross_norm_;
  inference::DeformableAttention cross_;
  inference::PreNormFeedForward mix_;
};

}  // namespace cdiff::planners
