// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "bag_session.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/ros/session_bag.h"
#include "e2e_cdiff/ros/topics.h"
#include "e2e_cdiff/scenario/world.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"
#include "sensor_msgs/Image.h"

namespace cdiff::ros {
namespace {

using core::InputError;
using rosbag::MessageInstance;

/// Slot of a topic made by `topicOf`, the ego's included; nullopt when it is no such topic.
template <class TopicOf>
std::optional<int> slotOf(const std::string& topic, int slots, TopicOf topicOf) {
  for (int slot = -1; slot < slots; ++slot) {
    if (topic == topicOf(slot)) return slot;
  }
  return std::nullopt;
}

std::string controlTopic(int slot) { return slot < 0 ? kEgoControlTopic : cbvControlTopic(slot); }

traffic::CameraImage toImage(const sensor_msgs::Image& message, std::uint64_t tick) {
  const std::size_t size = std::size_t{3} * message.width * message.height;
  if (message.encoding != "rgb8" || message.step != 3 * message.width ||
      message.data.size() != size) {
    throw InputError("an image of tick " + std::to_string(tick) + " is '" + message.encoding +
                     "' with " + std::to_string(message.data.size()) +
                     " bytes; expected rgb8 with " + std::to_string(size));
  }
  traffic::CameraImage image;
  image.width = static_cast<int>(message.width);
  image.height = static_cast<int>(message.height);
  image.tick = tick;
  image.rgb = message.data;
  return image;
}

class Reader {
 public:
  explicit Reader(const rosbag::Bag& bag) : view_(bag) {}

  BagSession read() {
    readInfo();
    for (const MessageInstance& message : view_) {
      const std::string& topic = message.getTopic();
      if (topic.compare(0, prefix_.size(), prefix_) == 0)
        take(topic.substr(prefix_.size()), message);
    }
    finish();
    return std::move(session_);
  }

 private:
  void readInfo() {
    for (const rosbag::ConnectionInfo* connection : view_.getConnections()) {
      if (connection->datatype != "e2e_cdiff/SessionInfo") continue;
      const std::string& topic = connection->topic;
      prefix_ = topic.substr(0, topic.size() - std::string(kSessionTopic).size());
      for (const MessageInstance& message : view_) {
        const auto info = message.instantiate<msgs::SessionInfo>();
        if (info == nullptr) continue;
        const scenario::ScenarioOptions options = optionsFromMsg(*info);
        session_.setup = std::make_unique<scenario::SessionSetup>(options, importFromMsg(*info),
                                                                  routeFromMsg(*info));
        session_.name = options.name + "_seed" + std::to_string(options.seed);
        slots_ = static_cast<int>(options.max_cbv);
        return;
      }
    }
    throw InputError("it holds no session (a message of type e2e_cdiff/SessionInfo)");
  }

  void take(const std::string& topic, const MessageInstance& message) {
    if (topic == kTrafficTopic) return takeTraffic(*message.instantiate<msgs::TrafficSnapshot>());
    if (topic == kSelectionTopic) return takeSelection(*message.instantiate<msgs::CbvSelection>());
    if (slotOf(topic, slots_, controlTopic))
      return takeControl(*message.instantiate<msgs::ControlAction>());
    const auto slot = slotOf(topic, slots_, imageTopic);
    if (!slot) return;
    const auto image = message.instantiate<sensor_msgs::Image>();
    if (image == nullptr) throw InputError("topic '" + topic + "' holds no sensor_msgs/Image");
    const double step = session_.setup->options().simulation_step;
    const double tick = std::round(image->header.stamp.toSec() / step);
    session_.images.push_back({*slot, toImage(*image, static_cast<std::uint64_t>(tick))});
  }

  void takeTraffic(const msgs::TrafficSnapshot& message) {
    traffic::TrafficSnapshot snapshot = fromMsg(message);
    for (const traffic::Contact& contact : snapshot.contacts) {
      session_.contacts[contact.first].push_back(snapshot.tick);
      session_.contacts[contact.second].push_back(snapshot.tick);
    }
    session_.seconds = std::max(session_.seconds, snapshot.time);
    if (snapshot.decision_tick) session_.decisions.push_back(std::move(snapshot));
  }

  void takeSelection(const msgs::CbvSelection& message) {
    for (const msgs::CbvAssignment& assignment : message.assignments) {
      const DriveKey key{assignment.vehicle_id, assignment.selected_tick};
      session_.drives[message.tick][assignment.slot] = key;
      if (session_.routes.count(key) != 0) continue;
      msgs::CbvSelection one;
      one.assignments.push_back(assignment);
      session_.routes[key] =
          fromMsg(one, session_.setup->network()).assignments.front().conflict_aware_route;
    }
  }

  void takeControl(const msgs::ControlAction& message) {
    const std::string mark = kNoiseMark;
    const std::string& planner = message.planner;
    const bool noisy = planner.size() >= mark.size() &&
                       planner.compare(planner.size() - mark.size(), mark.size(), mark) == 0;
    if (noisy || !message.fault.empty())
      session_.disturbed.insert({message.vehicle_id, message.tick});
  }

  void finish() {
    const scenario::ScenarioOptions& options = session_.setup->options();
    if (std::abs(options.decision_period - kDecisionPeriod) > 1e-9) {
      throw InputError("its decisions are " + core::formatNumber(options.decision_period) +
                       " s apart; samples need 0.1 s");
    }
    if (session_.images.empty()) throw InputError("it holds no camera images");
    const DriveKey ego{scenario::kEgoId, 0};
    session_.routes[ego] = session_.setup->egoRoute();
    for (const traffic::TrafficSnapshot& snapshot : session_.decisions)
      session_.drives[snapshot.tick][-1] = ego;
    std::sort(session_.decisions.begin(), session_.decisions.end(),
              [](const auto& left, const auto& right) { return left.tick < right.tick; });
    std::sort(session_.images.begin(), session_.images.end(),
              [](const BagImage& left, const BagImage& right) {
                return std::pair(left.image.tick, left.slot) <
                       std::pair(right.image.tick, right.slot);
              });
  }

  static constexpr double kDecisionPeriod = 0.1;  ///< of a rollout [s]
  rosbag::View view_;
  std::string prefix_;
  int slots_ = 0;
  BagSession session_;
};

}  // namespace

BagSession readBagSession(const std::filesystem::path& file) {
  try {
    rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
    return Reader(bag).read();
  } catch (const std::exception& error) {
    throw InputError("bag '" + file.string() + "': " + error.what());
  }
}

}  // namespace cdiff::ros
