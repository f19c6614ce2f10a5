// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_area = sum_t mean_p max(0, margin - d_A(p))^2 [m^2], d_A = signed distance to the border of
/// the drivable area at the vehicle's elevation, positive inside; p = center of the box at row t
/// (paper III-D1, "Drivable Area Guidance", eq. 10), or also the middles of its front and rear.
/// Beyond the border the pull grows with the distance, so there is no dead zone outside.
class DrivableAreaObjective : public Objective {
 public:
  double margin = 1.2;            ///< delta_margin [m]: half a width of 1.8 m + 0.3 m
  std::string points = "center";  ///< center | bumpers (center, front and rear)

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
