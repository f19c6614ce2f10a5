// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {

/// What a vehicle is by its size; each group has anchors of its own.
enum class MotionGroup { kCar = 0, kLarge = 1, kNarrow = 2 };
/// Narrow below 1.2 m of width, else large above 6.5 m of length.
MotionGroup motionGroupOf(double length, double width);

/// Where vehicles of a group go, by mode: from their center, in their own frame [m].
using MotionAnchors = std::array<EgoWaypoints, kMotionModes>;

/// A way that a vehicle of a group took.
struct TakenWay {
  MotionGroup group = MotionGroup::kCar;
  EgoWaypoints places{};  ///< from its center, in its own frame [m]
};

/// Anchors of each group: means of the clusters of its ways by their ends (k-means, Lloyd 1982),
/// shortest first. Starts from the ways at even ranks of the ends' distances, so that it draws
/// nothing. Groups of fewer ways than modes have those of cars; without enough of these, too, ways
/// straight on at 0, 3, 6, 9, 12, 15 m/s.
std::array<MotionAnchors, kMotionGroups> clusterAnchors(const std::vector<TakenWay>& ways);

/// As a tensor of weights, and back.
inference::Tensor toTensor(const std::array<MotionAnchors, kMotionGroups>& anchors);
std::array<MotionAnchors, kMotionGroups> toAnchors(const inference::Tensor& tensor);

}  // namespace cdiff::planners
