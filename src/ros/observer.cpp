// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/observer.h"

#include "ros/message_checks.h"

namespace cdiff::ros {

namespace msgs = ::e2e_cdiff;

void Observer::listenToAnswers(const session::ScenarioOptions& options,
                               const ImageInterest& images) {
  const bool guided = graph().cbvsSee();
  const ExpectedAnswers expected{guided, true, images.ego, images.cbvs, graph().recordsDecisions()};
  answers_ = TickAnswers(options.simulation_step, expected, options.camera);
  listen<msgs::CbvSelection>(kSelectionTopic, [this](const auto& message) {
    const std::string wrong = unusable(*message, graph().max_cbv);
    if (wrong.empty()) answers_.add(message);
    return wrong;
  });
  if (graph().recordsDecisions()) {
    listen<msgs::DecisionRecord>(kDecisionRecordTopic,
                                 [this](const auto& message) { answers_.add(message); });
  } else {
    for (int slot = kEgoSlot; slot < graph().max_cbv; ++slot) listenToControls(slot);
  }
  if (guided) {
    listen<msgs::GuidanceReport>(kGuidanceTopic,
                                 [this](const auto& message) { answers_.add(message); });
  }
  if (images.ego) listenToImages(kEgoSlot);
  for (int slot = 0; slot < graph().max_cbv; ++slot) {
    listenToSlot(slot);
    if (images.cbvs) listenToImages(slot);
  }
}

void Observer::listenToControls(int slot) {
  if (slot == kEgoSlot) {
    return listen<msgs::ControlAction>(kEgoControlTopic,
                                       [this](const auto& message) { answers_.addEgo(message); });
  }
  listen<msgs::ControlAction>(cbvControlTopic(slot), [this, slot](const auto& message) {
    if (message->slot != slot) return wrongSlot(message->slot);
    answers_.addCbv(slot, message);
    return std::string();
  });
}

void Observer::listenToSlot(int slot) {
  listen<msgs::Rollout>(cbvRolloutTopic(slot), [this, slot](const auto& message) {
    if (message->slot != slot) return wrongSlot(message->slot);
    answers_.addRollout(slot, message);
    return std::string();
  });
}

void Observer::listenToImages(int slot) {
  listen<sensor_msgs::Image>(
      imageTopic(slot), [this, slot](const auto& message) { answers_.addImage(slot, message); });
}

bool Observer::complete(const msgs::TrafficSnapshot& snapshot, bool superseded) {
  constexpr double kPatience = 0.5;  // [s] of wall time for messages that are on their way
  const bool all = answers_.missing(snapshot).empty();
  if (all || over() || (superseded && !graph().recordsDecisions())) {
    waiting_since_ = {};
    return true;
  }
  if (!superseded || !answers_.decision(snapshot.tick)) return false;
  const ::ros::WallTime now = ::ros::WallTime::now();
  if (waiting_since_.isZero()) waiting_since_ = now;
  if ((now - waiting_since_).toSec() < kPatience) return false;
  waiting_since_ = {};
  return true;
}

}  // namespace cdiff::ros
