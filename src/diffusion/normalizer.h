// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>

#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/strict_json.h"

namespace cdiff::diffusion {

// Matrices of a rollout's shape, [T, 7] (columns of traffic::Rollout: m, rad, m/s, pedals), as the
// JSON text that a normalizer and the spread have in weight files and checkpoints.

/// [[...], ...] with the shortest numbers that read back to the same double.
std::string rolloutText(const traffic::Rollout& matrix);

/// A [rows, 7] matrix of numbers. Throws InputError that starts with `where`.
traffic::Rollout rolloutOf(const inference::Json& value, std::int64_t rows,
                           const std::string& where);

/// [T, 7], normalized; what networks and sampler work on.
using Trajectory = Eigen::Matrix<float, Eigen::Dynamic, traffic::kRolloutColumns, Eigen::RowMajor>;

/// Between metric rollouts and the unit scale that is diffused: normalized = (metric - mean) /
/// scale, cell by cell of [T, 7].
struct Normalizer {
  traffic::Rollout mean;   ///< [T, 7]
  traffic::Rollout scale;  ///< [T, 7], positive

  Trajectory normalize(const traffic::Rollout& metric) const;
  traffic::Rollout denormalize(const Trajectory& trajectory) const;
  /// dJ/d(normalized) = dJ/d(metric) x scale.
  Trajectory toNormalizedGradient(const traffic::Rollout& gradient) const;
  /// Throws InputError when a mean is not finite, a scale is not positive, or T differs.
  void validate(int horizon) const;

  /// {"mean": T rows of 7, "scale": T rows of 7}, to the bit.
  std::string toJson() const;
  /// Of `horizon` rows, not validated. Throws InputError that starts with `where`.
  static Normalizer fromJson(const std::string& text, std::int64_t horizon,
                             const std::string& where);
};

}  // namespace cdiff::diffusion
