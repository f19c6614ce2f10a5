// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/vad_mini/vad_mini_weights.h"

namespace cdiff::planners {

/// Sizes of the network of `uniad_mini`; they travel in the metadata of the weight file. Boxes,
/// lines, modes and waypoints are those of `vad_mini`.
struct UniadMiniArchitecture {
  CameraEgoSizes ego;
  std::int64_t tracks = 24;         ///< track queries without that of the ego
  std::int64_t map_lines = 12;      ///< map queries
  std::int64_t decoder_layers = 2;  ///< of tracks and of the map, each
  std::int64_t motion_layers = 2;
  std::int64_t plan_layers = 3;

  UniadMiniArchitecture() { ego.bev = {32, 32, 2.0, 16.0}; }
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for sizes that do not fit each other.
  void validate() const;
  /// Track queries and the ego's, which is the last one.
  std::int64_t rows() const { return tracks + 1; }
};

/// A query becomes a track at this score, and a track stays one above the second (UniAD).
inline constexpr double kBirthScore = 0.4;
inline constexpr double kKeepScore = 0.35;
/// Groups of vehicles with motion anchors of their own (MotionGroup).
inline constexpr std::int64_t kMotionGroups = 3;
/// Numbers of a Gaussian of a waypoint: x, y, log of both deviations, atanh of the correlation.
inline constexpr std::int64_t kGaussianNumbers = 5;
/// Ends of motion anchors come in this unit [m].
inline constexpr double kAnchorUnit = 30.0;
/// Occupancy: now and at four waypoints; channels of a cell.
inline constexpr std::int64_t kOccupancySteps = 5;
inline constexpr std::int64_t kOccupancyWidth = 48;
/// Cells do not look at agents that are less probably there (UniAD).
inline constexpr double kOccupancyMask = 0.3;
/// Cells that a convolution reads: the cell and its eight neighbors.
inline constexpr std::int64_t kTaps = 9;

inline constexpr WeightKind kUniadMini = {"uniad_mini", "uniad_mini.safetensors",
                                          "e2e_cdiff.uniad_mini.1"};

using UniadMiniModel = NetworkWeights<UniadMiniArchitecture>;

/// Name of the clustered anchors [groups x modes, 6 x 2], which are not trained: where vehicles of
/// a group go by a mode, from their center, in their own frame [m].
inline constexpr const char* kAnchorTable = "table.anchor";

// Names and shapes of the weights, by parts: those that are trained first and then frozen (image
// backbone and BEV encoder), those of tracks and map, and those of motion, occupancy and plan.
std::vector<inference::TensorShape> uniadBevTensors(const UniadMiniArchitecture& architecture);
std::vector<inference::TensorShape> uniadTrackTensors(const UniadMiniArchitecture& architecture);
std::vector<inference::TensorShape> uniadPlanTensors(const UniadMiniArchitecture& architecture);
/// All, with the anchors.
std::vector<inference::TensorShape> uniadMiniTensors(const UniadMiniArchitecture& architecture);

inline UniadMiniModel readUniadMiniModel(const std::filesystem::path& folder) {
  return readNetwork<UniadMiniArchitecture>(kUniadMini, folder, uniadMiniTensors);
}

}  // namespace cdiff::planners
