// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/camera_ego/navigation.h"
#include "planners/camera_ego/road_lines.h"
#include "planners/camera_ego/waypoint_controller.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// Sizes of the network of `vad_mini`; they travel in the metadata of the weight file.
struct VadMiniArchitecture {
  CameraEgoSizes ego;
  std::int64_t agents = 24;         ///< agent queries
  std::int64_t map_lines = 16;      ///< map queries
  std::int64_t decoder_layers = 2;  ///< of agents and of the map, each

  void describe(core::OptionsVisitor& visitor);
  void validate() const { ego.validate(); }
};

inline constexpr std::int64_t kBoxNumbers = 10;  ///< x, y, log w, log l, z, log h, sin, cos, vx, vy
inline constexpr auto kMapPoints = static_cast<std::int64_t>(kLinePoints);  ///< of a line
inline constexpr std::int64_t kMapKinds = 3;                                ///< MapKind
inline constexpr std::int64_t kMotionModes = 6;                             ///< of an agent
/// Velocities of boxes come in this unit [m/s].
inline constexpr double kVelocityUnit = 5.0;
/// Offsets from waypoint to waypoint, of agents and ego, come in this unit [m].
inline constexpr double kOffsetUnit = 3.0;

inline constexpr WeightKind kVadMini = {"vad_mini", "vad_mini.safetensors", "e2e_cdiff.vad_mini.1"};

using VadMiniModel = NetworkWeights<VadMiniArchitecture>;

/// Names and shapes of the weights.
std::vector<inference::TensorShape> vadMiniTensors(const VadMiniArchitecture& architecture);

inline VadMiniModel readVadMiniModel(const std::filesystem::path& folder) {
  return readNetwork<VadMiniArchitecture>(kVadMini, folder, vadMiniTensors);
}

}  // namespace cdiff::planners
