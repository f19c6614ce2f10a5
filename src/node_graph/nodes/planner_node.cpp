// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/planner_node.h"

#include <algorithm>

#include "core/text.h"
#include "metrics/formulas/quantiles.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/plan_markers.h"
#include "node_graph/session_graph.h"
#include "session/closed_loop.h"

namespace cdiff::node_graph {

void PlannerStatistics::observe(const PlannerDecision& decision) {
  const auto count = [this](const char* kind, std::size_t vehicles) {
    if (vehicles > 0) faults_[kind] += vehicles;
  };
  const auto unseeing = static_cast<std::size_t>(decision.missing + decision.refused);
  std::size_t fail_safe = 0;
  for (const planning::PlannedAction& action : decision.actions) fail_safe += !action.fault.empty();
  batch_size_ = decision.actions.size() - unseeing;
  image_age_ = decision.image_age;
  count("image missing", static_cast<std::size_t>(decision.missing));
  count("image refused", static_cast<std::size_t>(decision.refused));
  count("vehicle", fail_safe - unseeing);
  if (!decision.fault.empty()) count("planning call", batch_size_);
  if (batch_size_ == 0) return;
  ++decisions_;
  latencies_ms_.push_back(decision.latency_ms);
  if (decision.latency_ms > 1000.0 * decision_period_) ++deadline_misses_;
}

void PlannerStatistics::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  std::uint64_t all = 0;
  for (const auto& [kind, vehicles] : faults_) {
    status.add("faults: " + kind, vehicles);
    all += vehicles;
  }
  status.summary(all == 0 ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                 all == 0 ? "planning" : std::to_string(all) + " fail-safe actions");
  std::vector<double> sorted(latencies_ms_.begin(), latencies_ms_.end());
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty()) {
    for (const auto& [name, share] : {std::pair{"p50", 0.5}, {"p95", 0.95}}) {
      const double value = metrics::quantileOf(sorted, share, metrics::QuantileRule::kNearestRank);
      status.add(std::string("latency ") + name + " [ms]", core::formatFixed(value, 2));
    }
  }
  status.add("decisions", decisions_);
  status.add("deadline misses", deadline_misses_);
  status.add("batch size", batch_size_);
  status.add("image age [s]", core::formatFixed(image_age_, 3));
}

namespace {

void warnOf(const std::string& planner, const PlannerDecision& decision) {
  if (!decision.fault.empty()) ROS_WARN("%s: %s", planner.c_str(), decision.fault.c_str());
  for (const planning::PlannedAction& action : decision.actions) {
    if (action.fault.empty()) continue;
    ROS_WARN("%s: %s: %s", planner.c_str(), action.vehicle_id.c_str(), action.fault.c_str());
  }
}

std::vector<Answer> answersOf(const std::string& planner, const PlannerDecision& decision) {
  std::vector<Answer> answers;
  for (const planning::PlannedAction& action : decision.actions)
    answers.push_back({action, planner, decision.latency_ms, decision.fault, true, {}});
  return answers;
}

}  // namespace

void SeeingParticipant::listenToImages(int slot) {
  for (const std::string& camera : images().rigs().of(slot).names()) {
    listen<sensor_msgs::Image>(imageOf(slot, camera), [this, slot, camera](const auto& image) {
      images_.add(slot, image, camera);
    });
  }
}

void EgoPlannerNode::startSession(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  planner_ = setup_->makeEgoPlanner();
  statistics_ = PlannerStatistics(setup_->options().decision_period);
  images() = ImageInbox(setup_->rigs(), setup_->options().simulation_step);
  controls_ = advertise<msgs::ControlAction>(ChannelId::kEgoControl);
  markers_ = advertise<visualization_msgs::MarkerArray>(ChannelId::kPerceptionMarkers);
  listen<nav_msgs::Path>(ChannelId::kEgoRoute, [this](const nav_msgs::PathConstPtr& path) {
    if (route_.empty() && !path->poses.empty())
      route_ = map::matchRoute(setup_->network(), fromMsg(*path));
  });
  if (!graph().ego_sees) return;
  listenToImages(kEgoSlot);
}

std::string EgoPlannerNode::waitingFor() const {
  return route_.empty() ? "no ego route has come yet" : "";
}

bool EgoPlannerNode::ready(const msgs::TrafficSnapshot& snapshot) const {
  return !graph().ego_sees || images().complete(kEgoSlot, snapshot.tick);
}

bool EgoPlannerNode::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const bool blind = !ready(*message);
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  const auto tasks = session::egoTasks(snapshot, route_, setup_->options().target_speed);
  if (tasks.empty()) return true;
  if (blind && !superseded) return false;
  const std::string name = "ego:" + setup_->options().ego_planner;
  const PlannerDecision decision = graph().ego_sees
                                       ? planSeeing(*planner_, snapshot, tasks, images())
                                       : planBlind(*planner_, snapshot, tasks);
  statistics_.observe(decision);
  controls_.publish(shared(
      toMsg(decision.actions.front(), snapshot, {name, decision.latency_ms, decision.fault})));
  if (markers_.getNumSubscribers() > 0) show(snapshot, decision);
  warnOf(name, decision);
  images().forgetBefore(message->tick);
  return true;
}

void EgoPlannerNode::show(const traffic::TrafficSnapshot& snapshot,
                          const PlannerDecision& decision) {
  const traffic::Vehicle* ego = snapshot.ego();
  const double elevation = ego == nullptr ? 0.0 : ego->state.elevation;
  auto array = perceptionMarkers(decision.actions.front().perception, elevation, snapshot.time);
  appendMarkers(array.markers, planMarkers(decision.actions, snapshot).markers);
  markers_.publish(array);
}

void CbvPlannerNode::startSession(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  const session::ScenarioOptions& options = setup_->options();
  planner_ = setup_->makeCbvPlanner();
  steered_ = std::make_unique<session::SteeredCbvs>(options);
  images() = ImageInbox(setup_->rigs(), options.simulation_step);
  statistics_ = PlannerStatistics(options.decision_period);
  for (const Channel& row : channels()) {
    const bool ours = row.publisher == Party::kCbvPlanner && row.make != nullptr;
    if (!ours || !row.published.holds(graph())) continue;
    for (const Topic& topic : topicsOf(row, graph())) answers_[topic] = advertise(topic);
  }
  markers_ = advertise<visualization_msgs::MarkerArray>(ChannelId::kRolloutMarkers);
  listenToInputs();
}

void CbvPlannerNode::listenToInputs() {
  listen<msgs::CbvSelection>(ChannelId::kSelection, [this](const auto& selection) {
    const std::string wrong = unusable(*selection, graph().max_cbv);
    if (wrong.empty()) selections_.emplace(selection->tick, selection);
    return wrong;
  });
  if (!graph().cbvs_see) return;
  for (int slot = 0; slot < graph().max_cbv; ++slot) listenToImages(slot);
}

bool CbvPlannerNode::complete(const msgs::TrafficSnapshot& snapshot,
                              const msgs::CbvSelection& selection) const {
  if (!graph().cbvs_see) return true;
  for (const msgs::CbvAssignment& assignment : selection.assignments) {
    if (!contains(snapshot, assignment.vehicle_id)) continue;
    if (!images().complete(assignment.slot, snapshot.tick)) return false;
  }
  return true;
}

bool CbvPlannerNode::ready(const msgs::TrafficSnapshot& snapshot) const {
  const auto found = selections_.find(snapshot.tick);
  return found != selections_.end() && complete(snapshot, *found->second);
}

bool CbvPlannerNode::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const auto found = selections_.find(message->tick);
  if (found == selections_.end()) return superseded;
  if (!superseded && !complete(*message, *found->second)) return false;
  plan(fromMsg(*message), *found->second);
  selections_.erase(selections_.begin(), selections_.upper_bound(message->tick));
  return true;
}

void CbvPlannerNode::arrived(const msgs::TrafficSnapshot& snapshot) {
  if (!snapshot.steering.empty()) steering_[snapshot.tick] = fromMsg(snapshot.steering);
}

void CbvPlannerNode::followSteering(std::uint64_t tick) {
  while (!steering_.empty() && steering_.begin()->first <= tick) {
    const std::string unfollowed =
        session::steerPlanner(steering_.begin()->second, *steered_, *planner_);
    if (!unfollowed.empty()) reportFault(unfollowed);
    steering_.erase(steering_.begin());
  }
}

void CbvPlannerNode::plan(const traffic::TrafficSnapshot& snapshot,
                          const msgs::CbvSelection& message) {
  followSteering(snapshot.tick);
  const cbv::CbvSelection selection = fromMsg(message, setup_->network());
  const auto tasks = session::cbvTasks(snapshot, selection, *setup_, steered_->targetSpeed());
  if (tasks.empty()) return;
  const PlannerDecision decision = graph().cbvs_see
                                       ? planSeeing(*planner_, snapshot, tasks, images())
                                       : planBlind(*planner_, snapshot, tasks);
  statistics_.observe(decision);
  images().forgetBefore(snapshot.tick + 1);
  publish(snapshot, decision);
  warnOf("cbv:" + setup_->options().cbv_planner, decision);
}

/// Controls, which come first in the table, are published last: with them the session goes on.
void CbvPlannerNode::publish(const traffic::TrafficSnapshot& snapshot,
                             const PlannerDecision& decision) {
  TickValues values{snapshot, &setup_->network(), setup_->options().simulation_step,
                    graph().cbvs_guided, decision.image_age};
  values.answers = answersOf("cbv:" + setup_->options().cbv_planner, decision);
  for (auto entry = answers_.rbegin(); entry != answers_.rend(); ++entry) {
    const auto& [topic, publisher] = *entry;
    if (const AnyMessage message = makeMessage(topic, values))
      topic.row().type.publish(publisher, message);
  }
  if (markers_.getNumSubscribers() > 0) markers_.publish(planMarkers(decision.actions, snapshot));
}

}  // namespace cdiff::node_graph
