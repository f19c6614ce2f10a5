// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

#include "planners/uniad_mini/training/track_chain.h"

namespace cdiff::planners {

// The losses of motion, occupancy and plan that UniAD publishes (Hu et al. 2023), with their
// constants.

/// Weights and thresholds.
struct UniadLossOptions {
  static constexpr double kEgoVelocity = 0.25;  ///< of the ego's own box
  static constexpr double kMotionKind = 0.5;    ///< - log of the best mode's share
  static constexpr double kMotionNll = 0.5;     ///< of the best mode's waypoints
  static constexpr double kMotionEnd = 0.25;    ///< distance of its last known place
  static constexpr double kLeastSpread = -3.0;  ///< logs of deviations lie between these two
  static constexpr double kMostSpread = 5.0;
  static constexpr double kHardest = 0.25;  ///< share of cells of a mask that count
  static constexpr double kMaskEntropy = 5.0;
  static constexpr double kMaskDice = 1.0;
  static constexpr double kDiscount = 0.95;                 ///< of a mask, per occupancy step
  static constexpr double kInflations[] = {0.0, 0.5, 1.0};  ///< of the ego's box [m]
  static constexpr double kInflationWeights[] = {2.5, 1.0, 0.25};
};

/// Of all layers: distance along both axes of the velocity that the ego's query answers from how
/// fast the ego drives, along its heading.
at::Tensor egoVelocityLoss(const TrackAnswer& answer,
                           const std::vector<const EgoExample*>& examples);

/// Where a row of queries is to go, from its center on.
struct MotionTarget {
  std::int64_t row = 0;  ///< sample x rows + slot, or the ego's
  EgoWaypoints places{};
  std::size_t known = 0;  ///< of them, at least 1
};
/// Of matched agents and of the egos.
std::vector<MotionTarget> motionTargets(const std::vector<const EgoExample*>& examples,
                                        const QueryMatches& matches, std::int64_t rows);

/// Of all layers: 0.5 cross entropy of the mode whose last known place is nearest, 0.5 negative log
/// likelihood of its bivariate Gaussians, mean over known waypoints, and 0.25 distance of that
/// place.
at::Tensor motionLoss(const MotionAnswer& answer, const std::vector<MotionTarget>& targets);

/// Negative log likelihood of offsets (dx, dy) [N, 2] from the means of Gaussians with logs of
/// deviations and atanh of the correlation [N, 3].
at::Tensor gaussianNll(const at::Tensor& offsets, const at::Tensor& spreads);

/// Which cells of a BEV a box touches: 1 or 0 by cell.
std::vector<float> maskOf(const BevGrid& bev, const geometry::OrientedBox& box);

/// Masks [B, 5, A, C] of matched agents against where they are and will be: 5 x binary cross
/// entropy over the hardest quarter of the cells + dice, discounted by step.
at::Tensor occupancyLoss(const at::Tensor& logits, const BevGrid& bev,
                         const std::vector<const EgoExample*>& examples,
                         const QueryMatches& matches);

/// Mean distance of known waypoints [m].
at::Tensor averageDisplacement(const at::Tensor& plans,
                               const std::vector<const EgoExample*>& examples);

/// Sum over vehicles, mean over waypoints, of the area [m^2] in which the ego's box, `inflated`
/// longer and wider [m], meets theirs: of the axis-parallel hulls of both, with the heading that
/// the ego was driven with, as published.
at::Tensor overlapLoss(const at::Tensor& plans, const std::vector<const EgoExample*>& examples,
                       double inflated);

/// Headings with which the ego was driven, by waypoint (body frame [rad]); it keeps the last one
/// where it stands.
std::array<double, kEgoWaypoints> drivenHeadings(const FuturePlaces& driven);

}  // namespace cdiff::planners
