// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_speed = sum_t (v_t - factor v*)^2 [m^2/s^2] over the speeds of rows 1..T, v* = target speed of
/// the scene (paper III-D1, "Speed Guidance", eq. 9 with factor 1).
class SpeedObjective : public Objective {
 public:
  double factor = 1.0;  ///< share of v* that is aimed at

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

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

/// J_comfort = action_weight sum_t |a_t - a_{t-1}|^2 + lateral_weight sum_t q_t^2, a = (throttle,
/// steer, brake), q_t = v_t (psi_t - psi_{t-1}) / 0.1 s = lateral acceleration [m/s^2] with psi_0 =
/// 0. Not in the paper; its smoothness and lateral terms are those usual in motion planning.
class ComfortObjective : public Objective {
 public:
  double action_weight = 1.0;   ///< weight of the squared differences of consecutive actions
  double lateral_weight = 0.1;  ///< weight of the squared lateral acceleration [s^4/m^2]

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
