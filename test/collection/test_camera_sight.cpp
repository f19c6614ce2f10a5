// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "collection/camera_sight.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::collection {
namespace {

using Ids = std::vector<std::string>;

map::RoadNetwork straightRoad() {
  return test::NetworkText().edge("road", {"0,0 600,0"}).network();
}

/// Vehicle "own" at 100 m among others.
traffic::TrafficSnapshot snapshotOf(std::uint64_t tick, const std::vector<traffic::Vehicle>& others,
                                    double heading = 0.0) {
  auto snapshot = test::snapshotWithEgo(tick, {500.0, 0.0, 0.0, 0.0});
  snapshot.vehicles.push_back(test::vehicle("own", {100.0, 0.0, heading, 8.0}));
  snapshot.vehicles.insert(snapshot.vehicles.end(), others.begin(), others.end());
  return snapshot;
}

Ids seenIn(const traffic::TrafficSnapshot& snapshot) {
  const map::RoadNetwork network = straightRoad();
  const auto seen = CameraSight({}, network).seenBy(snapshot.vehicles[1], snapshot);
  Ids ids;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) ids.push_back(snapshot.vehicles[i].id);
  }
  return ids;
}

TEST(CameraSight, SeesWhatIsAheadAndNeitherBehindNorBesideNorItself) {
  EXPECT_EQ(seenIn(snapshotOf(
                0, {test::vehicle("ahead", {120.0, 0.0}), test::vehicle("behind", {80.0, 0.0}),
                    test::vehicle("beside", {100.0, 4.0})})),
            Ids{"ahead"});
}

TEST(CameraSight, DoesNotSeeThroughATruck) {
  traffic::Vehicle truck = test::vehicle("truck", {115.0, 0.0});
  truck.dimensions = {6.0, 8.0, 4.0};
  const traffic::Vehicle car = test::vehicle("car", {140.0, 0.0});
  EXPECT_EQ(seenIn(snapshotOf(0, {car})), Ids{"car"});
  EXPECT_EQ(seenIn(snapshotOf(0, {car, truck})), Ids{"truck"});
}

/// Notes which vehicles it is shown at each decision.
class Witness : public planning::Planner {
 public:
  explicit Witness(std::vector<Ids>& shown) : shown_(shown) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override {
    Ids ids;
    for (const traffic::Vehicle& vehicle : snapshot.vehicles) ids.push_back(vehicle.id);
    shown_.push_back(ids);
    return {{tasks.front().slot, tasks.front().vehicle->id, {}, {}}};
  }

 private:
  std::vector<Ids>& shown_;
};

TEST(SightedPlanner, KnowsWhatItsCameraShowedForOneSecond) {
  const map::RoadNetwork network = straightRoad();
  std::vector<Ids> shown;
  SightedPlanner planner([&] { return std::make_unique<Witness>(shown); }, {}, network);
  for (std::uint64_t i = 0; i <= 12; ++i) {
    // It turns its back on the other at once.
    const auto snapshot =
        snapshotOf(2 * i, {test::vehicle("other", {120.0, 0.0})}, i == 0 ? 0.0 : 180.0);
    planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0}});
  }
  ASSERT_EQ(shown.size(), 13u);
  for (std::size_t i = 0; i <= 10; ++i) EXPECT_EQ(shown[i], (Ids{"own", "other"})) << i;
  EXPECT_EQ(shown[11], Ids{"own"});
}

TEST(SightedPlanner, ForgetsWhereAVehicleIsNotAmongTheTasks) {
  const map::RoadNetwork network = straightRoad();
  std::vector<Ids> shown;
  SightedPlanner planner([&] { return std::make_unique<Witness>(shown); }, {}, network);
  const auto seeing = snapshotOf(0, {test::vehicle("other", {120.0, 0.0})});
  planner.plan(seeing, {{0, &seeing.vehicles[1], nullptr, 8.0}});
  planner.plan(seeing, {});
  const auto turned = snapshotOf(4, {test::vehicle("other", {120.0, 0.0})}, 180.0);
  planner.plan(turned, {{0, &turned.vehicles[1], nullptr, 8.0}});
  EXPECT_EQ(shown.back(), Ids{"own"});
}

TEST(SightedPlanner, VehiclesDoNotShareWhatTheySee) {
  const map::RoadNetwork network = straightRoad();
  std::vector<Ids> shown;
  SightedPlanner planner([&] { return std::make_unique<Witness>(shown); }, {}, network);
  const auto snapshot = snapshotOf(
      0, {test::vehicle("other", {120.0, 0.0, 180.0}), test::vehicle("third", {140.0, 0.0})});
  const auto actions = planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0},
                                               {1, &snapshot.vehicles[2], nullptr, 8.0}});
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_EQ(actions[1].vehicle_id, "other");
  EXPECT_EQ(shown[1], (Ids{"own", "other"})) << "what lies behind it is not known";
}

float targetOf(const std::vector<float>& targets, const std::string& name) {
  const auto names = sightTargets();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument(name);
  return targets.at(static_cast<std::size_t>(found - names.begin()));
}

TEST(SightTargets, NameTheLeaderAndTheCellsThatAreSeen) {
  const map::RoadNetwork network = straightRoad();
  const map::Route route = map::matchRoute(network, {{0.0, 0.0, 0.0}, {600.0, 0.0, 0.0}});
  const auto snapshot = snapshotOf(0, {test::vehicle("leader", {121.0, 0.2, 0.0, 5.0}),
                                       test::vehicle("hidden", {117.0, -4.5, 0.0, 5.0})});
  std::vector<bool> seen = {false, false, true, false};
  auto targets = sightTargetsOf(snapshot.vehicles[1], snapshot, seen, route, 100.0);
  ASSERT_EQ(targets.size(), sightTargets().size());
  EXPECT_NEAR(targetOf(targets, "leader_near"), std::exp(-21.0 / 20.0), 1e-3);
  EXPECT_NEAR(targetOf(targets, "leader_relative_speed"), -0.3, 1e-6);
  EXPECT_EQ(targetOf(targets, "occupied_left_5_0"), 1.0F);
  EXPECT_EQ(targetOf(targets, "occupied_right_4_1"), 0.0F) << "not seen";
  seen = {false, false, false, true};
  targets = sightTargetsOf(snapshot.vehicles[1], snapshot, seen, route, 100.0);
  EXPECT_EQ(targetOf(targets, "leader_near"), 0.0F);
  EXPECT_TRUE(std::isnan(targetOf(targets, "leader_relative_speed")));
  EXPECT_EQ(targetOf(targets, "occupied_right_4_1"), 1.0F);
}

}  // namespace
}  // namespace cdiff::collection
