// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/continuation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "realism/recording.h"
#include "realism/recording_builder.h"
#include "session/closed_loop.h"

namespace cdiff::realism {
namespace {

using core::InputError;

/// Never asked: nothing is handed over.
class NoPlanner : public planning::Planner {
 public:
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& /*snapshot*/,
      const std::vector<planning::PlanningTask>& /*tasks*/) override {
    return {};
  }
};

/// A driver whose target speeds are those of a HandOverDriver, in place of the session's.
class DriverWithItsSpeed : public planning::Planner {
 public:
  DriverWithItsSpeed(std::unique_ptr<planning::Planner> planner, const HandOverDriver& driver,
                     double fixed)
      : planner_(std::move(planner)),
        speeds_(driver.target_speed),
        seed_(driver.planner_seed),
        fixed_(fixed) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override {
    std::vector<planning::PlanningTask> own = tasks;
    for (planning::PlanningTask& task : own)
      task.target_speed = session::cbvTargetSpeed(speeds_, fixed_, seed_, task.vehicle->id);
    return planner_->plan(snapshot, own);
  }

 private:
  std::unique_ptr<planning::Planner> planner_;
  session::CbvSpeedOptions speeds_;
  std::uint64_t seed_;
  double fixed_;
};

std::unique_ptr<planning::Planner> makeDriver(const session::SessionSetup& setup,
                                              const HandOverDriver& driver) {
  if (driver.planner.empty()) return std::make_unique<NoPlanner>();
  const session::ScenarioOptions& options = setup.options();
  planning::PlanningContext context{setup.network(),         setup.drivableArea(),
                                    driver.planner_seed,     options.simulation_step,
                                    options.decision_period, &setup.egoRoute()};
  auto planner = planners::makePlanner(
      driver.planner, {context, options.planner_options, options.vehicle, options.camera,
                       options.guidance, "guidance.", options.cbv_rig, "cbv_rig"});
  return std::make_unique<DriverWithItsSpeed>(std::move(planner), driver, options.target_speed);
}

/// The CBVs' cameras are those of their driver's planner.
session::VehicleRigs rigsOf(session::ScenarioOptions options, const HandOverDriver& driver) {
  if (!driver.planner.empty()) options.cbv_planner = driver.planner;
  return session::VehicleRigs(options);
}

/// The parts of the session with the driver's planner and our selector, which `selector` names.
session::LoopParts makeParts(const session::SessionSetup& setup, const HandOverDriver& driver,
                             const HandOverSelector*& selector) {
  const session::ScenarioOptions& options = setup.options();
  session::LoopParts parts;
  parts.ego_planner = {setup.makeEgoPlanner(), planners::seesImages(options.ego_planner)};
  parts.cbv_planner = {makeDriver(setup, driver), planners::seesImages(driver.planner)};
  if (parts.ego_planner.sees || parts.cbv_planner.sees)
    parts.cameras.emplace(setup, rigsOf(options, driver));
  auto own = std::make_unique<HandOverSelector>(setup.makeCbvSelector(), !driver.planner.empty());
  selector = own.get();
  parts.selector = std::move(own);
  return parts;
}

void requireTenHertz(const session::ScenarioOptions& options) {
  if (std::abs(options.decision_period - kStep) < 1e-9) return;
  throw InputError("key 'decision_period' is " + core::formatNumber(options.decision_period) +
                   " s; realism is measured at 10 Hz, expected 0.1");
}

void requireDrivers(const session::ScenarioOptions& options) {
  const auto& pdm_lite = options.planner_options.of<planners::PdmLiteOptions>();
  if (pdm_lite.cbv_speed_spread > 0.0 || pdm_lite.cbv_headway_spread > 0.0) return;
  const std::string name = planners::kDefaultEgoPlanner;
  throw InputError("keys '" + name + ".cbv_speed_spread' and '" + name +
                   ".cbv_headway_spread' are 0, so that all drivers of the log and its rollouts "
                   "are one; set at least one of them, such as 0.1 and 0.5");
}

std::uint64_t seedOf(const session::SessionSetup& setup, std::size_t rollout) {
  const core::RandomStream seeds(static_cast<std::uint64_t>(setup.options().seed), "realism");
  return seeds.bits({0, static_cast<std::uint32_t>(rollout), 0}, 0);
}

void requireSameStart(const Continuation& log, const Continuation& rollout) {
  if (log.sha256 == rollout.sha256 && log.objects == rollout.objects) return;
  throw std::logic_error("two courses of one session differ before the hand-over at tick " +
                         std::to_string(log.hand_over_tick));
}

std::size_t stepsOf(const Course& course) {
  return static_cast<std::size_t>(std::count_if(course[kRoadEdge].begin(), course[kRoadEdge].end(),
                                                [](double value) { return !std::isnan(value); }));
}

/// By object: its course in each rollout. Empty when the session was stopped by the user.
std::vector<std::vector<Course>> rolloutsOf(const session::SessionSetup& setup,
                                            const std::string& planner, const Continuation& log,
                                            const ContinuationOptions& options) {
  const auto count = static_cast<std::size_t>(options.rollouts);
  std::vector<std::vector<Course>> courses(log.objects.size());
  std::optional<Continuation> rollout;
  for (std::size_t i = 1; i <= count; ++i) {
    if (i == 1 || !planner.empty())
      rollout = continueSession(
          setup, {planner, seedOf(setup, i), setup.options().cbv_target_speed}, options.seconds);
    if (!rollout) throw std::logic_error("a rollout has no hand-over");
    requireSameStart(log, *rollout);
    for (std::size_t object = 0; object < courses.size(); ++object)
      courses[object].push_back(rollout->courses[object]);
  }
  return courses;
}

}  // namespace

std::optional<Continuation> continueSession(const session::SessionSetup& setup,
                                            const HandOverDriver& driver, double seconds) {
  requireTenHertz(setup.options());
  const HandOverSelector* selector = nullptr;
  session::LoopParts parts = makeParts(setup, driver, selector);
  session::ClosedLoop loop(setup, std::move(parts));
  std::atomic<bool> stop{false};
  const auto steps = static_cast<std::size_t>(std::lround(seconds / kStep));
  CourseRecorder recorder(setup, *selector, steps, driver.planner.empty(), stop);
  loop.addObserver(recorder);
  if (loop.run(stop) == traffic::SessionStatus::kError)
    throw core::SimulatorError("the session ended by an error: " + recorder.error());
  return recorder.take();
}

ContinuationScore scoreDriver(const session::SessionSetup& setup, const std::string& planner,
                              const ContinuationOptions& options) {
  requireDrivers(setup.options());
  ContinuationScore score;
  const auto log =
      continueSession(setup, {planners::kDefaultEgoPlanner, seedOf(setup, 0)}, options.seconds);
  if (!log) return score;
  score.hand_over_tick = log->hand_over_tick;
  score.objects = log->objects;
  const auto rollouts = rolloutsOf(setup, planner, *log, options);
  for (std::size_t i = 0; i < log->objects.size(); ++i) {
    addObject(log->courses[i], rollouts[i], score.sums);
    score.log_steps += stepsOf(log->courses[i]);
    for (const Course& course : rollouts[i]) score.rollout_steps += stepsOf(course);
  }
  return score;
}

}  // namespace cdiff::realism
