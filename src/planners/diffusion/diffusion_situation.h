// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "diffusion/sampler.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "guidance/total_objective.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planners/diffusion/image_watch.h"

namespace cdiff::planners {

/// Guidance on a batch of samples: joins the metric objectives of each vehicle to the normalized
/// trajectories that the sampler works on.
/// References must outlive it.
class GuidedBatch : public diffusion::CleanObjective {
 public:
  /// `objectives[i]` is that of sample i.
  GuidedBatch(const diffusion::Normalizer& normalizer,
              std::vector<guidance::TotalObjective*> objectives);

  bool actsAt(std::size_t sample, int k) const override;
  double evaluate(std::size_t sample, int k, const diffusion::Trajectory& clean,
                  diffusion::Trajectory& gradient) override;

 private:
  const diffusion::Normalizer& normalizer_;
  std::vector<guidance::TotalObjective*> objectives_;
  traffic::Rollout metric_gradient_;
};

// Which of several sampled plans (rollouts [T, 7], body frame, SI units) is driven: the one of the
// lowest score; or, so that a vehicle does not waver between plans that are about equally good, the
// one nearest to the last plan while it is no worse by more than a share.

/// Index into `plans`. `previous` is the last plan as seen from here. Plans that are not finite are
/// not chosen unless none is.
std::size_t choosePlan(const std::vector<traffic::Rollout>& plans,
                       const std::vector<guidance::Score>& scores,
                       const std::optional<traffic::Rollout>& previous, double hysteresis);

/// The plan of a vehicle's last decision, shifted to the current one (rollouts [T, 7], 0.1 s a row,
/// body frame, SI units).
class LastPlan {
 public:
  /// `plan` was made at `tick` in the frame of `start`; `route` may be nullptr.
  LastPlan(const traffic::Rollout& plan, std::uint64_t tick, const traffic::VehicleState& start,
           const map::Route* route);

  std::uint64_t tick() const { return tick_; }
  /// The plan without its first `rows` rows, the last action held, as the exact dynamics drives it
  /// from `now`. nullopt unless `rows` is a whole number from 1 to T.
  std::optional<traffic::Rollout> continued(double rows, const dynamics::ActionRollout& dynamics,
                                            const traffic::VehicleState& now) const;
  /// Whether the vehicle is where the plan said after `rows` rows (0.5 m, 0.1 rad, 0.5 m/s) and its
  /// route still ends at the same place.
  bool holds(Eigen::Index rows, const traffic::VehicleState& now, const map::Route* route) const;

 private:
  traffic::Rollout plan_;
  std::uint64_t tick_ = 0;
  traffic::VehicleState start_;
  std::optional<Eigen::Vector2d> goal_;
};

// What the diffusion planner remembers of a vehicle, and what it knows about one at a decision.

/// What is remembered of a vehicle between decisions.
struct DiffusionPlanner::Memory {
  planning::RouteFollower follower;
  ImageWatch watch;
  std::optional<LastPlan> plan;
  std::vector<float> features;  ///< of the last image
  /// Features by tick, as far back as the model's image before lies; none where it takes none.
  std::map<std::uint64_t, std::vector<float>> earlier;
  std::uint64_t features_hash = 0;
};

/// One vehicle of this decision.
struct DiffusionPlanner::Situation {
  const planning::PlanningTask* task = nullptr;
  Memory* memory = nullptr;
  diffusion::Context context;
  guidance::GuidanceScene scene;
  guidance::OtherMotion other;
  std::optional<traffic::Rollout> previous;   ///< last plan as seen from here, metric
  std::optional<diffusion::Trajectory> warm;  ///< the same, normalized, where it fits
  std::vector<std::unique_ptr<guidance::TotalObjective>> objectives;  ///< one per candidate
  traffic::Rollout plan;                                              ///< the chosen one
  guidance::GuidanceReport report;
};

}  // namespace cdiff::planners
