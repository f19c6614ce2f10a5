// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/image_inbox.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "session/closed_loop.h"
#include "session/vehicle_cameras.h"

namespace cdiff::node_graph {
namespace {

using planning::PlannedAction;
using planning::PlanningTask;

PlannedAction failSafe(const PlanningTask& task, const std::string& fault) {
  PlannedAction action;
  action.slot = task.slot;
  action.vehicle_id = task.vehicle->id;
  action.action = traffic::ControlAction::failSafe();
  action.fault = fault;
  return action;
}

std::string missingText(const Topic& topic, std::uint64_t tick) {
  const std::string of =
      topic.camera == rendering::kFrontCamera ? "" : " of camera '" + topic.camera + "'";
  return "no image" + of + " on " + topic.name() + " for tick " + std::to_string(tick);
}

/// [s] of simulated time.
double ageOf(const sensor_msgs::Image& image, const traffic::TrafficSnapshot& snapshot) {
  return (toStamp(snapshot.time) - image.header.stamp).toSec();
}

/// Appends the images of a task's vehicle; answers its fault, which is empty when all came and are
/// as expected.
std::string take(const ImageInbox& inbox, const traffic::TrafficSnapshot& snapshot,
                 const PlanningTask& task, std::vector<session::SlotImage>& images,
                 PlannerDecision& decision) {
  for (const std::string& camera : inbox.rigs().of(task.slot).names()) {
    const auto message = inbox.find(task.slot, snapshot.tick, camera);
    if (!message) {
      ++decision.missing;
      return missingText(imageOf(task.slot, camera), snapshot.tick);
    }
    try {
      images.push_back(
          {task.slot, inbox.read(task.slot, task.vehicle->id, snapshot.tick, camera), camera});
      decision.image_age = std::max(decision.image_age, ageOf(*message, snapshot));
    } catch (const core::InputError& error) {
      ++decision.refused;
      return error.what();
    }
  }
  return "";
}

}  // namespace

void ImageInbox::add(int slot, const sensor_msgs::Image::ConstPtr& message,
                     const std::string& camera) {
  images_[nearestTick(message->header.stamp, simulation_step_)].emplace(std::pair(slot, camera),
                                                                        message);
}

sensor_msgs::Image::ConstPtr ImageInbox::find(int slot, std::uint64_t tick,
                                              const std::string& camera) const {
  const auto at_tick = images_.find(tick);
  if (at_tick == images_.end()) return nullptr;
  const auto found = at_tick->second.find({slot, camera});
  return found == at_tick->second.end() ? nullptr : found->second;
}

bool ImageInbox::complete(int slot, std::uint64_t tick) const {
  const std::vector<rendering::RigCamera>& cameras = rigs_.of(slot).cameras;
  return std::all_of(cameras.begin(), cameras.end(), [&](const rendering::RigCamera& camera) {
    return find(slot, tick, camera.name) != nullptr;
  });
}

traffic::CameraImage ImageInbox::read(int slot, const std::string& vehicle_id, std::uint64_t tick,
                                      const std::string& camera) const {
  return fromMsg(*images_.at(tick).at({slot, camera}),
                 expectedOf(imageOf(slot, camera), vehicle_id, {rigs_, simulation_step_}));
}

void ImageInbox::forgetBefore(std::uint64_t tick) {
  images_.erase(images_.begin(), images_.lower_bound(tick));
}

PlannerDecision planBlind(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                          const std::vector<PlanningTask>& tasks) {
  PlannerDecision decision;
  decision.actions =
      session::planTimed(planner, snapshot, tasks, decision.latency_ms, decision.fault);
  return decision;
}

PlannerDecision planSeeing(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                           const std::vector<PlanningTask>& tasks, const ImageInbox& inbox) {
  PlannerDecision decision;
  std::vector<session::SlotImage> images;
  std::vector<std::string> faults;
  std::vector<PlanningTask> seeing;
  for (const PlanningTask& task : tasks) {
    faults.push_back(take(inbox, snapshot, task, images, decision));
    if (faults.back().empty()) seeing.push_back(task);
  }
  session::attachImages(images, inbox.rigs(), seeing);
  std::vector<PlannedAction> planned;
  if (!seeing.empty()) {
    planned = session::planTimed(planner, snapshot, seeing, decision.latency_ms, decision.fault);
  }
  auto next = planned.begin();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    decision.actions.push_back(faults[i].empty() ? std::move(*next++)
                                                 : failSafe(tasks[i], faults[i]));
  }
  return decision;
}

}  // namespace cdiff::node_graph
