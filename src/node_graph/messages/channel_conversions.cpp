// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/channel_conversions.h"

#include <algorithm>
#include <stdexcept>

#include "core/text.h"
#include "cv_bridge/cv_bridge.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "sensor_msgs/distortion_models.h"
#include "sensor_msgs/image_encodings.h"
#include "traffic/shown_fault.h"

namespace cdiff::node_graph {
namespace {

const std::string& kEncoding = sensor_msgs::image_encodings::RGB8;

std::string sizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

[[noreturn]] void refuse(const ExpectedImage& expected, const std::string& what) {
  throw core::InputError("image on " + expected.topic + " " + what);
}

void checkShape(const sensor_msgs::Image& message, const ExpectedImage& expected) {
  if (message.encoding != kEncoding)
    refuse(expected, "has encoding '" + message.encoding + "'; expected '" + kEncoding + "'");
  if (message.width != expected.width || message.height != expected.height) {
    refuse(expected, "is " + sizeText(message.width, message.height) + " pixels; expected " +
                         sizeText(expected.width, expected.height));
  }
  const std::size_t bytes = std::size_t{message.step} * message.height;
  if (message.step < 3 * message.width || message.data.size() != bytes) {
    refuse(expected, "has " + std::to_string(message.data.size()) + " bytes in rows of " +
                         std::to_string(message.step) + " for " +
                         sizeText(message.width, message.height) + " pixels");
  }
}

void checkOrigin(const sensor_msgs::Image& message, const ExpectedImage& expected,
                 std::uint64_t tick) {
  const std::string frame = opticalFrame(expected.vehicle_id, expected.camera);
  const std::string& found = message.header.frame_id;
  if (found != frame && !core::endsWith(found, "/" + frame)) {  // recorded in a namespace
    refuse(expected, "has frame '" + found + "'; expected '" + frame + "'");
  }
  if (toStamp(static_cast<double>(tick) * expected.simulation_step) != message.header.stamp) {
    refuse(expected, "has stamp " + core::formatFixed(message.header.stamp.toSec(), 9) +
                         ", which is no tick of " + core::formatNumber(expected.simulation_step) +
                         " s");
  }
}

}  // namespace

std::string opticalFrame(const std::string& vehicle_id, const std::string& camera) {
  return cameraFrame(vehicle_id, camera) + "_optical";
}

ExpectedImage expectedOf(const Topic& topic, const std::string& vehicle_id,
                         const TickReading& reading) {
  const rendering::RigCamera* camera = reading.rigs.of(topic.slot).find(topic.camera);
  if (camera == nullptr) throw std::logic_error("no camera of the rig has this topic");
  return {topic.name(), vehicle_id, camera->width, camera->height, reading.simulation_step,
          topic.camera};
}

sensor_msgs::Image toMsg(const traffic::CameraImage& image, double time,
                         const std::string& vehicle_id, const std::string& camera) {
  std_msgs::Header header;
  header.stamp = toStamp(time);
  header.frame_id = opticalFrame(vehicle_id, camera);
  cv_bridge::CvImage picture(header, kEncoding, cv::Mat(image.height, image.width, CV_8UC3));
  std::copy(image.rgb.begin(), image.rgb.end(), picture.image.data);
  sensor_msgs::Image message;
  picture.toImageMsg(message);
  return message;
}

traffic::CameraImage fromMsg(const sensor_msgs::Image& message, const ExpectedImage& expected) {
  checkShape(message, expected);
  traffic::CameraImage image;
  image.tick = nearestTick(message.header.stamp, expected.simulation_step);
  checkOrigin(message, expected, image.tick);
  image.width = static_cast<int>(message.width);
  image.height = static_cast<int>(message.height);
  const cv_bridge::CvImageConstPtr picture = cv_bridge::toCvShare(message, {}, kEncoding);
  image.rgb.reserve(std::size_t{3} * message.width * message.height);
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* begin = picture->image.ptr(row);
    image.rgb.insert(image.rgb.end(), begin, begin + std::ptrdiff_t{3} * image.width);
  }
  return image;
}

sensor_msgs::CameraInfo toCameraInfoMsg(const rendering::RigCamera& camera,
                                        const std_msgs::Header& header) {
  const rendering::Intrinsics intrinsics = rendering::intrinsicsOf(camera);
  const double f = intrinsics.focal_length;
  const double x = intrinsics.center_x;
  const double y = intrinsics.center_y;
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(5, 0.0);
  info.K = {f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, x, 0.0, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

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

AnyMessage makeTraffic(const TickValues& values, const Topic&) {
  return shared(toMsg(values.snapshot));
}

AnyMessage makeSelection(const TickValues& values, const Topic&) {
  if (values.selection == nullptr) return nullptr;
  return shared(toMsg(*values.selection, values.snapshot.time, *values.network));
}

AnyMessage makeControl(const TickValues& values, const Topic& topic) {
  const Answer* answer = answerOf(values, topic.slot);
  if (answer == nullptr) return nullptr;
  return shared(
      toMsg(answer->action, values.snapshot, {answer->planner, answer->latency_ms, answer->fault}));
}

AnyMessage makeRollout(const TickValues& values, const Topic& topic) {
  const Answer* answer = answerOf(values, topic.slot);
  return answer == nullptr ? AnyMessage() : shared(toRolloutMsg(answer->action, values.snapshot));
}

AnyMessage makeGuidance(const TickValues& values, const Topic&) {
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

AnyMessage makeImage(const TickValues& values, const Topic& topic) {
  if (values.images == nullptr) return nullptr;
  for (const session::SlotImage& seen : *values.images) {
    const Answer* answer = answerOf(values, topic.slot);
    if (seen.slot != topic.slot || seen.camera != topic.camera || answer == nullptr) continue;
    const double time = static_cast<double>(seen.image.tick) * values.simulation_step;
    return shared(toMsg(seen.image, time, answer->action.vehicle_id, seen.camera));
  }
  return nullptr;
}

void takeDecision(const TakenMessage& taken, const TickReading&, Answer& answer) {
  const auto record = messageAs<msgs::DecisionRecord>(taken.message);
  for (const msgs::DecidedVehicle& vehicle : record->vehicles) {
    if (vehicle.slot == answer.action.slot && vehicle.vehicle_id == answer.action.vehicle_id)
      answer.drove = vehicle.answer_drove != 0;
  }
}

/// A user's own planner may leave out whom it drives and what it is called.
void takeControl(const TakenMessage& taken, const TickReading&, Answer& answer) {
  const auto control = messageAs<msgs::ControlAction>(taken.message);
  const int slot = answer.action.slot;
  const std::string vehicle_id = answer.action.vehicle_id;
  answer.action = fromMsg(*control);
  answer.action.slot = slot;
  answer.action.vehicle_id = vehicle_id;
  answer.action.fault = traffic::shownFaultText(control->fault);
  answer.planner = traffic::shownSource(control->planner);
  if (answer.planner.empty()) answer.planner = slot == kEgoSlot ? "ego:external" : "cbv:external";
  answer.latency_ms = control->planner_latency_ms;
  answer.fault = answer.action.fault;
}

void takeRollout(const TakenMessage& taken, const TickReading&, Answer& answer) {
  const auto rollout = messageAs<msgs::Rollout>(taken.message);
  answer.action.rollout = fromMsg(*rollout);
  answer.action.candidates = candidatesFromMsg(*rollout);
}

void takeGuidance(const TakenMessage& taken, const TickReading&, Answer& answer) {
  const auto report = messageAs<msgs::GuidanceReport>(taken.message);
  for (const msgs::VehicleGuidance& vehicle : report->vehicles) {
    if (vehicle.vehicle_id != answer.action.vehicle_id) continue;
    answer.action.guidance = fromMsg(vehicle);
    answer.action.state_mismatch = vehicle.state_mismatch;
  }
}

void takeImage(const TakenMessage& taken, const TickReading& reading, Answer& answer) {
  const Topic& topic = taken.topic;
  const ExpectedImage expected = expectedOf(topic, answer.action.vehicle_id, reading);
  try {
    const auto message = messageAs<sensor_msgs::Image>(taken.message);
    answer.images.push_back({topic.slot, fromMsg(*message, expected), topic.camera});
  } catch (const core::InputError&) {  // its planner has braked and said why
  }
}

AnyMessage deriveCameraInfo(const TickMessages& tick, const TickReading& reading,
                            const Topic& topic) {
  const auto image = tick.get<sensor_msgs::Image>(imageOf(topic.slot, topic.camera));
  const rendering::RigCamera* camera = reading.rigs.of(topic.slot).find(topic.camera);
  const bool there = image && camera != nullptr;
  return there ? shared(toCameraInfoMsg(*camera, image->header)) : AnyMessage();
}

AnyMessage deriveTransforms(const TickMessages& tick, const TickReading& reading, const Topic&) {
  const bool seen = tick.holds(ChannelId::kEgoImage) || tick.holds(ChannelId::kCbvImage);
  return shared(toTfMsg(snapshotOf(tick), seen ? &reading.rigs : nullptr));
}

AnyMessage deriveOdometry(const TickMessages& tick, const TickReading&, const Topic&) {
  const traffic::TrafficSnapshot snapshot = snapshotOf(tick);
  const traffic::Vehicle* ego = snapshot.ego();
  return ego == nullptr ? AnyMessage() : shared(toOdometryMsg(*ego, snapshot.time));
}

}  // namespace cdiff::node_graph
