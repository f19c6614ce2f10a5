// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/metrics_node.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "core/markup.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/replay.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/map_markers.h"
#include "node_graph/messages/slot_figures.h"
#include "node_graph/node_main.h"
#include "node_graph/nodes/service_link.h"
#include "node_graph/result_reserve.h"
#include "node_graph/session_files.h"
#include "node_graph/session_graph.h"
#include "record/session_text.h"
#include "std_msgs/Float64.h"

namespace cdiff::node_graph {
namespace {

/// A simulator that is stopped while it starts keeps the result folder to itself.
void endStoppedSimulator() {
  constexpr double kPatience = 1.0;  // [s] until the process is gone
  const auto begin = std::chrono::steady_clock::now();
  killLaunchedProcess(kTrafficSimulatorNode);
  while (launchedProcess(kTrafficSimulatorNode) && secondsSince(begin) < kPatience)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

/// The row of the bag, which the recorder completes at the same time: it waits for it a little.
std::string bagRow(const SessionGraph& graph, const std::filesystem::path& results) {
  constexpr double kPatience = 2.0;  // [s] of wall time
  const std::filesystem::path bag = results / "session.bag";
  const ros::SteadyTime begin = ros::SteadyTime::now();
  std::string row = record::fileRow("bag", bag);
  while (row.empty() && graph.has(kRecorderNode) &&
         (ros::SteadyTime::now() - begin).toSec() < kPatience) {
    ros::WallDuration(0.02).sleep();
    row = record::fileRow("bag", bag);
  }
  return row;
}

/// Of the live page; 0: any that is free.
std::uint16_t portOf(const Parameters& parameters) {
  constexpr double kLargestPort = 65535.0;
  const std::string text = parameters.text("watch_port");
  if (text.empty()) return 0;
  const auto port = core::parseNumber(text);
  if (port && *port >= 0.0 && *port <= kLargestPort && *port == std::floor(*port))
    return static_cast<std::uint16_t>(*port);
  throw core::InputError("watch_port '" + core::shortened(text) +
                         "'; expected a whole number in [0, 65535], 0 for any port that is free");
}

/// The end of a session whose last snapshot never came.
traffic::TrafficSnapshot unpublishedEnd(const traffic::TrafficSnapshot& last, double step,
                                        Ending ending, double timeout) {
  if (ending == Ending::kStopped) {
    return endedAfter(last, step, traffic::SessionStatus::kInterrupted,
                      {0, kTrafficSimulatorNode, "interrupted; no last snapshot came"});
  }
  return endedAfter(last, step, traffic::SessionStatus::kError,
                    {0, kTrafficSimulatorNode, simulatorFault(ending, timeout)});
}

}  // namespace

void MetricsNode::startSession(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  const bool deterministic = setup_->options().real_time_factor == 0.0;
  results_ = info.results_folder;
  writer_ = std::make_unique<page::ResultWriter>(*setup_, factsOf(info, deterministic), results_);
  if (setup_->options().video) {
    video_ = std::make_unique<video::SessionVideo>(*setup_, results_);
  }
  reporter_ =
      std::make_unique<MetricReporter>(setup_->options(), [this] { return writer_->measures(); });
  reports_ = advertise<msgs::MetricReport>(ChannelId::kMetrics);
  marker_output_ = advertise<visualization_msgs::MarkerArray>(ChannelId::kMarkers);
  map_output_ = advertise<visualization_msgs::MarkerArray>(ChannelId::kMapMarkers);
  view_output_ = advertise<sensor_msgs::Image>(ChannelId::kFrontView);
  markers_ = std::make_unique<SessionMarkers>(*setup_);
  advertiseFigures();
  openPage();
  listenToAnswers(Party::kMetrics, setup_->options());
}

/// Serves the live page, if it is wanted: the session begins when it is open.
void MetricsNode::openPage() {
  const Parameters parameters = Parameters::ofThisNode();
  if (!parameters.flag("watch", false)) return;
  const session::ScenarioOptions& options = setup_->options();
  try {
    live_ = std::make_unique<watch::LiveSession>(
        *setup_, std::make_unique<ServiceLink>(options.at_most), portOf(parameters));
  } catch (const core::InputError& error) {
    ROS_ERROR("%s; the session runs without its page", core::plainText(error.what()).c_str());
    return;
  }
  std::cout << live_->invitation() << std::flush;  // no log may have it
  live_->begin(*writer_);
}

void MetricsNode::advertiseFigures() {
  for (const ChannelId id : {ChannelId::kCbvTtc, ChannelId::kCbvGap, ChannelId::kCbvScore}) {
    for (const Topic& topic : topicsOf(channel(id), graph()))
      figures_[topic] = advertise<std_msgs::Float64>(topic);
  }
}

bool MetricsNode::handle(const Snapshot& message, bool superseded) {
  if (!complete(*message, superseded)) return false;
  acknowledge(message->tick);  // the next tick is made while this one is measured
  if (!begin_) begin_ = Clock::now();
  const TickRecordView tick(*message, answers(), setup_->network());
  writer_->observe(tick.record());
  if (live_) live_->observe(tick.record());
  if (video_) video_->observe(tick.record());
  note(tick.record().latencies);
  if (const auto report = reporter_->report(tick.snapshot(), writer_->tickMeasures()))
    reports_.publish(report);
  show(tick.record());
  forgetUntil(message->tick);
  last_ = tick.snapshot();
  return true;
}

void MetricsNode::note(const std::vector<session::PlannerLatency>& latencies) {
  for (const session::PlannerLatency& latency : latencies) {
    if (latency.milliseconds <= slowest_planner_ms_) continue;
    slowest_planner_ms_ = latency.milliseconds;
    slowest_planner_ = latency.planner;
  }
}

void MetricsNode::show(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  const bool final = snapshot.status != traffic::SessionStatus::kRunning;
  markers_->note(snapshot);
  if (!snapshot.decision_tick && !final) return;
  showInRviz(record);
  if (record.selection != nullptr) {
    for (const SlotFigure& figure : slotFigures(snapshot, *record.selection)) {
      std_msgs::Float64 number;
      number.data = figure.value;
      figures_.at(figure.topic).publish(number);
    }
  }
}

/// What nobody subscribes to is not made.
void MetricsNode::showInRviz(const session::TickRecord& record) {
  if (marker_output_.getNumSubscribers() > 0) marker_output_.publish(markers_->build(record));
  if (!map_shown_ && map_output_.getNumSubscribers() > 0) {
    map_output_.publish(mapMarkers(*setup_));
    map_shown_ = true;
  }
  if (view_output_.getNumSubscribers() == 0) return;
  if (!front_view_) front_view_ = std::make_unique<FrontView>(*setup_);
  view_output_.publish(front_view_->draw(*record.snapshot, record.actions));
}

void MetricsNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const double wall = wallSeconds();
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, traffic::toText(last_.status));
  status.add("simulated seconds", core::formatFixed(last_.time, 2));
  status.add("real-time factor", core::formatFixed(wall > 0.0 ? last_.time / wall : 0.0, 2));
  status.add("vehicles", last_.vehicles.size());
  if (reporter_) {
    for (const auto& [name, value] : metricDiagnostics(reporter_->session()))
      status.add(name, value);
  }
  status.add("slowest planner", slowest_planner_);
  status.add("slowest planning call [ms]", core::formatFixed(slowest_planner_ms_, 2));
}

double MetricsNode::wallSeconds() const {
  return begin_ ? std::chrono::duration<double>(Clock::now() - *begin_).count() : 0.0;
}

int MetricsNode::conclude(Ending ending) {
  if (ending != Ending::kFinalSnapshot) {
    const traffic::TrafficSnapshot snapshot =
        unpublishedEnd(last_, setup_->options().simulation_step, ending, heartbeatTimeout());
    session::TickRecord record;
    record.snapshot = &snapshot;
    writer_->observe(record);
    if (live_) live_->observe(record);
    if (video_) video_->observe(record);
  }
  writer_->finish(wallSeconds());
  const int exit_code = finishVideo(writer_->exitCode());
  const std::filesystem::path results = writer_->folder();
  std::cout << writer_->table() << bagRow(graph(), results)
            << record::fileRow("video", results / video::kVideoFile) << std::flush;
  writeExitCode(results, exit_code);
  if (ending != Ending::kFinalSnapshot && ending != Ending::kStopped) removeReserveOf(results);
  if (live_) live_->finish();
  return exit_code;
}

int MetricsNode::concludeUnstarted(Ending ending) {
  Parameters parameters = Parameters::ofNode(kTrafficSimulatorNode);
  if (!parameters.empty() && takeRefusal()) return core::ExitCode::kBadInput;
  if (parameters.empty()) parameters = launchParameters();
  if (parameters.empty()) return core::ExitCode::kRunTimeError;
  if (ending == Ending::kSimulatorSilent) endStoppedSimulator();
  traffic::Fault fault{0, kTrafficSimulatorNode,
                       simulatorFault(ending, heartbeatTimeout()) + " before the session began"};
  if (!masterAnswers()) fault = {0, "rosmaster", kNoMaster};  // roslaunch ends all nodes then
  return writeUnstartedResult(parameters, traffic::SessionStatus::kError, fault);
}

int MetricsNode::runWithoutMaster() {
  const Parameters parameters = launchParameters();
  if (parameters.empty()) return core::ExitCode::kRunTimeError;
  return writeUnstartedResult(parameters, traffic::SessionStatus::kError,
                              {0, "rosmaster", kNoMaster});
}

int MetricsNode::finishVideo(int exit_code) {
  if (!video_) return exit_code;
  video_->finish(writer_->result());
  if (video_->error().empty()) return exit_code;
  ROS_ERROR("%s; the other results are not affected", core::plainText(video_->error()).c_str());
  return std::max(exit_code, core::ExitCode::kRunTimeError);
}

}  // namespace cdiff::node_graph
