// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/planning/planner.h"
#include "node_graph/messages/topics.h"
#include "sensor_msgs/Image.h"
#include "session/session_observer.h"
#include "session/vehicle_rigs.h"

namespace cdiff::node_graph {

// What a planner answers for one vehicle at one decision.

/// A planner's answer for one vehicle at one decision.
struct Answer {
  planning::PlannedAction action;
  std::string planner;                     ///< "ego:NAME" or "cbv:NAME"
  double latency_ms = 0.0;                 ///< wall time of the planning call [ms]
  std::string fault;                       ///< empty when none
  bool drove = true;                       ///< false where it came too late to drive
  std::vector<session::SlotImage> images;  ///< what the vehicle saw, as far as it came
};

/// The actions of answers that drove.
std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers);
/// One latency per planning call: all CBVs share theirs. Planners that report none have none.
std::vector<session::PlannerLatency> latenciesOf(const std::vector<Answer>& answers);
/// What the vehicles saw, in the order of the answers.
std::vector<session::SlotImage> imagesOf(const std::vector<Answer>& answers);

/// The messages of one tick by topic, whoever they come from: nodes, a bag, or the values of a
/// session that one process drives.
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

/// The values from which the messages of one tick are built.
struct TickValues {
  const traffic::TrafficSnapshot& snapshot;
  const map::RoadNetwork* network = nullptr;     ///< that the lanes of the selection are of
  double simulation_step = 0.0;                  ///< [s]
  bool cbvs_guided = false;                      ///< the CBVs' planner follows objectives
  double image_age = 0.0;                        ///< as in GuidanceReport [s]
  std::vector<Answer> answers = {};              ///< the planners' answers; ego first, then slots
  const cbv::CbvSelection* selection = nullptr;  ///< may be nullptr
  const std::vector<session::SlotImage>* images = nullptr;  ///< may be nullptr
};

/// What it takes to read messages.
struct TickReading {
  session::VehicleRigs rigs;      ///< cameras whose images are expected
  double simulation_step = 0.05;  ///< [s]
};

/// The message of a topic, made of a tick's values; nullptr where they hold none.
AnyMessage makeMessage(const Topic& topic, const TickValues& values);
/// The messages of all channels that are made of a tick's values.
TickMessages makeMessages(const TickValues& values, int max_cbv, const session::VehicleRigs& rigs);

/// The answer of a planner for a vehicle as far as it is among the messages of the tick; nullopt
/// when there is no control for it.
std::optional<Answer> readAnswer(const TickMessages& tick, int slot, const std::string& vehicle_id,
                                 const TickReading& reading);

/// Collects what the other nodes answer to a tick, whatever the order of arrival, and says what is
/// still missing. Traffic simulator, metrics and recorder wait by the same rule: a decision is
/// complete when every message has arrived that the table of channels requires of what they listen
/// to.
class TickAnswers {
 public:
  using Selection = ::e2e_cdiff::CbvSelection::ConstPtr;
  using Control = ::e2e_cdiff::ControlAction::ConstPtr;
  using Rollout = ::e2e_cdiff::Rollout::ConstPtr;
  using Image = sensor_msgs::Image::ConstPtr;
  using Decision = ::e2e_cdiff::DecisionRecord::ConstPtr;

  /// Waits for selection and controls; `simulation_step` [s] turns a stamp without tick into one.
  explicit TickAnswers(double simulation_step = 0.05);
  /// `awaited`: channels that a decision needs; `rigs` say which images, and what they must be
  /// like.
  TickAnswers(double simulation_step, ChannelSet awaited, const session::VehicleRigs& rigs = {});

  /// Keeps a message for the tick that it is of; one that carries a stamp but no tick counts for
  /// the tick of its stamp, one with neither for `otherwise`. The first of a tick and topic counts.
  /// From a decision's record on, the answers to the decision are those that it names. Returns the
  /// tick.
  std::uint64_t add(const Topic& topic, const AnyMessage& message, std::uint64_t otherwise = 0);

  /// What `snapshot` still needs. Once its decision's record is here, what that names. Empty at
  /// ticks without decision.
  std::vector<Topic> missing(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// What has arrived for a tick; of a decision with a record what that names.
  TickMessages messages(std::uint64_t tick) const;
  /// One of them; nullptr where there is none.
  Selection selection(std::uint64_t tick) const;
  Decision decision(std::uint64_t tick) const {
    return get<::e2e_cdiff::DecisionRecord>(ChannelId::kDecisionRecord, tick);
  }
  /// `slot`: kEgoSlot for the ego.
  Control control(int slot, std::uint64_t tick) const {
    return get<::e2e_cdiff::ControlAction>(controlOf(slot), tick);
  }
  Rollout rollout(int slot, std::uint64_t tick) const {
    return get<::e2e_cdiff::Rollout>({ChannelId::kCbvRollout, slot}, tick);
  }
  /// Of the front camera.
  Image image(int slot, std::uint64_t tick) const {
    return get<sensor_msgs::Image>(imageOf(slot), tick);
  }
  /// Whether a message of a topic has arrived for a tick.
  bool has(const Topic& topic, std::uint64_t tick) const { return find(topic, tick) != nullptr; }
  /// Answers of planners to a decision: the ego's, then those of assigned CBVs by slot; those that
  /// are missing are left out.
  std::vector<Answer> answers(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// A control and the tick that it answers.
  struct TimedControl {
    std::uint64_t tick = 0;
    Control control;
  };
  /// The newest control of a slot (-1: ego) for that vehicle, up to `tick`; without control when
  /// there is none.
  TimedControl newest(int slot, const std::string& vehicle_id, std::uint64_t tick) const;
  /// The first control of a slot for ticks from `begin` to before `end`.
  TimedControl within(int slot, std::uint64_t begin, std::uint64_t end) const;
  /// Whether the planner of a slot has answered for a tick from `begin` on; all CBVs share one.
  bool answeredFrom(int slot, std::uint64_t begin) const;
  /// The oldest selection of all, or after a tick; nullptr when there is none.
  Selection firstSelection() const { return selectionFrom(0); }
  Selection selectionAfter(std::uint64_t tick) const { return selectionFrom(tick + 1); }
  /// Drops everything older than a tick.
  void forgetBefore(std::uint64_t tick);

 private:
  template <class Message>
  boost::shared_ptr<const Message> get(const Topic& topic, std::uint64_t tick) const {
    requireType(topic.id, typeid(Message));
    return messageAs<Message>(find(topic, tick));
  }
  AnyMessage find(const Topic& topic, std::uint64_t tick) const;
  Selection selectionFrom(std::uint64_t tick) const;
  std::vector<Topic> missingOf(int slot, std::uint64_t tick, bool with_fault = false) const;
  std::vector<Topic> missingOf(const ::e2e_cdiff::DecisionRecord& record) const;
  std::vector<Topic> missingOfSession(Need need, std::uint64_t tick) const;

  ChannelSet awaited_;
  TickReading reading_;
  std::map<std::uint64_t, TickMessages> ticks_;
};

/// Whether a snapshot holds a vehicle.
bool contains(const ::e2e_cdiff::TrafficSnapshot& snapshot, const std::string& vehicle_id);

}  // namespace cdiff::node_graph
