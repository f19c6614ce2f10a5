// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/last_plan.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr double kPlaceJump = 0.5;    // [m]
constexpr double kHeadingJump = 0.1;  // [rad]
constexpr double kSpeedJump = 0.5;    // [m/s]
constexpr double kRounding = 1e-6;    // of a row

std::optional<Eigen::Vector2d> goalOf(const map::Route* route) {
  if (route == nullptr || route->empty()) return std::nullopt;
  return route->path().points().back().head<2>();
}

}  // namespace

LastPlan::LastPlan(const traffic::Rollout& plan, std::uint64_t tick,
                   const traffic::VehicleState& start, const map::Route* route)
    : plan_(plan), tick_(tick), start_(start), goal_(goalOf(route)) {}

std::optional<traffic::Rollout> LastPlan::continued(
    double rows, const dynamics::ActionRollout& dynamics, const traffic::VehicleState& now,
    const std::optional<traffic::ControlAction>& tail) const {
  const auto shift = static_cast<Eigen::Index>(std::llround(rows));
  const bool whole = std::abs(rows - static_cast<double>(shift)) < kRounding;
  if (!whole || shift < 1 || shift > plan_.rows()) return std::nullopt;
  traffic::Rollout moved = plan_;
  for (Eigen::Index row = 0; row < plan_.rows(); ++row)
    moved.row(row) = plan_.row(std::min(row + shift, plan_.rows() - 1));
  if (tail) {
    moved.rightCols<traffic::kActionColumns>().bottomRows(shift).rowwise() =
        Eigen::RowVector3d(tail->throttle, tail->steer, tail->brake);
  }
  dynamics::makeExecutable(moved);
  dynamics.rollOut(now.speed, moved);
  return moved;
}

bool LastPlan::holds(Eigen::Index rows, const traffic::VehicleState& now,
                     const map::Route* route) const {
  const auto row = plan_.row(rows - 1);
  const Eigen::Vector2d place = start_.pose().toMap(row.head<2>().transpose());
  const double heading = start_.heading + row(traffic::kRolloutHeading);
  const std::optional<Eigen::Vector2d> goal = goalOf(route);
  const bool same_goal =
      goal.has_value() == goal_.has_value() && (!goal || (*goal - *goal_).norm() < kPlaceJump);
  return same_goal && (place - now.position).norm() < kPlaceJump &&
         std::abs(core::angleDifference(heading, now.heading)) < kHeadingJump &&
         std::abs(row(traffic::kRolloutSpeed) - now.speed) < kSpeedJump;
}

}  // namespace cdiff::planners
