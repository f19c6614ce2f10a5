// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/fitted_normalizer.h"

#include <array>
#include <cmath>

#include "learning/driving_changes.h"

namespace cdiff::planners {
namespace {

using traffic::Rollout;

/// Least standard deviation of a state cell: x, y [m], heading [rad], speed [m/s].
constexpr std::array<double, traffic::kStateColumns> kLeastDeviation = {0.05, 0.05, 0.01, 0.1};
constexpr double kLeastSteerScale = 0.05;

}  // namespace

diffusion::Normalizer fitNormalizer(const learning::DrivingDataset& dataset, bool mirrored) {
  const Eigen::Index horizon = dataset.schema().horizon;
  Rollout sum = Rollout::Zero(horizon, traffic::kRolloutColumns);
  Rollout squares = sum;
  double count = 0.0;
  for (const std::size_t index : dataset.training()) {
    Rollout rollout = dataset.withoutImage(index).rollout;
    for (int pass = 0; pass < (mirrored ? 2 : 1); ++pass) {
      if (pass == 1) learning::mirrorRollout(rollout);
      sum += rollout;
      squares += rollout.cwiseProduct(rollout);
      count += 1.0;
    }
  }
  diffusion::Normalizer normalizer{sum / count, squares / count};
  normalizer.scale =
      (normalizer.scale - normalizer.mean.cwiseProduct(normalizer.mean)).cwiseMax(0.0).cwiseSqrt();
  for (int column = 0; column < traffic::kStateColumns; ++column) {
    const double least = kLeastDeviation[static_cast<std::size_t>(column)];
    normalizer.scale.col(column) = normalizer.scale.col(column).cwiseMax(least);
  }
  for (const int column : {traffic::kRolloutThrottle, traffic::kRolloutBrake}) {
    normalizer.mean.col(column).setConstant(0.5);
    normalizer.scale.col(column).setConstant(0.5);
  }
  const double steer = std::sqrt(squares.col(traffic::kRolloutSteer).mean() / count);
  normalizer.mean.col(traffic::kRolloutSteer).setZero();
  normalizer.scale.col(traffic::kRolloutSteer).setConstant(std::max(2.0 * steer, kLeastSteerScale));
  return normalizer;
}

}  // namespace cdiff::planners
