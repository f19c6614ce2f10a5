// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/recorder_node.h"

#include "core/program.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

constexpr double kReportPatience =
    2.0;  // [s] of wall time for the last report, which a dead metrics node never sends

std::string resolvedTopic(const std::string& topic) { return ros::names::resolve(topic); }

}  // namespace

void RecorderNode::startSession(const msgs::SessionInfo& info) {
  const session::ScenarioOptions options = optionsFromMsg(info);
  bag_ = std::make_unique<BagFile>(std::filesystem::path(info.results_folder) / "session.bag",
                                   options, resolvedTopic);
  bag_->write(info);
  listen<nav_msgs::Path>(ChannelId::kEgoRoute, [this](const nav_msgs::Path::ConstPtr& path) {
    if (!has_route_) bag_->write(*path);
    has_route_ = true;
  });
  listenToAnswers(Party::kRecorder, options);
}

std::string RecorderNode::waitingFor() const {
  return has_route_ ? "" : "no ego route has come yet";
}

/// Whether the metrics of a tick are here, too.
bool RecorderNode::measured(const msgs::TrafficSnapshot& snapshot, bool superseded) {
  if (over()) return true;
  const bool final = snapshot.status != msgs::TrafficSnapshot::RUNNING;
  if (!graph().has(kMetricsNode) || (!snapshot.decision_tick && !final) ||
      answers().has(ChannelId::kMetrics, snapshot.tick))
    return true;
  if (waiting_since_.isZero()) waiting_since_ = ros::SteadyTime::now();
  return (final || superseded) &&
         (ros::SteadyTime::now() - waiting_since_).toSec() > kReportPatience;
}

bool RecorderNode::handle(const Snapshot& snapshot, bool superseded) {
  if (!complete(*snapshot, superseded)) return false;
  if (acknowledged_ != snapshot->tick) acknowledge(snapshot->tick);  // its report may follow
  acknowledged_ = snapshot->tick;
  if (!measured(*snapshot, superseded)) return false;
  TickMessages messages = answers().messages(snapshot->tick);
  messages.add(ChannelId::kTraffic, snapshot);
  bag_->write(messages);
  ++written_;
  forgetUntil(snapshot->tick);
  waiting_since_ = {};
  return true;
}

void RecorderNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.add("ticks written", written_);
}

int RecorderNode::conclude(Ending ending) {
  bag_->finish();
  const bool lost = ending == Ending::kSimulatorGone || ending == Ending::kSimulatorSilent;
  return lost ? core::ExitCode::kRunTimeError : core::ExitCode::kPassed;
}

}  // namespace cdiff::node_graph
