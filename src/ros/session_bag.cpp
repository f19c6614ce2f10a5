// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/session_bag.h"

#include <boost/make_shared.hpp>

#include "planners/registry.h"
#include "ros/conversions.h"
#include "ros/image_conversions.h"
#include "ros/topics.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

std::string bagTopic(const std::string& topic) { return "/" + topic; }

template <class Message>
boost::shared_ptr<const Message> shared(Message message) {
  return boost::make_shared<const Message>(std::move(message));
}

double latencyOf(const session::TickRecord& record, const std::string& planner) {
  for (const session::PlannerLatency& latency : record.latencies) {
    if (latency.planner == planner) return latency.milliseconds;
  }
  return 0.0;
}

}  // namespace

SessionBag::SessionBag(const session::SessionSetup& setup, const fs::path& file,
                       const BagOrigin& origin)
    : setup_(setup), file_(file, setup.options().camera, bagTopic), reporter_(setup) {
  msgs::SessionInfo info = toMsg(setup);
  info.deployment = origin.deployment;
  info.simulator_version = origin.simulator_version;
  info.package_version = E2E_CDIFF_VERSION;
  info.results_folder = fs::absolute(file).parent_path().string();
  file_.write(info);
  file_.write(toPathMsg(setup.egoRoute()));
}

SessionBag::~SessionBag() = default;

void SessionBag::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  TickMessages tick;
  tick.snapshot = shared(toMsg(snapshot));
  if (record.selection != nullptr)
    tick.selection = shared(toMsg(*record.selection, snapshot.time, setup_.network()));
  if (record.actions != nullptr) {
    addActions(record, tick);
    addGuidance(record, tick);
    if (record.images != nullptr) addImages(record, tick);
  }
  tick.report = reporter_.observe(snapshot, record.selection);
  file_.write(tick);
}

std::string SessionBag::plannerOf(int slot) const {
  const session::ScenarioOptions& options = setup_.options();
  return slot == kEgoSlot ? "ego:" + options.ego_planner : "cbv:" + options.cbv_planner;
}

void SessionBag::addActions(const session::TickRecord& record, TickMessages& tick) const {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  for (const planning::PlannedAction& action : *record.actions) {
    ActionOrigin origin{plannerOf(action.slot), 0.0, action.fault};
    origin.latency_ms = latencyOf(record, origin.planner);
    if (noisy_ && noisy_(action.vehicle_id)) origin.planner += kNoiseMark;
    tick.controls[action.slot] = shared(toMsg(action, snapshot, origin));
    if (action.slot != kEgoSlot)
      tick.rollouts[action.slot] = shared(toRolloutMsg(action, snapshot));
  }
}

/// Where the diffusion planner's node reports it.
void SessionBag::addGuidance(const session::TickRecord& record, TickMessages& tick) const {
  if (tick.rollouts.empty() || !planners::seesImages(setup_.options().cbv_planner)) return;
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlannedAction& action : *record.actions) {
    if (action.slot != kEgoSlot) actions.push_back(action);
  }
  msgs::GuidanceReport report = toGuidanceMsg(actions, *record.snapshot);
  report.planner_latency_ms = latencyOf(record, plannerOf(actions.front().slot));
  tick.guidance = shared(std::move(report));
}

void SessionBag::addImages(const session::TickRecord& record, TickMessages& tick) const {
  for (const session::SlotImage& seen : *record.images) {
    const double time = static_cast<double>(seen.image.tick) * setup_.options().simulation_step;
    tick.images[seen.slot] =
        shared(toMsg(seen.image, time, tick.controls.at(seen.slot)->vehicle_id));
  }
}

void SessionBag::finish() { file_.finish(); }

}  // namespace cdiff::ros
