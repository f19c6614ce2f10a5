// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

void PlutoOptions::describe(core::OptionsVisitor& visitor) {
  WeightOptions::describe(visitor);
  visitor.integer({"top", "", "Candidates of largest logits that share the probability."}, top, 1,
                  1024);
  visitor.number({"free_score", "", "Score of the plan that follows no reference line."},
                 free_score, 0.0, 1.0);
  tracker.describe(visitor);
}

PlutoChoice choosePlan(const std::vector<float>& logits, std::size_t top, double free_score) {
  std::vector<std::size_t> order(logits.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return logits[a] > logits[b]; });
  order.resize(std::min(order.size(), top));
  PlutoChoice choice;
  choice.scores.assign(logits.size() + 1, 0.0);
  double sum = 0.0;
  for (const std::size_t i : order) {
    choice.scores[i] = std::exp(static_cast<double>(logits[i]) - logits[order.front()]);
    sum += choice.scores[i];
  }
  for (const std::size_t i : order) choice.scores[i] /= sum;
  choice.scores.back() = free_score;
  choice.index = static_cast<std::size_t>(
      std::max_element(choice.scores.begin(), choice.scores.end()) - choice.scores.begin());
  return choice;
}

namespace {

/// A plan of the network in doubles, in the vehicle's frame.
struct PlutoPlan {
  Eigen::MatrixX2d places;
  Eigen::VectorXd headings;  ///< relative [rad]
  Eigen::VectorXd speeds;    ///< [m/s]

  bool finite() const { return places.allFinite() && headings.allFinite() && speeds.allFinite(); }
};

template <class Trajectory>
PlutoPlan plutoPlan(const Trajectory& trajectory) {
  const Eigen::MatrixXd values = trajectory.template cast<double>();
  PlutoPlan plan;
  plan.places = values.leftCols<2>();
  plan.headings.resize(values.rows());
  plan.speeds.resize(values.rows());
  Eigen::RowVector2d last = Eigen::RowVector2d::Zero();
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    plan.headings(i) = std::atan2(values(i, 3), values(i, 2));
    plan.speeds(i) = values.cols() > kFreeChannels
                         ? values.row(i).template tail<2>().norm()
                         : (plan.places.row(i) - last).norm() / kPlutoPeriod;
    last = plan.places.row(i);
  }
  return plan;
}

PlutoPlan planOf(const PlutoOutput& output, std::size_t index) {
  return index < output.candidates.size() ? plutoPlan(output.candidates[index])
                                          : plutoPlan(output.free);
}

/// In the map frame.
std::vector<planning::RolloutPoint> rolloutOf(const traffic::VehicleState& start,
                                              const PlutoPlan& plan,
                                              const traffic::ControlAction& action) {
  std::vector<planning::RolloutPoint> rollout;
  for (Eigen::Index i = 0; i < plan.places.rows(); ++i) {
    traffic::VehicleState state = start;
    state.position = start.pose().toMap(plan.places.row(i).transpose());
    state.heading = core::wrapAngle(start.heading + plan.headings(i));
    state.speed = plan.speeds(i);
    rollout.push_back({state, action});
  }
  return rollout;
}

/// All plans with their scores, in the map frame.
std::vector<planning::PlannedCandidate> candidatesOf(const geometry::Pose2d& pose,
                                                     const PlutoOutput& output,
                                                     const PlutoChoice& choice) {
  const auto stride =
      static_cast<Eigen::Index>(std::lround(planning::kCandidateStep / kPlutoPeriod));
  std::vector<planning::PlannedCandidate> candidates;
  for (std::size_t i = 0; i < choice.scores.size(); ++i) {
    planning::PlannedCandidate& candidate = candidates.emplace_back();
    candidate.score = choice.scores[i];
    candidate.chosen = i == choice.index;
    const PlutoPlan plan = planOf(output, i);
    for (Eigen::Index row = stride - 1; row < plan.places.rows(); row += stride)
      candidate.places.push_back(pose.toMap(plan.places.row(row).transpose()));
  }
  return candidates;
}

std::string plutoFault(const traffic::TrafficSnapshot& snapshot,
                       const planning::PlanningTask& task) {
  const std::string fault = planning::faultOf(snapshot, task);
  if (!fault.empty()) return fault;
  if (snapshot.find(task.vehicle->id) == nullptr) return "it is not in the snapshot";
  return std::isfinite(task.vehicle->acceleration) ? "" : "its acceleration is not finite";
}

bool statesFinite(const traffic::TrafficSnapshot& snapshot) {
  return std::all_of(
      snapshot.vehicles.begin(), snapshot.vehicles.end(),
      [](const traffic::Vehicle& vehicle) { return planning::isFinite(vehicle.state); });
}

}  // namespace

PlutoPlanner::PlutoPlanner(const PlutoOptions& options, const PlutoModel& model,
                           const map::RoadNetwork& network, double period)
    : options_(options),
      builder_(model.architecture, network),
      network_(model, builder_.pieces().all()),
      tracks_(period) {}

PlutoOutput PlutoPlanner::look(const traffic::TrafficSnapshot& snapshot,
                               const planning::PlanningTask& task, double arc_length) {
  PlutoMoment moment;
  moment.frames = tracks_.frames();
  moment.vehicles = &tracks_.vehicles();
  moment.own = tracks_.vehicles().numberOf(*task.vehicle);
  moment.route = task.route;
  moment.arc_length = arc_length;
  moment.target_speed = task.target_speed;
  moment.signals = &snapshot.signals;
  return network_.forward(builder_.inputOf(moment, builder_.linesOf(moment)));
}

std::vector<planning::PlannedAction> PlutoPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  if (statesFinite(snapshot)) tracks_.add(snapshot);
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) {
    const std::string fault = plutoFault(snapshot, task);
    actions.push_back(planning::failSafeAction(task, fault));
    if (!fault.empty()) continue;
    Memory& memory = memories_.keep(task.vehicle->id, [&] {
      return Memory{{}, planning::PlanTracker(options_.tracker)};
    });
    memory.follower.update(*task.route, task.vehicle->state.position);
    conclude(task, look(snapshot, task, memory.follower.arcLength()), memory, actions.back());
  }
  memories_.forgetOthers();
  return actions;
}

void PlutoPlanner::conclude(const planning::PlanningTask& task, const PlutoOutput& output,
                            Memory& memory, planning::PlannedAction& planned) const {
  const PlutoChoice choice =
      choosePlan(output.logits, static_cast<std::size_t>(options_.top), options_.free_score);
  const PlutoPlan plan = planOf(output, choice.index);
  const bool scored = std::all_of(output.logits.begin(), output.logits.end(),
                                  [](float x) { return std::isfinite(x); });
  if (!scored || !plan.finite()) {
    planned = planning::failSafeAction(task, "a number of its plan is not finite");
    return;
  }
  const traffic::VehicleState& state = task.vehicle->state;
  planned.action = memory.tracker.track(state.speed, plan.places);
  planned.rollout = rolloutOf(state, plan, planned.action);
  planned.candidates = candidatesOf(state.pose(), output, choice);
}

std::unique_ptr<planning::Planner> makePluto(const WeightKind& kind, const PlutoOptions& options,
                                             const planning::PlannerParts& parts) {
  const double period = parts.context.decision_period;
  if (std::abs(period - kPlutoPeriod) > 1e-9) {
    throw core::InputError("key 'decision_period' is " + core::formatNumber(period) +
                           " s; planner '" + kind.planner + "' was trained for " +
                           core::formatNumber(kPlutoPeriod) + " s and knows no other");
  }
  return std::make_unique<PlutoPlanner>(options, readPlutoModel(kind, options.folder()),
                                        parts.context.network, period);
}

planning::PlannerDescriptor plutoDescriptor() {
  planning::PlannerDescriptor descriptor = plutoDescriptorOf<PlutoOptions>(kPluto);
  descriptor.title = "Pluto";
  descriptor.help = "a transformer that weighs trajectories along reference lines.";
  return descriptor;
}

}  // namespace cdiff::planners
