// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/tick_record.h"

#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

session::AnswerTiming::Instead insteadOf(const msgs::DecidedVehicle& vehicle) {
  using Instead = session::AnswerTiming::Instead;
  switch (vehicle.driven_by) {
    case msgs::DecidedVehicle::PLAN:
      return Instead::kPlan;
    case msgs::DecidedVehicle::FULL_BRAKE:
      return Instead::kFullBrake;
    case msgs::DecidedVehicle::SIMULATOR:
      return Instead::kNotDriven;
    default:
      return Instead::kNothing;
  }
}

std::vector<session::AnswerTiming> timingsOf(const msgs::DecisionRecord& record) {
  std::vector<session::AnswerTiming> timings;
  timings.push_back({kCbvIdentificationNode, record.selection_came != 0, record.selection_lateness,
                     session::AnswerTiming::Instead::kNothing});
  for (const msgs::DecidedVehicle& vehicle : record.vehicles) {
    if (!vehicle.asked) continue;
    timings.push_back(
        {vehicle.answer.planner, vehicle.answered != 0, vehicle.lateness, insteadOf(vehicle)});
  }
  return timings;
}

}  // namespace

TickRecordView::TickRecordView(const msgs::TrafficSnapshot& message, const TickAnswers& answers,
                               const map::RoadNetwork& network)
    : snapshot_(fromMsg(message)) {
  if (const auto answer = answers.selection(message.tick)) selection_ = fromMsg(*answer, network);
  record_.snapshot = &snapshot_;
  if (!snapshot_.decision_tick) return;
  const std::vector<Answer> given = answers.answers(message);
  actions_ = actionsOf(given);
  images_ = imagesOf(given);
  record_.selection = selection();
  record_.actions = &actions_;
  record_.images = &images_;
  record_.latencies = latenciesOf(given);
  if (const auto decision = answers.decision(message.tick)) record_.timings = timingsOf(*decision);
}

traffic::TrafficSnapshot endedAfter(const traffic::TrafficSnapshot& last, double simulation_step,
                                    traffic::SessionStatus status, const traffic::Fault& fault) {
  traffic::TrafficSnapshot snapshot = last;
  snapshot.tick += 1;
  snapshot.time = static_cast<double>(snapshot.tick) * simulation_step;
  snapshot.decision_tick = false;
  snapshot.contacts.clear();
  snapshot.removed.clear();
  snapshot.steering.clear();
  snapshot.status = status;
  snapshot.faults = {{last.tick, fault.source, fault.text}};
  return snapshot;
}

}  // namespace cdiff::node_graph
