// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/closed_loop.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <set>
#include <thread>

#include "core/forked_work.h"
#include "core/stage_times.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "traffic/shown_fault.h"

namespace cdiff::session {
namespace {

using Clock = std::chrono::steady_clock;
using planning::PlannedAction;
using planning::PlanningTask;
using traffic::SessionStatus;

std::vector<PlannedAction> failSafe(const std::vector<PlanningTask>& tasks) {
  std::vector<PlannedAction> actions;
  for (const PlanningTask& task : tasks) actions.push_back(planning::failSafeAction(task));
  return actions;
}

bool answersAll(const std::vector<PlannedAction>& actions, const std::vector<PlanningTask>& tasks) {
  if (actions.size() != tasks.size()) return false;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (actions[i].slot != tasks[i].slot || actions[i].vehicle_id != tasks[i].vehicle->id)
      return false;
  }
  return true;
}

}  // namespace

void requireLockstep(const ScenarioOptions& options) {
  if (options.real_time_factor <= 0.0) return;
  throw core::InputError(
      "key 'real_time_factor' is " + core::formatNumber(options.real_time_factor) +
      ", which needs the node graph (roslaunch e2e_cdiff session.launch): in one process no answer "
      "can be late; expected 0 here, and 'at_most' to limit the pace");
}

std::vector<PlanningTask> cbvTasks(const traffic::TrafficSnapshot& snapshot,
                                   const cbv::CbvSelection& selection, const SessionSetup& setup,
                                   std::optional<double> target_speed) {
  std::vector<PlanningTask> tasks;
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const traffic::Vehicle* vehicle = snapshot.find(assignment.vehicle_id);
    if (vehicle == nullptr) continue;
    tasks.push_back({assignment.slot, vehicle, &assignment.conflict_aware_route,
                     target_speed ? *target_speed : setup.cbvTargetSpeed(vehicle->id)});
  }
  return tasks;
}

std::string steerPlanner(const std::vector<traffic::SteeringChange>& changes, SteeredCbvs& cbvs,
                         planning::Planner& planner) {
  bool changed = false;
  for (const traffic::SteeringChange& change : changes) changed = cbvs.follow(change) || changed;
  if (!changed) return {};
  try {
    planner.setGuidance(cbvs.guidance());
    return {};
  } catch (const core::InputError& error) {
    return "the guidance that was asked for cannot be followed: " + std::string(error.what()) +
           "; the one before is kept";
  }
}

std::vector<PlanningTask> egoTasks(const traffic::TrafficSnapshot& snapshot,
                                   const map::Route& route, double target_speed) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return {};
  return {{traffic::kEgoSlot, ego, &route, target_speed}};
}

std::vector<PlannedAction> planTimed(planning::Planner& planner,
                                     const traffic::TrafficSnapshot& snapshot,
                                     const std::vector<PlanningTask>& tasks, double& milliseconds,
                                     std::string& fault) {
  const Clock::time_point begin = Clock::now();
  std::vector<PlannedAction> actions;
  fault.clear();
  try {
    actions = planner.plan(snapshot, tasks);
    if (!answersAll(actions, tasks))
      fault = "the planner answered for other vehicles than it was asked for";
  } catch (const std::exception& error) {
    fault = traffic::thrownFaultText(error);
  } catch (...) {
    fault = "the planner threw something that is no std::exception";
  }
  milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  for (PlannedAction& action : actions) action.fault = traffic::shownFaultText(action.fault);
  return fault.empty() ? actions : failSafe(tasks);
}

LoopParts makeParts(const SessionSetup& setup) {
  const ScenarioOptions& options = setup.options();
  LoopParts parts;
  parts.ego_planner = {setup.makeEgoPlanner(), planners::seesImages(options.ego_planner)};
  parts.cbv_planner = {setup.makeCbvPlanner(), planners::seesImages(options.cbv_planner)};
  if (parts.ego_planner.sees || parts.cbv_planner.sees) parts.cameras.emplace(setup);
  parts.selector = setup.makeCbvSelector();
  return parts;
}

ClosedLoop::ClosedLoop(const SessionSetup& setup) : ClosedLoop(setup, makeParts(setup)) {}

ClosedLoop::ClosedLoop(const SessionSetup& setup, LoopParts parts)
    : setup_(setup), parts_(std::move(parts)), steered_(setup.options()) {
  requireLockstep(setup.options());
  if (parts_.world == nullptr) parts_.world = std::make_unique<World>(setup);
}

ClosedLoop::~ClosedLoop() = default;

struct ClosedLoop::Decision {
  cbv::CbvSelection selection;
  std::vector<PlannedAction> actions;
  std::vector<SlotImage> images;
  std::vector<PlannerLatency> latencies;
};

/// What is shown of one tick. Observers that may lag get a copy of the snapshot.
struct ClosedLoop::Tick {
  Decision decision;
  traffic::TrafficSnapshot snapshot;  ///< used where observers may lag
  TickRecord record;
};

void ClosedLoop::render(const traffic::Vehicle& vehicle, int slot, Decision& decision) {
  const core::TimedStage stage("rendering");
  parts_.cameras->render(world().snapshot(), vehicle, slot, decision.images);
}

void ClosedLoop::ask(const LoopPlanner& asked, const std::string& name,
                     std::vector<PlanningTask> tasks, Decision& decision) {
  if (tasks.empty()) return;
  const core::NamedCall call("planner", name.substr(name.find(':') + 1));
  if (asked.sees) {
    for (const PlanningTask& task : tasks) render(*task.vehicle, task.slot, decision);
    attachImages(decision.images, parts_.cameras->rigs(), tasks);
  }
  const core::TimedStage stage(tasks.front().slot == traffic::kEgoSlot ? "ego_plan" : "cbv_plans");
  PlannerLatency latency{name, 0.0};
  std::string fault;
  std::set<std::string> recorded;  // vehicles may share a cause
  for (PlannedAction& action :
       planTimed(*asked.planner, world().snapshot(), tasks, latency.milliseconds, fault)) {
    if (!fault.empty()) action.fault = fault;
    if (!action.fault.empty() && recorded.insert(action.fault).second)
      parts_.world->recordFault(name, action.fault);
    decision.actions.push_back(std::move(action));
  }
  decision.latencies.push_back(latency);
}

void ClosedLoop::renderWishes(Decision& decision) {
  const traffic::TrafficSnapshot& snapshot = world().snapshot();
  for (const PlannedAction& action : decision.actions) {
    const traffic::Vehicle& vehicle = *snapshot.find(action.vehicle_id);
    const bool there =
        std::any_of(decision.images.begin(), decision.images.end(),
                    [&](const SlotImage& image) { return image.slot == action.slot; });
    if (!there && parts_.image_wish(snapshot, vehicle, action.slot))
      render(vehicle, action.slot, decision);
  }
}

void ClosedLoop::steer(const std::vector<traffic::SteeringChange>& changes) {
  const std::string unfollowed = steerPlanner(changes, steered_, *parts_.cbv_planner.planner);
  if (!unfollowed.empty())
    parts_.world->recordFault("cbv:" + setup_.options().cbv_planner, unfollowed);
}

ClosedLoop::Decision ClosedLoop::decide() {
  const traffic::TrafficSnapshot& snapshot = world().snapshot();
  const ScenarioOptions& options = setup_.options();
  Decision decision;
  if (!snapshot.steering.empty()) steer(snapshot.steering);
  {
    const core::TimedStage stage("selection");
    decision.selection = parts_.selector->update(snapshot);
  }
  ask(parts_.ego_planner, "ego:" + options.ego_planner,
      egoTasks(snapshot, setup_.egoRoute(), options.target_speed), decision);
  ask(parts_.cbv_planner, "cbv:" + options.cbv_planner,
      cbvTasks(snapshot, decision.selection, setup_, steered_.targetSpeed()), decision);
  if (parts_.image_wish) renderWishes(decision);
  return decision;
}

/// Looks at the present tick and decides there; false when the session ended over it.
bool ClosedLoop::fill(Tick& tick) {
  const traffic::TrafficSnapshot& snapshot = world().snapshot();
  tick.record.snapshot = &snapshot;
  if (!snapshot.decision_tick) {
    const core::TimedStage stage("selection");
    parts_.selector->observe(snapshot);
    return true;
  }
  try {
    tick.decision = decide();
  } catch (const std::exception& error) {
    parts_.world->end(SessionStatus::kError, {snapshot.tick, "cbv_identification", error.what()});
    return false;
  }
  tick.record.selection = &tick.decision.selection;
  tick.record.actions = &tick.decision.actions;
  tick.record.images = &tick.decision.images;
  tick.record.latencies = tick.decision.latencies;
  return true;
}

/// To the observers here, or to those `beside`.
void ClosedLoop::show(const std::shared_ptr<Tick>& tick, ObserverThread* beside) {
  const core::TimedStage stage("record");
  if (beside != nullptr) {
    tick->snapshot = world().snapshot();
    tick->record.snapshot = &tick->snapshot;
    beside->show({tick, &tick->record});
    return;
  }
  for (SessionObserver* observer : observers_) observer->observe(tick->record);
}

/// Waits until the next tick may begin; false when the session is to end before it.
bool ClosedLoop::holdBack(const std::atomic<bool>& stop) {
  while (!stop && !control().quitting()) {
    const auto wait = control().holdBack(world().snapshot().time, Clock::now());
    if (wait == Clock::duration::zero()) return true;
    std::this_thread::sleep_for(wait);
  }
  return false;
}

SessionStatus ClosedLoop::run(const std::atomic<bool>& stop) {
  const core::TimedStage stage("rest");
  const auto beside = beside_ ? std::make_unique<ObserverThread>(observers_) : nullptr;
  while (true) {
    const auto tick = std::make_shared<Tick>();
    if (!fill(*tick)) continue;
    show(tick, beside.get());
    const traffic::TrafficSnapshot& snapshot = world().snapshot();
    if (snapshot.status != SessionStatus::kRunning) break;
    if (!holdBack(stop)) {
      parts_.world->end(SessionStatus::kInterrupted, {snapshot.tick, "user", "interrupted"});
      continue;
    }
    parts_.world->advance(tick->record.selection, tick->decision.actions);
  }
  if (beside) beside->finish();
  return world().snapshot().status;
}

}  // namespace cdiff::session
