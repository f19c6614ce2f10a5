// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/challenge_choice.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

using traffic::Rollout;

constexpr traffic::ControlAction kBraking{0.0, 0.0, 0.75};  // 6 m/s^2

/// How a plan comes before the ego and slows down there: it brakes evenly from a row on, to a speed
/// that it keeps.
struct Retiming {
  Eigen::Index row;
  double brake;
};
constexpr Retiming kRetimings[] = {{0, 0.75}, {4, 0.25}, {10, 0.5}, {16, 0.75}};
constexpr double kKeptSpeed = 3.0;    // [m/s]
constexpr double kFullBraking = 8.0;  // [m/s^2]

/// `speed`: now [m/s]; `driven`: what the vehicle does with the plan.
Rollout retimed(Rollout plan, const Rollout& driven, const Retiming& retiming, double speed) {
  const double before =
      retiming.row == 0 ? speed : driven(retiming.row - 1, traffic::kRolloutSpeed);
  const double loss = retiming.brake * kFullBraking * traffic::kRolloutStep;  // a row [m/s]
  const auto braking = static_cast<Eigen::Index>(std::max(0.0, (before - kKeptSpeed) / loss));
  const Eigen::Index rows = std::max<Eigen::Index>(0, plan.rows() - retiming.row);
  plan.bottomRows(rows).col(traffic::kRolloutThrottle).setZero();
  plan.bottomRows(rows).col(traffic::kRolloutBrake).setZero();
  plan.middleRows(retiming.row, std::min(braking, rows))
      .col(traffic::kRolloutBrake)
      .setConstant(retiming.brake);
  return plan;
}

planning::ChallengePlan planOf(const traffic::VehicleState& now, const Rollout& driven,
                               double score) {
  planning::ChallengePlan plan;
  for (Eigen::Index row = 0; row < driven.rows(); ++row) {
    traffic::VehicleState state = now;
    state.position = now.pose().toMap(driven.row(row).head<2>().transpose());
    state.heading = core::wrapAngle(now.heading + driven(row, traffic::kRolloutHeading));
    state.speed = std::max(0.0, driven(row, traffic::kRolloutSpeed));
    plan.states.push_back(state);
  }
  plan.score = score;
  return plan;
}

}  // namespace

std::optional<Rollout> ChallengeChoice::keptPlan(std::uint64_t tick,
                                                 const PlannedVehicle& vehicle) const {
  const std::optional<LastPlan>& last = vehicle.memory->plan;
  if (!last || last->tick() >= tick) return std::nullopt;
  return last->continued(rows_, exact_, vehicle.task->vehicle->state, kBraking);
}

void ChallengeChoice::add(const Rollout& rollout, double score, PlanCandidates& candidates) {
  candidates.plans.push_back(rollout);
  candidates.driven.push_back(rollout);
  candidates.scores.push_back({0, score, 0});
}

/// Gives the sampled plans their scores and adds each with the retimings that fit its length. Gives
/// for every plan the sample that it was made of.
std::vector<std::size_t> ChallengeChoice::addRetimed(const DiffusionSituation& situation,
                                                     double speed,
                                                     PlanCandidates& candidates) const {
  std::vector<std::size_t> origins(candidates.plans.size());
  std::iota(origins.begin(), origins.end(), 0);
  for (std::size_t i = 0, sampled = origins.size(); i < sampled; ++i) {
    candidates.scores[i].value = situation.objectives.front()->score(candidates.plans[i]).value;
    for (const Retiming& retiming : kRetimings) {
      if (retiming.row >= candidates.plans[i].rows()) continue;
      origins.push_back(i);
      const Rollout later = retimed(candidates.plans[i], candidates.driven[i], retiming, speed);
      add(choice_.drivenBy(later, speed), candidates.scores[i].value, candidates);
    }
  }
  return origins;
}

ChosenPlan ChallengeChoice::choose(std::uint64_t tick, const PlannedVehicle& vehicle,
                                   const DiffusionSituation& situation, PlanCandidates candidates) {
  const traffic::VehicleState& now = vehicle.task->vehicle->state;
  const std::size_t sampled = candidates.plans.size();
  std::vector<std::size_t> origins = addRetimed(situation, now.speed, candidates);
  const std::size_t varied = candidates.plans.size();
  Rollout braking = candidates.plans.front();
  braking.rightCols<traffic::kActionColumns>().rowwise() =
      Eigen::RowVector3d(kBraking.throttle, kBraking.steer, kBraking.brake);
  add(choice_.drivenBy(braking, now.speed), 0.0, candidates);
  const std::optional<Rollout> kept = keptPlan(tick, vehicle);
  if (kept) add(*kept, 0.0, candidates);
  std::vector<planning::ChallengePlan> plans;
  for (std::size_t i = 0; i < candidates.plans.size(); ++i)
    plans.push_back(planOf(now, candidates.driven[i], candidates.scores[i].value));
  for (std::size_t i = sampled; i < varied; ++i) plans[i].only_to_hit = true;
  plans[varied].brakes = true;
  if (kept) plans.back().kept = true;
  const guidance::ChallengeReport report = challenge_.choose(*vehicle.task->vehicle, plans);
  const auto best = static_cast<std::size_t>(report.chosen);
  const auto& objective = *situation.objectives[best < sampled ? best : 0];
  origins.resize(plans.size(), 0);  // braking and the kept plan stand for none: the first
  ChosenPlan chosen{candidates.plans[best], candidates.driven[best],
                    objective.report(candidates.plans[best])};
  chosen.report.candidates = guidance_.candidates;
  chosen.report.chosen = report.chosen;
  chosen.report.challenge = report;
  chosen.report.trust_region_share = candidates.trust_region_shares[origins[best]];
  return chosen;
}

}  // namespace cdiff::planners
