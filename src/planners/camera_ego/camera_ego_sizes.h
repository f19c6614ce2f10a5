// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "inference/image_backbone.h"
#include "inference/transformer_layers.h"
#include "planners/camera_ego/bev_grid.h"

namespace cdiff::planners {

/// Sizes of what the camera egos (`vad_mini`, `uniad_mini`) share: cameras, image backbone and
/// bird's-eye view (BEV); they travel in the metadata of the weight files.
struct CameraEgoSizes {
  std::int64_t width = 96;      ///< of a feature, a multiple of 16 x heads
  std::int64_t heads = 6;       ///< of attention
  std::int64_t hidden = 192;    ///< of the feed-forward networks, a multiple of 16
  std::int64_t bev_layers = 2;  ///< of the BEV encoder
  BevGrid bev;
  bool past_bev = true;                         ///< whether the BEV of 0.5 s ago is read, too
  std::string rig = rendering::kFrontThreeRig;  ///< preset of the cameras
  std::int64_t image_width = 160;               ///< [px]
  std::int64_t image_height = 96;               ///< [px]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for sizes that do not fit each other.
  void validate() const;
  inference::TransformerSizes transformer() const { return {width, heads, hidden}; }
  inference::BackboneSizes backbone() const { return {image_width, image_height, width}; }
  /// The cameras; far distance and supersampling are the usual ones.
  rendering::CameraRig cameras() const;
};

/// Numbers of the ego's motion that the BEV is given, in place of Bench2Drive's CAN bus: speed, yaw
/// rate, and the way since the past BEV (forward, left, turn), divided by kMotionUnits.
inline constexpr std::int64_t kEgoMotionNumbers = 5;
inline constexpr double kEgoMotionUnits[kEgoMotionNumbers] = {10.0, 0.5, 5.0, 1.0, 0.25};
/// Age of the past BEV [s].
inline constexpr double kPastAge = 0.5;
/// Heights above the road at which the cells of the BEV look into the images [m].
inline constexpr double kPillarHeights[] = {0.0, 0.5, 1.2, 2.5};
inline constexpr std::int64_t kPillarPoints = 4;
/// Places a head: of the past and the present BEV each; of a camera (two a height); of a query.
inline constexpr std::int64_t kTemporalPoints = 4;
inline constexpr std::int64_t kCameraPoints = 2 * kPillarPoints;
inline constexpr std::int64_t kQueryPoints = 4;

/// Of the three uses of deformable attention.
inference::DeformableSizes temporalSizes(const CameraEgoSizes& sizes);
inference::DeformableSizes cameraSizes(const CameraEgoSizes& sizes);
inference::DeformableSizes querySizes(const CameraEgoSizes& sizes);

// Names and shapes of the tensors.

/// Backbone (backboneTensors), camera table, and BEV encoder.
void addBevEncoder(const CameraEgoSizes& sizes, inference::TensorList& list);
/// Of a QueryLayer: NAME.self, NAME.cross and NAME.mix.
void addQueryLayer(const std::string& name, const CameraEgoSizes& sizes,
                   inference::TensorList& list);
/// Of a PreNormAttention and a PreNormFeedForward.
void addPreNormAttention(const std::string& name, std::int64_t width, inference::TensorList& list);
void addPreNormMix(const std::string& name, const CameraEgoSizes& sizes,
                   inference::TensorList& list);

}  // namespace cdiff::planners
