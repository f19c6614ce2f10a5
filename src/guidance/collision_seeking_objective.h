// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"
#include "guidance/proximity.h"

namespace cdiff::guidance {

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

}  // namespace cdiff::guidance
