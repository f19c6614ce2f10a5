// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "inference/safetensors.h"

namespace cdiff::diffusion {

/// Speeds enter the networks divided by it [m/s].
inline constexpr double kSpeedScale = 10.0;

/// Sizes of the networks; they travel in the metadata of the weight files (docs/neural_network.md
/// draws the networks and names every tensor).
struct Architecture {
  std::int64_t horizon = 32;                           ///< T, a multiple of 4
  std::int64_t diffusion_steps = 100;                  ///< K
  std::vector<std::int64_t> channels = {32, 64, 128};  ///< channels of the U-Net's levels
  std::int64_t kernel = 5;                             ///< kernel size of its convolutions
  std::int64_t groups = 8;                             ///< groups of its group normalization
  std::int64_t time_width = 64;                        ///< time embedding; hidden layer: 4 times
  std::int64_t image_width = 160;                      ///< [px]
  std::int64_t image_height = 96;                      ///< [px]
  std::int64_t image_features = 256;                   ///< output of the image encoder
  std::int64_t route_points = 16;                      ///< route tokens
  double route_spacing = 3.0;                          ///< between route points [m]
  std::int64_t route_features = 64;  ///< their hidden layer has twice as many; 0: no route
  std::int64_t speed_features = 32;  ///< 0: the own speed is no input
  std::int64_t context_width = 128;  ///< c; 0: the features are injected as they are
  std::int64_t state_hidden = 256;   ///< hidden units of the state head
  std::int64_t previous_frame = 0;   ///< rollout steps that a second image lies back; 0: no second
  std::int64_t target_features = 0;  ///< 0: the target speed is no input
  /// Rows of the current state s_0 before the trajectory, the same at every diffusion step; 0: none
  std::int64_t current_state_rows = 0;

  bool takesRoute() const { return route_features > 0; }
  bool takesSpeed() const { return speed_features > 0; }
  bool takesPrevious() const { return previous_frame > 0; }
  bool takesTarget() const { return target_features > 0; }
  bool pinsCurrentState() const { return current_state_rows > 0; }
  /// Rows of the U-Net: those of the current state, then T.
  std::int64_t rows() const { return current_state_rows + horizon; }
  /// Whether the vehicle's present speed is an input of the state head.
  bool startsFromSpeed() const { return takesSpeed() || pinsCurrentState(); }
  /// Values of image, route, speed, image before and target speed together.
  std::int64_t joinedFeatures() const {
    return image_features * (takesPrevious() ? 2 : 1) + route_features + speed_features +
           target_features;
  }
  /// Values of c.
  std::int64_t contextValues() const {
    return context_width > 0 ? context_width : joinedFeatures();
  }

  /// The same with the paper's inputs (III-C2): the image alone, its features injected into every
  /// block as they are.
  Architecture imageAlone() const;
  /// The same with two more inputs: the image of 0.4 s before, and the target speed.
  Architecture withMotion() const;
  /// The paper's inputs and the current state, pinned as in Diffuser (Janner et al. 2022, 3.2).
  Architecture pinned() const;

  /// Throws InputError naming the size that is out of range or does not fit the others.
  void validate() const;
  /// As JSON text and back; the inputs of withMotion and pinned are named where they are there.
  /// Throws InputError naming the key that is missing, unknown or of the wrong type.
  std::string toJson() const;
  static Architecture fromJson(const std::string& text, const std::string& source);
};

bool operator==(const Architecture& left, const Architecture& right);

/// Every tensor of the denoiser (U-Net, conditioning, heads) in a fixed order.
std::vector<inference::TensorShape> denoiserTensors(const Architecture& architecture);
/// Every tensor of the image encoder in a fixed order.
std::vector<inference::TensorShape> encoderTensors(const Architecture& architecture);

// Route tokens: points of the route ahead, every `route_spacing` meters from the vehicle's place on
// it (the first one `route_spacing` ahead), as (x, y) in the vehicle's body frame divided by 20 m;
// beyond its end the route goes straight on.

/// What a token of 1 stands for [m].
inline constexpr double kRouteTokenScale = 20.0;

/// [route_points, 2] row-major.
std::vector<float> routeTokens(const Architecture& architecture, const geometry::Polyline& path,
                               double arc_length, const geometry::Pose2d& pose);

}  // namespace cdiff::diffusion
