// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Driven vehicles across the joints of lanes, with others close behind: SUMO 1.15 ends itself when
// a vehicle is put (moveToXY) from lane to lane and its follower asks where its rear is.
#include <gtest/gtest.h>

#include "map/import/network_import.h"
#include "simulation/crossing_world.h"
#include "support/real_data.h"

namespace cdiff {
namespace {

using simulation::DrivenVehicle;
using test::kStep;

const traffic::VehicleDimensions kCar;  // 4.5 x 1.8 m

/// Drives our vehicle along a route at `speed`, `offset` meters to the left, with a car of SUMO 8 m
/// behind its rear from the start.
class Convoy {
 public:
  Convoy(const std::filesystem::path& file, const map::RoadNetwork& network,
         const map::Route& route)
      : route_(route) {
    simulation::SumoSession session;
    session.network_file = file;
    simulator_ =
        std::make_unique<simulation::SumoSimulator>(simulation::SumoOptions{}, session, network);
  }
  /// Steps without a lane reported for our vehicle.
  int drive(double begin, double speed, double offset) {
    int lost = 0;
    DrivenVehicle ours = at(begin, speed, offset);
    simulator_->addDriven("ours", kCar, ours);
    const int steps = static_cast<int>((route_.length() - begin - 20.0) / (speed * kStep));
    for (int i = 0; i < steps; ++i) {
      if (i == 1) addFollower(begin - 15.0, speed);
      ours = at(begin + speed * kStep * i, speed, offset);
      simulator_->step({ours});
      for (const simulation::SimulatedVehicle& vehicle : simulator_->vehicles()) {
        if (vehicle.id == "ours" && vehicle.lane_id.empty()) ++lost;
      }
    }
    return lost;
  }
  const simulation::SumoSimulator& simulator() const { return *simulator_; }

 private:
  DrivenVehicle at(double arc_length, double speed, double offset) const {
    const geometry::Polyline& path = route_.path();
    DrivenVehicle vehicle;
    vehicle.id = "ours";
    vehicle.route = &route_;
    vehicle.state.heading = path.headingAt(arc_length);
    vehicle.state.position =
        path.positionAt(arc_length) +
        offset * geometry::leftNormal(geometry::direction(vehicle.state.heading));
    vehicle.state.elevation = path.pointAt(arc_length).z();
    vehicle.state.speed = speed;
    return vehicle;
  }
  void addFollower(double position, double speed) {
    ASSERT_TRUE(simulator_->addBackground("follower", route_.edges(), position, 0, speed, kCar));
  }

  const map::Route& route_;
  std::unique_ptr<simulation::SumoSimulator> simulator_;
};

TEST(LaneJoints, EdgesShorterThanAStepAndAFollower) {
  const test::TemporaryFolder folder;
  std::string nodes;
  std::string edges;
  const std::vector<double> ends = {0.0, 100.0, 100.4, 150.0, 150.3, 151.0, 300.0};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const std::string name = std::to_string(i);
    nodes += "<node id=\"n" + name + "\" x=\"" + std::to_string(ends[i]) + "\" y=\"0\"/>";
    if (i > 0) {
      edges += "<edge id=\"e" + name + "\" from=\"n" + std::to_string(i - 1) + "\" to=\"n" + name +
               "\" numLanes=\"1\" speed=\"13.89\"/>";
    }
  }
  const test::SumoNetwork made = test::makeSumoNetwork(folder, nodes, edges);
  const map::LaneGraph graph(made.network);
  const map::Route route = test::routeOnFirstLanes(graph, "e1", "e6");
  for (const double speed : {6.0, 11.0}) {
    for (const double offset : {0.0, 0.9}) {
      Convoy convoy(made.file, made.network, route);
      EXPECT_LE(convoy.drive(40.0, speed, offset), 1);
      EXPECT_EQ(convoy.simulator().vehicles().size(), 2U);
    }
  }
}

TEST(LaneJoints, AShortEdgeBeforeACrossingAndAFollower) {
  const test::TemporaryFolder folder;
  const std::string nodes =
      "<node id=\"w\" x=\"-200\" y=\"0\"/><node id=\"k\" x=\"-13\" y=\"0\"/>"
      "<node id=\"c\" x=\"0\" y=\"0\" type=\"priority\"/><node id=\"e\" x=\"200\" y=\"0\"/>"
      "<node id=\"s\" x=\"0\" y=\"-200\"/><node id=\"n\" x=\"0\" y=\"200\"/>";
  const std::string edges =
      test::roadEdges("west", "w", "k", 3, 1) + test::roadEdges("short", "k", "c", 3, 1) +
      test::roadEdges("east", "c", "e", 3, 1) + test::roadEdges("south", "s", "c", 1, 1) +
      test::roadEdges("north", "c", "n", 1, 1);
  const test::SumoNetwork made = test::makeSumoNetwork(folder, nodes, edges);
  const map::LaneGraph graph(made.network);
  for (const char* goal : {"east", "north"}) {
    const map::Route route = test::routeOnFirstLanes(graph, "west", goal);
    for (const double offset : {0.0, 0.5}) {
      Convoy convoy(made.file, made.network, route);
      EXPECT_LE(convoy.drive(100.0, 7.0, offset), 1);
      EXPECT_EQ(convoy.simulator().vehicles().size(), 2U);
    }
  }
}

TEST(LaneJoints, ARouteThroughARealTown) {
  const std::filesystem::path town = test::realData("carla_towns/Town05.net.xml");
  CDIFF_SKIP_WITHOUT(town);
  const map::ImportedNetwork imported = map::importNetwork(town.string());
  const map::RoadNetwork network = map::RoadNetwork::fromText(imported.text, town.string());
  const map::LaneGraph graph(network);
  const map::LanePosition start{network.findLane("-19_0"), 0.0};
  ASSERT_NE(start.lane, map::kNoLane);
  const map::Route route = graph.extended(graph.toRoute({{start.lane}, 50.0}, 5.0, 55.0), 700.0);
  Convoy convoy(imported.file, network, route);
  EXPECT_LE(convoy.drive(40.0, 9.0, 0.5), 2);
}

}  // namespace
}  // namespace cdiff
