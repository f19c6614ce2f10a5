// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/lockstep/image_inbox.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"
#include "ros/messages/channel_conversions.h"
#include "ros/messages/conversions.h"
#include "ros/messages/topics.h"
#include "session/closed_loop.h"

namespace cdiff::ros {
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

std::string missingText(int slot, std::uint64_t tick) {
  return "no image on " + imageOf(slot).name() + " for tick " + std::to_string(tick);
}

/// [s] of simulated time.
double ageOf(const sensor_msgs::Image& image, const traffic::TrafficSnapshot& snapshot) {
  return (toStamp(snapshot.time) - image.header.stamp).toSec();
}

/// Puts the images into `images` and points the tasks to them; answers each task's fault.
std::vector<std::string> attach(const ImageInbox& inbox, const traffic::TrafficSnapshot& snapshot,
                                std::vector<PlanningTask>& tasks,
                                std::vector<session::SlotImage>& images,
                                PlannerDecision& decision) {
  std::vector<std::string> faults(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const auto message = inbox.find(tasks[i].slot, snapshot.tick);
    if (!message) {
      faults[i] = missingText(tasks[i].slot, snapshot.tick);
      ++decision.missing;
      continue;
    }
    try {
      images.push_back(
          {tasks[i].slot, inbox.read(tasks[i].slot, tasks[i].vehicle->id, snapshot.tick)});
      decision.image_age = std::max(decision.image_age, ageOf(*message, snapshot));
    } catch (const core::InputError& error) {
      faults[i] = error.what();
      ++decision.refused;
    }
  }
  session::attachImages(images, tasks);
  return faults;
}

}  // namespace

void ImageInbox::add(int slot, const sensor_msgs::Image::ConstPtr& message) {
  images_[nearestTick(message->header.stamp, simulation_step_)].emplace(slot, message);
}

sensor_msgs::Image::ConstPtr ImageInbox::find(int slot, std::uint64_t tick) const {
  const auto at_tick = images_.find(tick);
  if (at_tick == images_.end()) return nullptr;
  const auto found = at_tick->second.find(slot);
  return found == at_tick->second.end() ? nullptr : found->second;
}

traffic::CameraImage ImageInbox::read(int slot, const std::string& vehicle_id,
                                      std::uint64_t tick) const {
  return fromMsg(*images_.at(tick).at(slot), {imageOf(slot).name(), vehicle_id, camera_.width,
                                              camera_.height, simulation_step_});
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
  std::vector<PlanningTask> with_images = tasks;
  std::vector<session::SlotImage> images;
  const std::vector<std::string> faults = attach(inbox, snapshot, with_images, images, decision);
  std::vector<PlanningTask> seeing;
  for (const PlanningTask& task : with_images) {
    if (task.image != nullptr) seeing.push_back(task);
  }
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

}  // namespace cdiff::ros
