// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a pacer needs, without a ROS master: the hand-made session of record/sample_session.h, and
/// lists of what the pacer puts out.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "node_graph/lockstep/pacer.h"
#include "node_graph/messages/traffic_conversions.h"
#include "record/sample_session.h"

namespace cdiff::test {

/// ros::ok() is true from now on.
inline void initRos() {
  if (!ros::isInitialized())
    ros::init(ros::M_string(), "test",
              ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
}

inline ::e2e_cdiff::TickAck ackOf(const std::string& node, std::uint8_t kind,
                                  std::uint64_t tick = 0) {
  ::e2e_cdiff::TickAck ack;
  ack.node = node;
  ack.kind = kind;
  ack.tick = tick;
  return ack;
}

class PacerFixture : public ::testing::Test {
 protected:
  PacerFixture() { initRos(); }

  template <class Pacer>
  Pacer& make(const session::ScenarioOptions& options) {
    sample_ = std::make_unique<SampleSetup>(options);
    node_graph::PacerOutput output;
    output.fault = [this](const auto& source, const auto& text) {
      faults_.push_back(source + ": " + text);
    };
    output.record = [this](const auto& record) { records_.push_back(record->tick); };
    output.keep = [this](const auto& snapshot, const auto&) { kept_.push_back(snapshot->tick); };
    output.publish_again = [this](const auto& snapshot) { again_.push_back(snapshot->tick); };
    const node_graph::PacedSession session{sample_->setup, graph_, participants_, watch_, limit_};
    auto pacer = std::make_unique<Pacer>(session, output);
    Pacer& made = *pacer;
    pacer_ = std::move(pacer);
    return made;
  }

  static node_graph::Pacer::Snapshot snapshotAt(std::uint64_t tick) {
    return node_graph::shared(node_graph::toMsg(sampleSnapshot(tick)));
  }
  void select(std::uint64_t tick) {
    ::e2e_cdiff::CbvSelection selection;
    selection.tick = tick;
    pacer_->take(node_graph::ChannelId::kSelection, node_graph::shared(selection));
  }
  void control(std::uint64_t tick, int slot, const std::string& vehicle, double throttle) {
    ::e2e_cdiff::ControlAction action;
    action.tick = tick;
    action.slot = slot;
    action.vehicle_id = vehicle;
    action.throttle = throttle;
    action.planner = slot < 0 ? "ego:sample" : "cbv:sample";
    pacer_->take(node_graph::controlOf(slot), node_graph::shared(action));
  }
  void acknowledge(std::uint64_t tick) {
    participants_.note(ackOf(node_graph::kMetricsNode, ::e2e_cdiff::TickAck::ACKNOWLEDGED, tick));
  }

  double limit_ = 0.1;  ///< for answers [s]
  node_graph::SessionGraph graph_{{node_graph::kMetricsNode}, 1};
  node_graph::StopSignal stop_;
  node_graph::ParticipantTracker participants_{{node_graph::kMetricsNode}};
  node_graph::Connections connections_;
  node_graph::SessionWatch watch_{stop_, participants_, connections_};
  std::unique_ptr<SampleSetup> sample_;
  std::unique_ptr<node_graph::Pacer> pacer_;
  std::vector<std::string> faults_;
  std::vector<std::uint64_t> records_;
  std::vector<std::uint64_t> kept_;
  std::vector<std::uint64_t> again_;
};

}  // namespace cdiff::test
