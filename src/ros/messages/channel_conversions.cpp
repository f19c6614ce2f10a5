// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/messages/channel_conversions.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::ros {
namespace {

const Answer* answerOf(const TickValues& values, int slot) {
  const auto found = std::find_if(values.answers.begin(), values.answers.end(),
                                  [&](const Answer& one) { return one.action.slot == slot; });
  return found == values.answers.end() ? nullptr : &*found;
}

traffic::TrafficSnapshot snapshotOf(const TickMessages& tick) {
  return fromMsg(*tick.get<msgs::TrafficSnapshot>(ChannelId::kTraffic));
}

}  // namespace

AnyMessage makeTraffic(const TickValues& values, int) { return shared(toMsg(values.snapshot)); }

AnyMessage makeSelection(const TickValues& values, int) {
  if (values.selection == nullptr) return nullptr;
  return shared(toMsg(*values.selection, values.snapshot.time, *values.network));
}

AnyMessage makeControl(const TickValues& values, int slot) {
  const Answer* answer = answerOf(values, slot);
  if (answer == nullptr) return nullptr;
  return shared(
      toMsg(answer->action, values.snapshot, {answer->planner, answer->latency_ms, answer->fault}));
}

AnyMessage makeRollout(const TickValues& values, int slot) {
  const Answer* answer = answerOf(values, slot);
  return answer == nullptr ? AnyMessage() : shared(toRolloutMsg(answer->action, values.snapshot));
}

AnyMessage makeGuidance(const TickValues& values, int) {
  if (!values.cbvs_guided) return nullptr;
  std::vector<planning::PlannedAction> actions;
  double latency_ms = 0.0;
  for (const Answer& answer : values.answers) {
    if (answer.action.slot == kEgoSlot) continue;
    actions.push_back(answer.action);
    latency_ms = answer.latency_ms;
  }
  if (actions.empty()) return nullptr;
  msgs::GuidanceReport report = toGuidanceMsg(actions, values.snapshot);
  report.planner_latency_ms = latency_ms;
  report.image_age = values.image_age;
  return shared(std::move(report));
}

AnyMessage makeImage(const TickValues& values, int slot) {
  if (values.images == nullptr) return nullptr;
  for (const session::SlotImage& seen : *values.images) {
    const Answer* answer = answerOf(values, slot);
    if (seen.slot != slot || answer == nullptr) continue;
    const double time = static_cast<double>(seen.image.tick) * values.simulation_step;
    return shared(toMsg(seen.image, time, answer->action.vehicle_id));
  }
  return nullptr;
}

void takeDecision(const AnyMessage& message, const TickReading&, Answer& answer) {
  for (const msgs::DecidedVehicle& vehicle : messageAs<msgs::DecisionRecord>(message)->vehicles) {
    if (vehicle.slot == answer.action.slot && vehicle.vehicle_id == answer.action.vehicle_id)
      answer.drove = vehicle.answer_drove != 0;
  }
}

/// A user's own planner may leave out whom it drives and what it is called.
void takeControl(const AnyMessage& message, const TickReading&, Answer& answer) {
  const auto control = messageAs<msgs::ControlAction>(message);
  const int slot = answer.action.slot;
  const std::string vehicle_id = answer.action.vehicle_id;
  answer.action = fromMsg(*control);
  answer.action.slot = slot;
  answer.action.vehicle_id = vehicle_id;
  answer.planner = control->planner.empty() ? "ego:external" : control->planner;
  answer.latency_ms = control->planner_latency_ms;
  answer.fault = control->fault;
}

void takeRollout(const AnyMessage& message, const TickReading&, Answer& answer) {
  answer.action.rollout = fromMsg(*messageAs<msgs::Rollout>(message));
}

void takeGuidance(const AnyMessage& message, const TickReading&, Answer& answer) {
  for (const msgs::VehicleGuidance& vehicle : messageAs<msgs::GuidanceReport>(message)->vehicles) {
    if (vehicle.vehicle_id != answer.action.vehicle_id) continue;
    answer.action.guidance = fromMsg(vehicle);
    answer.action.state_mismatch = vehicle.state_mismatch;
  }
}

void takeImage(const AnyMessage& message, const TickReading& reading, Answer& answer) {
  const planning::PlannedAction& action = answer.action;
  const ExpectedImage expected = {imageOf(action.slot).name(), action.vehicle_id,
                                  reading.camera.width, reading.camera.height,
                                  reading.simulation_step};
  try {
    answer.image = fromMsg(*messageAs<sensor_msgs::Image>(message), expected);
  } catch (const core::InputError&) {  // its planner has braked and said why
  }
}

AnyMessage deriveCameraInfo(const TickMessages& tick, const TickReading& reading, int slot) {
  const auto image = tick.get<sensor_msgs::Image>(imageOf(slot));
  return image ? shared(toCameraInfoMsg(reading.camera, image->header)) : AnyMessage();
}

AnyMessage deriveTransforms(const TickMessages& tick, const TickReading& reading, int) {
  const bool seen = tick.holds(ChannelId::kEgoImage) || tick.holds(ChannelId::kCbvImage);
  return shared(toTfMsg(snapshotOf(tick), seen ? &reading.camera : nullptr));
}

AnyMessage deriveOdometry(const TickMessages& tick, const TickReading&, int) {
  const traffic::TrafficSnapshot snapshot = snapshotOf(tick);
  const traffic::Vehicle* ego = snapshot.ego();
  return ego == nullptr ? AnyMessage() : shared(toOdometryMsg(*ego, snapshot.time));
}

}  // namespace cdiff::ros
