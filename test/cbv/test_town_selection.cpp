// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Properties that every selection must have, on a real town with many vehicles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cbv/cbv_selector.h"
#include "core/file.h"
#include "e2e_cdiff/core/random.h"
#include "support/real_data.h"
#include "support/snapshot_builder.h"

namespace cdiff::cbv {
namespace {

constexpr std::size_t kVehicles = 50;

class TownSelection : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = test::realData("carla_towns/Town05.net.xml");
    CDIFF_SKIP_WITHOUT(file);
    network_ = std::make_unique<map::RoadNetwork>(
        map::RoadNetwork::fromText(core::readFile(file, "network"), "Town05"));
    graph_ = std::make_unique<map::LaneGraph>(*network_);
    for (map::LaneIndex i = 0; i < static_cast<map::LaneIndex>(network_->lanes().size()); ++i) {
      const map::Lane& lane = network_->lane(i);
      if (lane.routable && lane.centerline.length() > 5.0) lanes_.push_back(i);
    }
  }

  /// Straight on for 400 m from a routable lane.
  map::Route egoRoute(std::size_t lane) const {
    const map::LaneIndex first = lanes_[lane % lanes_.size()];
    return graph_->extended(graph_->toRoute({{first}, 5.0}, 0.0, 5.0), 400.0);
  }

  /// The ego along its route and 50 vehicles on lanes within 100 m, at places that depend on
  /// `round` alone.
  traffic::TrafficSnapshot snapshot(const map::Route& route, std::uint32_t round) const {
    const core::RandomStream random(round, "vehicles");
    const double along = std::min(0.5 * route.length(), 2.0 * round);
    const Eigen::Vector3d ego = route.path().pointAt(along);
    auto snapshot = test::snapshotWithEgo(52 + 4 * round, {ego.x(), ego.y(), 0.0, 8.0, ego.z()});
    for (std::uint32_t i = 0; snapshot.vehicles.size() <= kVehicles && i < 20000; ++i) {
      const map::Lane& lane = network_->lane(lanes_[random.index({}, 3 * i, lanes_.size())]);
      const double arc_length = random.uniform({}, 3 * i + 1) * lane.centerline.length();
      const Eigen::Vector3d at = lane.centerline.pointAt(arc_length);
      if ((at - ego).head<2>().norm() > 100.0) continue;
      const double heading = core::radiansToDegrees(lane.centerline.headingAt(arc_length));
      snapshot.vehicles.push_back(test::vehicle(
          "v" + std::to_string(round) + "_" + std::to_string(i),
          {at.x(), at.y(), heading, random.uniform({}, 3 * i + 2, 0.0, 12.0), at.z()}));
      snapshot.vehicles.back().lane_id = lane.id;
    }
    return snapshot;
  }

  /// Whether a lane lies beside another or starts at most 3 m after its end (lanes of a few
  /// centimeters, which this town has, get no point of a route of their own).
  bool follows(map::LaneIndex before, map::LaneIndex here) const {
    if (here == before) return true;
    const double end = network_->lane(before).centerline.length();
    return graph_->distancesFrom({before, end}, 3.0)[static_cast<std::size_t>(here)] <= 3.0;
  }

  std::unique_ptr<map::RoadNetwork> network_;
  std::unique_ptr<map::LaneGraph> graph_;
  std::vector<map::LaneIndex> lanes_;
};

TEST_F(TownSelection, EveryAssignmentKeepsItsPromises) {
  int chosen = 0;
  const CbvOptions options;
  for (std::uint32_t round = 0; round < 60; ++round) {
    const map::Route route = egoRoute(13 * round);
    CbvSelector selector(options, 2, *graph_, route);
    const auto world = snapshot(route, round);
    const auto selection = selector.update(world);
    EXPECT_EQ(selection.assignments.size() + selection.rejected.size() + 1, world.vehicles.size());
    for (const CbvAssignment& assignment : selection.assignments) {
      ++chosen;
      const ConflictPoint& point = assignment.conflict_point;
      EXPECT_LT(std::abs(point.cbv_distance - point.ego_distance), options.route_distance_gate);
      EXPECT_LT(route.path().project(point.position.head<2>()).distance, 0.2);
      const map::Route& way = assignment.conflict_aware_route;
      const auto at_point = way.path().project(point.position.head<2>());
      EXPECT_LT(at_point.distance, 0.2) << "round " << round << " " << assignment.vehicle_id;
      const auto& vehicle = *world.find(assignment.vehicle_id);
      EXPECT_LT((way.path().positionAt(0.0) - vehicle.state.position).norm(), 1.0);
      for (std::size_t i = 1; i < way.lanes().size(); ++i) {
        EXPECT_TRUE(follows(way.lanes()[i - 1], way.lanes()[i]))
            << network_->lane(way.lanes()[i - 1]).id << " -> " << network_->lane(way.lanes()[i]).id;
      }
    }
  }
  EXPECT_GT(chosen, 30);
}

TEST_F(TownSelection, TheSameSnapshotsGiveTheSameSelections) {
  const map::Route route = egoRoute(13);
  CbvSelector first({}, 3, *graph_, route);
  CbvSelector second({}, 3, *graph_, route);
  std::size_t chosen = 0;
  for (std::uint32_t round = 0; round < 20; ++round) {
    auto world = snapshot(route, round);
    const auto one = first.update(world);
    chosen += one.assignments.size();
    std::reverse(world.vehicles.begin() + 1, world.vehicles.end());
    const auto other = second.update(world);
    ASSERT_EQ(one.assignments.size(), other.assignments.size());
    for (std::size_t i = 0; i < one.assignments.size(); ++i) {
      EXPECT_EQ(one.assignments[i].vehicle_id, other.assignments[i].vehicle_id);
      EXPECT_EQ(one.assignments[i].interaction_score, other.assignments[i].interaction_score);
    }
    ASSERT_EQ(one.rejected.size(), other.rejected.size());
    for (std::size_t i = 0; i < one.rejected.size(); ++i) {
      EXPECT_EQ(one.rejected[i].vehicle_id, other.rejected[i].vehicle_id);
      EXPECT_STREQ(one.rejected[i].reason.c_str(), other.rejected[i].reason.c_str());
    }
  }
  EXPECT_GT(chosen, 0U);
}

}  // namespace
}  // namespace cdiff::cbv
