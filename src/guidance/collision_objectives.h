// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

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

/// J_coll = sum_t softplus((d_safe - d_t) / kappa) + lambda exp(-d_t^2 / (2 sigma^2)), see
/// Proximity (paper III-D1, eq. 11, J_coll^safe): keeps away from the other vehicle.
class CollisionAvoidanceObjective : public Objective {
 public:
  Proximity proximity;

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

/// J_risk = -eta(d_ref) J_safe, d_ref = distance of the box centers now [m], J_safe see Proximity
/// (paper III-D1, eq. 12, J_coll^risk): approaches the other vehicle once it is near.
/// eta is 1 up to trigger_distance; beyond it 0 (hard), or falls to exactly 0 over trigger_width as
/// 1 - 3 s^2 + 2 s^3 (smooth). J_risk is bounded below: d_t cannot be negative. With
/// `leave_behind` (ours) it is 0 while the other vehicle stands behind the planned one: no way
/// forward touches it, and to stay near would be to stand before it for good.
class CollisionSeekingObjective : public Objective {
 public:
  Proximity proximity{0.5, 6.0, 2.0, 8.0};  ///< wide: it must pull from the trigger distance
  std::string gate = "smooth";              ///< smooth | hard
  double trigger_distance = 25.0;           ///< d_th [m]
  double trigger_width = 10.0;              ///< width of the smooth gate [m]
  bool leave_behind = false;                ///< whether one that stands behind is left alone

  /// eta(d_ref) in [0, 1].
  double gateAt(double distance) const;

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

/// J_traffic = sum_t sum_i w(b) max(0, a + A)^2 [m^2] over vehicles i ahead in the lane, and A^2
/// max(0, 1 - rho)^2, rho^2 = (a / A)^2 + (b / B)^2, over all others: a and b are the planned place
/// along and across vehicle i as predicted for row t, A and B half of both boxes' lengths and
/// widths plus a gap, w(b) = max(0, 1 - (b / B)^2)^2. Not in the paper, whose collision guidance is
/// about the ego alone.
///
/// A vehicle is ahead in the lane when the planned one now stands behind its center, beside its
/// line by less than B, and heads in the same direction within 60 degrees. The term of these grows
/// without end, so that a plan through a leader is drawn back behind it, not on past it.
class TrafficAvoidanceObjective : public Objective {
 public:
  double longitudinal_gap = 4.0;  ///< between bumpers [m]
  double lateral_gap = 0.8;       ///< between sides [m]

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
