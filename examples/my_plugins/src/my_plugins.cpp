// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A planner, a guidance objective and a metric of one's own. In a scenario, or by --set:
///   ego_planner: creep        creep.speed: 2.0
///   guidance.keep_right.weight: 0.5
#include <algorithm>
#include <class_loader/class_loader.hpp>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/plugins/plugin.h"

namespace my_plugins {

struct CreepOptions {
  double speed = 2.0;  ///< [m/s]

  void describe(cdiff::core::OptionsVisitor& visitor) {
    visitor.number({"speed", "m/s", "Speed that it holds."}, speed, 0.5, 10.0);
  }
  void validate() const {}
};

/// Follows its route slowly, whatever the others do: P control of speed and of the bearing of the
/// route point 6 m ahead.
class Creep : public cdiff::planning::Planner {
 public:
  explicit Creep(const CreepOptions& options) : options_(options) {}

  std::vector<cdiff::planning::PlannedAction> plan(
      const cdiff::traffic::TrafficSnapshot&,
      const std::vector<cdiff::planning::PlanningTask>& tasks) override {
    std::vector<cdiff::planning::PlannedAction> actions;
    for (const cdiff::planning::PlanningTask& task : tasks)
      actions.push_back({task.slot, task.vehicle->id, actionFor(task), {}});
    return actions;
  }

 private:
  cdiff::traffic::ControlAction actionFor(const cdiff::planning::PlanningTask& task) const {
    const cdiff::traffic::VehicleState& state = task.vehicle->state;
    cdiff::traffic::ControlAction action;
    const double error = options_.speed - state.speed;
    action.throttle = std::clamp(0.5 + 0.2 * error, 0.0, 0.8);
    if (error < -0.5) action.throttle = 0.0, action.brake = 0.3;
    if (task.route == nullptr) return action;
    const auto& path = task.route->path();
    const double ahead = path.project(state.position).arc_length + 6.0;
    const Eigen::Vector2d local = state.pose().toBody(path.positionAt(ahead));
    action.steer = std::clamp(1.5 * std::atan2(local.y(), local.x()), -1.0, 1.0);
    return action;
  }

  CreepOptions options_;
};

/// J = sum over the rows of (offset - y)^2 / 2 with y the lateral place in the body frame [m].
class KeepRight : public cdiff::guidance::Objective {
 public:
  void describe(cdiff::core::OptionsVisitor& visitor) override {
    visitor.number({"offset", "m", "Place to the right of where the vehicle is."}, offset_, 0.0,
                   3.0);
  }
  double evaluate(const cdiff::guidance::GuidanceScene&, const cdiff::traffic::Rollout& rollout,
                  cdiff::traffic::Rollout& gradient) const override {
    double value = 0.0;
    for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
      const double error = rollout(row, cdiff::traffic::kRolloutY) + offset_;
      value += 0.5 * error * error;
      gradient(row, cdiff::traffic::kRolloutY) += error;
    }
    return value;
  }
  std::unique_ptr<Objective> clone() const override { return std::make_unique<KeepRight>(*this); }

 private:
  double offset_ = 0.5;
};

constexpr cdiff::metrics::MeasureDefinition kEgoJerk = {
    "ego_jerk",
    "",
    "Ego jerk",
    "m/s^3",
    cdiff::metrics::Direction::kLowerIsBetter,
    cdiff::metrics::Subject::kEgo,
    "Mean absolute second difference of the ego's speed over two ticks, divided by the square of "
    "the tick.",
    "",
};

class EgoJerk : public cdiff::metrics::Metric {
 public:
  explicit EgoJerk(double step) : step_(step) {}

  void observe(const cdiff::metrics::MetricTick& tick) override {
    if (tick.ego == nullptr) return;
    const double speed = tick.ego->state.speed;
    if (ticks_ > 1) sum_ += std::abs(speed - 2.0 * last_ + before_) / (step_ * step_);
    before_ = last_;
    last_ = speed;
    ++ticks_;
  }
  void report(cdiff::metrics::MetricSink& sink) const override {
    cdiff::metrics::Measure measure;
    measure.n = ticks_ > 2 ? ticks_ - 2 : 0;
    if (measure.n > 0)
      measure.value = sum_ / static_cast<double>(measure.n);
    else
      measure.reason = "fewer than three ticks with the ego";
    sink.set(kEgoJerk, measure);
  }

 private:
  double step_;  ///< [s]
  double last_ = 0.0;
  double before_ = 0.0;
  double sum_ = 0.0;
  std::size_t ticks_ = 0;
};

class MyPlugins : public cdiff::plugins::Plugin {
 public:
  std::vector<cdiff::planning::PlannerDescriptor> planners() const override {
    cdiff::planning::PlannerDescriptor creep;
    creep.name = "creep";
    creep.title = "Creep";
    creep.help = "follows its route at one low speed.";
    creep.options = cdiff::planning::makePlannerOptions<CreepOptions>;
    creep.make = [](const cdiff::planning::PlannerParts& parts) {
      return std::make_unique<Creep>(parts.options.of<CreepOptions>());
    };
    return {creep};
  }
  std::vector<cdiff::guidance::ObjectiveDescriptor> objectives() const override {
    return {{"keep_right", "Keeps to the right of where the vehicle is.",
             [] { return std::make_unique<KeepRight>(); }}};
  }
  std::vector<cdiff::metrics::MetricDescriptor> metrics() const override {
    return {{"ego_jerk",
             "How jerkily the ego drives.",
             {kEgoJerk},
             [](const cdiff::metrics::MetricContext& context) {
               return std::make_unique<EgoJerk>(context.options.simulation_step);
             }}};
  }
};

}  // namespace my_plugins

CLASS_LOADER_REGISTER_CLASS(my_plugins::MyPlugins, cdiff::plugins::Plugin)
