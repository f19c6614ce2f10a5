// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_route = sum_t max(0, |l_t| - free_offset)^2 + heading_weight (psi_t - psi_route)^2, l =
/// lateral offset from the route's line [m], psi_route = heading of its nearest segment [rad]; 0
/// without a route. Not in the paper; after the route guidance of Diffusion-Planner's successors.
class RouteObjective : public Objective {
 public:
  double free_offset = 0.5;     ///< half width of the corridor without a pull [m]
  double heading_weight = 0.0;  ///< [m^2/rad^2]; 0 leaves the heading alone

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
