// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"
#include "metrics/metric_registry.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/perceived_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/sample_messages.h"
#include "planning/perception_sample.h"
#include "support/network_text.h"
#include "support/same_vehicle.h"

namespace cdiff::node_graph {
namespace {

/// The message as another process reads it.
template <class Message>
Message overTheWire(const Message& message) {
  const ros::SerializedMessage serialized = ros::serialization::serializeMessage(message);
  Message copy;
  ros::serialization::deserializeMessage(serialized, copy);
  return copy;
}

TEST(Conversions, SnapshotComesBackBitByBit) {
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(80000000001ULL);
  const traffic::TrafficSnapshot back = fromMsg(overTheWire(toMsg(snapshot)));
  EXPECT_EQ(back.tick, snapshot.tick);
  EXPECT_EQ(back.time, snapshot.time);
  EXPECT_TRUE(back.decision_tick);
  EXPECT_EQ(back.status, snapshot.status);
  ASSERT_EQ(back.vehicles.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) test::expectSame(back.vehicles[i], snapshot.vehicles[i]);
  ASSERT_EQ(back.signals.size(), 1U);
  EXPECT_EQ(back.signals[0].id + back.signals[0].state, "lightrGy");
  ASSERT_EQ(back.contacts.size(), 1U);
  EXPECT_EQ(back.contacts[0].first + back.contacts[0].second, "bg_7ego");
  EXPECT_EQ(back.removed, snapshot.removed);
  ASSERT_EQ(back.faults.size(), 1U);
  EXPECT_EQ(back.faults[0].tick, snapshot.tick);
  EXPECT_EQ(back.faults[0].source, "planner");
  EXPECT_EQ(back.faults[0].text, snapshot.faults[0].text);
  ASSERT_EQ(back.steering.size(), 2U);
  const auto& [by, what, before, after] = back.steering[0];
  EXPECT_EQ(by + " " + what + " " + before + " " + after, "scenario profile none naturalistic");
  EXPECT_EQ(back.steering[1].after, "bg_9");
}

TEST(Conversions, EveryStatusComesBack) {
  for (int value = 0; value <= static_cast<int>(traffic::SessionStatus::kError); ++value) {
    traffic::TrafficSnapshot snapshot;
    snapshot.status = static_cast<traffic::SessionStatus>(value);
    EXPECT_EQ(fromMsg(toMsg(snapshot)).status, snapshot.status);
  }
}

TEST(Conversions, UnknownRoleAndStatusAreErrors) {
  msgs::Vehicle vehicle;
  vehicle.role = 3;
  EXPECT_THROW(fromMsg(vehicle), core::InputError);
  msgs::TrafficSnapshot snapshot;
  snapshot.status = 8;
  EXPECT_THROW(fromMsg(snapshot), core::InputError);
}

TEST(Conversions, NonFiniteActionComesBackUnchanged) {
  const planning::PlannedAction action{1, "bg_7", {std::nan(""), -INFINITY, 0.1}, {}};
  const auto message =
      overTheWire(toMsg(action, test::sampleSnapshot(4), {"cbv:x", 2.5, "broken"}));
  EXPECT_EQ(message.tick, 4U);
  EXPECT_EQ(message.header.stamp, ros::Time(0.2));
  EXPECT_EQ(message.planner, "cbv:x");
  EXPECT_EQ(message.planner_latency_ms, 2.5);
  EXPECT_EQ(message.fault, "broken");
  const planning::PlannedAction back = fromMsg(message);
  EXPECT_EQ(back.slot, 1);
  EXPECT_EQ(back.vehicle_id, "bg_7");
  EXPECT_TRUE(std::isnan(back.action.throttle));
  EXPECT_EQ(back.action.steer, -INFINITY);
  EXPECT_EQ(back.action.brake, 0.1);
}

TEST(Conversions, RolloutComesBackBitByBit) {
  planning::PlannedAction action{
      0, "bg_7", {}, {{{{1.0 / 3.0, 2.0}, 3.0, 0.4, 5.0}, {0.1, -0.2, 0.3}}}};
  const auto back = fromMsg(overTheWire(toRolloutMsg(action, test::sampleSnapshot(4))));
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].state.position, action.rollout[0].state.position);
  EXPECT_EQ(back[0].state.elevation, 3.0);
  EXPECT_EQ(back[0].state.heading, 0.4);
  EXPECT_EQ(back[0].state.speed, 5.0);
  EXPECT_EQ(back[0].action, action.rollout[0].action);
}

TEST(Conversions, CandidatesComeBackBitByBit) {
  planning::PlannedAction action;
  action.candidates = {{{{1.0 / 3.0, -2.0}, {0.1, 7.0 / 9.0}}, 1.0 / 7.0, true}, {{}, -0.5, false}};
  const auto back = candidatesFromMsg(overTheWire(toRolloutMsg(action, test::sampleSnapshot(4))));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].places, action.candidates[0].places);
  EXPECT_EQ(back[0].score, 1.0 / 7.0);
  EXPECT_TRUE(back[0].chosen);
  EXPECT_TRUE(back[1].places.empty());
  EXPECT_EQ(back[1].score, -0.5);
  EXPECT_FALSE(back[1].chosen);
}

TEST(Conversions, PerceptionComesBackBitByBit) {
  planning::PlannedAction action;
  action.perception = test::samplePerception();
  msgs::ControlAction message =
      overTheWire(toMsg(action, test::sampleSnapshot(4), {"ego:x", 2.5, ""}));
  const planning::Perception back = fromMsg(message).perception;
  ASSERT_EQ(back.vehicles.size(), 1U);
  const planning::PerceivedVehicle& sent = action.perception.vehicles[0];
  EXPECT_EQ(back.vehicles[0].state.position, sent.state.position);
  EXPECT_EQ(back.vehicles[0].state.elevation, sent.state.elevation);
  EXPECT_EQ(back.vehicles[0].state.heading, sent.state.heading);
  EXPECT_EQ(back.vehicles[0].state.speed, sent.state.speed);
  EXPECT_EQ(back.vehicles[0].dimensions.length, 4.0);
  EXPECT_EQ(back.vehicles[0].dimensions.width, 2.0);
  EXPECT_EQ(back.vehicles[0].dimensions.height, 1.5);
  EXPECT_EQ(back.vehicles[0].score, 0.75);
  ASSERT_EQ(back.vehicles[0].forecasts.size(), 2U);
  EXPECT_EQ(back.vehicles[0].forecasts[1].places, sent.forecasts[1].places);
  EXPECT_EQ(back.vehicles[0].forecasts[1].probability, 0.6);
  ASSERT_EQ(back.lines.size(), 1U);
  EXPECT_EQ(back.lines[0].kind, "edge");
  EXPECT_EQ(back.lines[0].points, action.perception.lines[0].points);
  EXPECT_EQ(back.lines[0].score, 0.9);
  ASSERT_EQ(back.occupancy.size(), 1U);
  EXPECT_EQ(back.occupancy[0].time, 0.5);
  EXPECT_EQ(back.occupancy[0].frame.position, Eigen::Vector2d(5.0, 5.0));
  EXPECT_EQ(back.occupancy[0].origin, Eigen::Vector2d(1.0, -1.5));
  EXPECT_EQ(back.occupancy[0].rows, 2);
  EXPECT_EQ(back.occupancy[0].probability, action.perception.occupancy[0].probability);
  message.perception.occupancy[0].rows = 3;
  EXPECT_TRUE(fromMsg(message).perception.occupancy.empty()) << "six numbers are not 3 x 3 cells";
}

/// Two lanes, one behind the other.
map::RoadNetwork twoLanes() {
  test::NetworkText text;
  text.edge("first", {"0,0 100,0"}, "a", "b")
      .edge("second", {"100,0 200,0"}, "b", "c")
      .connection("first_0", "second_0");
  return map::RoadNetwork::fromText(text.text(), "test");
}

cbv::CbvSelection sampleSelection(const map::RoadNetwork& network) {
  cbv::CbvSelection selection;
  selection.tick = 6;
  cbv::CbvAssignment assignment;
  assignment.slot = 1;
  assignment.vehicle_id = "bg_7";
  assignment.interaction_score = 1.0 / 3.0;
  assignment.selected_tick = 2;
  assignment.conflict_point = {{1.0 / 7.0, 2.0 / 7.0, 3.0 / 7.0}, 0.1, 0.2, 0.3, 0.4, 0.5};
  const std::vector<Eigen::Vector3d> points = {
      {50.0, 1.0 / 3.0, 0.0}, {99.0, 0.1, 0.0}, {120.0, 0.2, 0.0}};
  assignment.conflict_aware_route = map::Route(
      network, points,
      {network.findLane("first_0"), network.findLane("first_0"), network.findLane("second_0")});
  selection.assignments = {assignment};
  selection.rejected = {{"bg_1", "too_far", 0.25}};
  selection.released = {{0, "bg_2", "contact"}};
  return selection;
}

TEST(Conversions, SelectionComesBackWithItsRoute) {
  const map::RoadNetwork network = twoLanes();
  const cbv::CbvSelection selection = sampleSelection(network);
  const cbv::CbvSelection back = fromMsg(overTheWire(toMsg(selection, 0.3, network)), network);
  EXPECT_EQ(back.tick, 6U);
  ASSERT_EQ(back.assignments.size(), 1U);
  const cbv::CbvAssignment& left = back.assignments[0];
  const cbv::CbvAssignment& right = selection.assignments[0];
  EXPECT_EQ(left.slot, 1);
  EXPECT_EQ(left.vehicle_id, "bg_7");
  EXPECT_EQ(left.interaction_score, right.interaction_score);
  EXPECT_EQ(left.selected_tick, 2U);
  EXPECT_EQ(left.conflict_point.position, right.conflict_point.position);
  EXPECT_EQ(left.conflict_point.ego_arc_length, 0.1);
  EXPECT_EQ(left.conflict_point.ego_distance, 0.2);
  EXPECT_EQ(left.conflict_point.cbv_distance, 0.3);
  EXPECT_EQ(left.conflict_point.ego_arrival, 0.4);
  EXPECT_EQ(left.conflict_point.cbv_arrival, 0.5);
  EXPECT_EQ(left.conflict_aware_route.path().points(), right.conflict_aware_route.path().points());
  EXPECT_EQ(left.conflict_aware_route.path().arcLengths(),
            right.conflict_aware_route.path().arcLengths());
  EXPECT_EQ(left.conflict_aware_route.lanes(), right.conflict_aware_route.lanes());
  EXPECT_EQ(left.conflict_aware_route.edges(), right.conflict_aware_route.edges());
  ASSERT_EQ(back.rejected.size(), 1U);
  EXPECT_EQ(back.rejected[0].reason, "too_far");
  ASSERT_EQ(back.released.size(), 1U);
  EXPECT_EQ(back.released[0].vehicle_id, "bg_2");
}

TEST(Conversions, RouteOnAnUnknownLaneIsAnError) {
  const map::RoadNetwork network = twoLanes();
  msgs::CbvSelection message = toMsg(sampleSelection(network), 0.3, network);
  message.assignments[0].route_lane_ids[1] = "nowhere_0";
  try {
    fromMsg(message, network);
    FAIL() << "expected an InputError";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere_0"), std::string::npos) << error.what();
  }
}

TEST(Conversions, SessionInfoRebuildsTheSameSetup) {
  const session::SessionSetup setup(session::loadScenario("crossing_left_turn"));
  const msgs::SessionInfo message = overTheWire(toMsg(setup));
  const session::SessionSetup back(optionsFromMsg(message), importFromMsg(message),
                                   routeFromMsg(message));
  EXPECT_EQ(core::dumpOptions(back.options()), core::dumpOptions(setup.options()));
  EXPECT_EQ(back.import().text, setup.import().text);
  EXPECT_EQ(back.import().source_sha256, setup.import().source_sha256);
  EXPECT_EQ(back.egoRoute().path().points(), setup.egoRoute().path().points());
  EXPECT_EQ(back.egoRoute().lanes(), setup.egoRoute().lanes());
  EXPECT_EQ(fromMsg(overTheWire(toPathMsg(setup.egoRoute()))), setup.egoRoute().path().points());
}

void set(metrics::SessionMeasures& measures, const char* name, const metrics::Measure& measure) {
  measures.set(*metrics::findMeasure(name), measure);
}

TEST(Conversions, InfractionsAndPenaltyAreMeasures) {
  metrics::SessionMeasures measures;
  set(measures, "ego_blocked", {1.0, 1, "", ""});
  set(measures, "ego_penalty", {0.42, 7, "", ""});
  set(measures, "ego_infraction_red_lights", {1.0, 2, "", ""});
  set(measures, "ego_infraction_static_collisions", {std::nullopt, 0, "", "none"});
  std::map<std::string, msgs::Measure> found;
  for (const msgs::Measure& measure : toMsg(measures)) found[measure.name] = measure;
  EXPECT_EQ(found.at("ego_penalty").value, 0.42);
  EXPECT_EQ(found.at("ego_blocked").value, 1.0);
  EXPECT_EQ(found.at("ego_infraction_red_lights").value, 1.0);
  EXPECT_EQ(found.at("ego_infraction_red_lights").n, 2U);
  EXPECT_FALSE(found.at("ego_infraction_static_collisions").defined);
  EXPECT_EQ(found.at("ego_infraction_static_collisions").reason, "none");
}

TEST(Conversions, EveryDefinedMeasureIsPublished) {
  metrics::SessionMeasures measures;
  set(measures, "ego_collisions", {2.0, 1, "", ""});
  set(measures, "speed_wasserstein_mps", {1.0 / 3.0, 7, "", "", "a target"});
  set(measures, "post_encroachment_mean_s", {std::nullopt, 0, "", "no CBV was driven"});
  const std::vector<msgs::Measure> all = toMsg(measures);
  ASSERT_EQ(all.size(), metrics::measureDefinitions().size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const metrics::MeasureDefinition& definition = metrics::measureDefinitions()[i];
    EXPECT_EQ(all[i].name, definition.name);
    EXPECT_EQ(std::isnan(all[i].value), !all[i].defined) << definition.name;
    EXPECT_EQ(all[i].defined, measures.at(definition).value.has_value()) << definition.name;
    if (all[i].name == "ego_collisions") {
      EXPECT_EQ(all[i].value, 2.0);
    }
    if (all[i].name == "post_encroachment_mean_s") {
      EXPECT_EQ(all[i].reason, "no CBV was driven");
    }
    if (all[i].name != "speed_wasserstein_mps") continue;
    EXPECT_EQ(all[i].value, 1.0 / 3.0);
    EXPECT_EQ(all[i].n, 7U);
    EXPECT_EQ(all[i].unit, "m/s");
    EXPECT_EQ(all[i].target, "a target");
  }
}

TEST(MetricDiagnostics, ShowMainMeasuresAndWhatIsUndefined) {
  metrics::SessionMeasures measures;
  set(measures, "cbv_count", {3.0, 1, "", ""});
  set(measures, "ttc_min_s", {0.5, 12, "", "", ""});
  set(measures, "post_encroachment_min_s", {std::nullopt, 0, "", "no CBV was driven"});
  set(measures, "cbv_off_road_percent", {std::nullopt, 0, "", "no CBV was driven"});
  std::map<std::string, std::string> values;
  for (const auto& [name, value] : metricDiagnostics(measures)) values[name] = value;
  EXPECT_EQ(values.at("CBVs"), "3");
  EXPECT_EQ(values.at("2D-TTC, minimum"), "0.500 s (n = 12)");
  EXPECT_EQ(values.at("Post-encroachment time, minimum"), "not defined: no CBV was driven");
  EXPECT_EQ(values.at("not defined: no CBV was driven"),
            "cbv_off_road_percent, post_encroachment_min_s");
}

TEST(Conversions, UndefinedMeasuresAreNan) {
  metrics::TickMeasures measures;
  measures.ego_speed = 1.0 / 3.0;
  const msgs::MetricReport report = toMsg(measures, test::sampleSnapshot(4));
  EXPECT_TRUE(std::isnan(report.ttc_2d));
  EXPECT_TRUE(std::isnan(report.nearest_distance));
  EXPECT_EQ(report.ego_speed, 1.0 / 3.0);
  EXPECT_FALSE(report.final);
}

}  // namespace
}  // namespace cdiff::node_graph
