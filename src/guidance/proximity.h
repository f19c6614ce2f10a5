// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// ln(1 + e^x) without overflow.
double softplus(double x);

/// J_safe = sum_t softplus((d_safe - d_t) / kappa) + lambda exp(-d_t^2 / (2 sigma^2)), d_t =
/// sqrt(|p_other - p|^2 + 0.1^2) between box centers at row t [m] (paper III-D1, "Collision
/// Guidance"): what collision avoidance minimizes and collision seeking maximizes.
/// d_safe = half diagonal of one box + half diagonal of the other + buffer: boxes whose centers are
/// that far apart cannot touch, whatever their headings. The pull of softplus reaches a few kappa
/// beyond d_safe and that of the bump a few sigma, so both are meters.
struct Proximity {
  double buffer = 0.5;  ///< [m]
  double kappa = 2.0;   ///< softness of the safety distance [m]
  double lambda = 1.0;  ///< height of the bump
  double sigma = 4.0;   ///< width of the bump [m]

  void describe(core::OptionsVisitor& visitor);
  double safeDistance(const GuidanceScene& scene) const;
  /// factor x J_safe over the rows that the other's prediction covers, and its gradient added; 0
  /// without another vehicle, or with one on another level of a bridge.
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout, double factor,
                  traffic::Rollout& gradient) const;
};

}  // namespace cdiff::guidance
