// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The messages of one tick by topic, whoever they come from: nodes, a bag, or the values of a
/// session that one process drives.
#pragma once

#include <map>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "ros/tick_answer.h"
#include "ros/topics.h"

namespace cdiff::ros {

class TickMessages {
 public:
  /// The first message of a topic counts.
  void add(const Topic& topic, const AnyMessage& message) { messages_.emplace(topic, message); }
  void remove(const Topic& topic) { messages_.erase(topic); }
  /// nullptr when there is none.
  AnyMessage find(const Topic& topic) const;
  /// Throws std::logic_error unless the topic's messages are of that type.
  template <class Message>
  boost::shared_ptr<const Message> get(const Topic& topic) const {
    requireType(topic.id, typeid(Message));
    return messageAs<Message>(find(topic));
  }
  /// Whether there is a message on any topic of a channel.
  bool holds(ChannelId id) const;

 private:
  std::map<Topic, AnyMessage> messages_;
};

/// What the messages of a tick are made of.
struct TickValues {
  const traffic::TrafficSnapshot& snapshot;
  const map::RoadNetwork* network = nullptr;     ///< that the lanes of the selection are of
  double simulation_step = 0.0;                  ///< [s]
  bool cbvs_guided = false;                      ///< the CBVs' planner follows objectives
  double image_age = 0.0;                        ///< as in GuidanceReport [s]
  std::vector<Answer> answers = {};              ///< of planners; ego first, then slots
  const cbv::CbvSelection* selection = nullptr;  ///< may be nullptr
  const std::vector<session::SlotImage>* images = nullptr;  ///< may be nullptr
};

/// What it takes to read messages.
struct TickReading {
  rendering::CameraOptions camera;  ///< that images must be of
  double simulation_step = 0.05;    ///< [s]
};

/// The message of a topic, made of a tick's values; nullptr where they hold none.
AnyMessage makeMessage(const Topic& topic, const TickValues& values);
/// The messages of all channels that are made of a tick's values.
TickMessages makeMessages(const TickValues& values, int max_cbv);

/// The answer of a planner for a vehicle as far as messages of the tick speak of it; nullopt where
/// there is no control for it.
std::optional<Answer> readAnswer(const TickMessages& tick, int slot, const std::string& vehicle_id,
                                 const TickReading& reading);

}  // namespace cdiff::ros
