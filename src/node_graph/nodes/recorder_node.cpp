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

/// Whether the metrics of a tick are here, too, or will never be. A metrics node that has once kept
/// the end of a session waiting is not waited for again before it reports.
bool RecorderNode::measured(const msgs::TrafficSnapshot& snapshot, bool superseded) {
  const bool final = snapshot.status != msgs::TrafficSnapshot::RUNNING;
  const bool reported = answers().has(ChannelId::kMetrics, snapshot.tick);
  if (reported) waiting_since_ = {};
  if (over() || reported || !graph().has(kMetricsNode) || (!snapshot.decision_tick && !final))
    return true;
  if (waiting_since_.isZero()) waiting_since_ = ros::SteadyTime::now();
  const bool may_be_lost = ended() || (superseded && graph().paced);
  return may_be_lost && (ros::SteadyTime::now() - waiting_since_).toSec() > kReportPatience;
}

bool RecorderNode::handle(const Snapshot& snapshot, bool superseded) {
  if (!complete(*snapshot, superseded)) return false;
  if (acknowledged_ != snapshot->tick) acknowledge(snapshot->tick);  // its report may follow
  acknowledged_ = snapshot->tick;
  if (!measured(*snapshot, superseded)) return false;
  TickMessages messages = answers().messages(snapshot->tick);
  messages.add(ChannelId::kTraffic, snapshot);
  if (!queue_) queue_ = std::make_unique<BagQueue>(*bag_);
  queue_->write(messages);
  forgetUntil(snapshot->tick);
  return true;
}

void RecorderNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const BagQueue::Load load = queue_ ? queue_->load() : BagQueue::Load();
  status.add("ticks written", load.written);
  status.add("ticks that wait for the disk", load.waiting);
  status.add("most ticks that waited for the disk", load.most_waiting);
  status.add("ticks that found the queue full", load.full);
}

int RecorderNode::conclude(Ending ending) {
  if (queue_) queue_->finish();
  bag_->finish();
  const bool lost = ending == Ending::kSimulatorGone || ending == Ending::kSimulatorSilent;
  return lost ? core::ExitCode::kRunTimeError : core::ExitCode::kPassed;
}

}  // namespace cdiff::node_graph
