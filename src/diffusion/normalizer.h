// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Between metric rollouts and the unit scale that is diffused: normalised = (metric - mean) /
/// scale, cell by cell of [T, 7].
#pragma once

#include <cstdint>
#include <string>

#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::diffusion {

/// [T, 7], normalised; what networks and sampler work on.
using Trajectory = Eigen::Matrix<float, Eigen::Dynamic, traffic::kRolloutColumns, Eigen::RowMajor>;

struct Normalizer {
  traffic::Rollout mean;   ///< [T, 7]
  traffic::Rollout scale;  ///< [T, 7], positive

  Trajectory normalize(const traffic::Rollout& metric) const;
  traffic::Rollout denormalize(const Trajectory& trajectory) const;
  /// dJ/d(normalised) = dJ/d(metric) x scale.
  Trajectory toNormalizedGradient(const traffic::Rollout& gradient) const;
  /// Throws InputError when a mean is not finite, a scale is not positive, or T differs.
  void validate(int horizon) const;

  /// {"mean": T rows of 7, "scale": T rows of 7}, to the bit.
  std::string toJson() const;
  /// Of `horizon` rows, not validated. Throws InputError that begins with `where`.
  static Normalizer fromJson(const std::string& text, std::int64_t horizon,
                             const std::string& where);
};

}  // namespace cdiff::diffusion
