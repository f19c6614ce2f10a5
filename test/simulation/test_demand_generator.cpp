// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Generated demand on a grid of 4 x 4 crossings, 150 m apart, two lanes each way; the ego route
// leads straight east through the second row.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "e2e_cdiff/core/angle.h"
#include "simulation/crossing_world.h"
#include "simulation/demand_generator.h"

namespace cdiff {
namespace {

using simulation::DemandGenerator;
using simulation::DemandOptions;
using simulation::DemandVehicle;

constexpr int kSide = 4;
constexpr double kSpacing = 150.0;

std::string nodeName(int column, int row) {
  return "n" + std::to_string(column) + std::to_string(row);
}

test::SumoNetwork makeGrid(const test::TemporaryFolder& folder) {
  std::string nodes;
  std::string edges;
  for (int column = 0; column < kSide; ++column) {
    for (int row = 0; row < kSide; ++row) {
      const std::string name = nodeName(column, row);
      nodes += "<node id=\"" + name + "\" x=\"" + std::to_string(column * kSpacing) + "\" y=\"" +
               std::to_string(row * kSpacing) + "\" type=\"priority\"/>";
      if (column + 1 < kSide) {
        edges += test::roadEdges("h" + name.substr(1), name, nodeName(column + 1, row), 2, 2);
      }
      if (row + 1 < kSide)
        edges += test::roadEdges("v" + name.substr(1), name, nodeName(column, row + 1), 1, 2);
    }
  }
  return test::makeSumoNetwork(folder, nodes, edges);
}

class Grid : public testing::Test {
 protected:
  Grid()
      : made_(makeGrid(folder_)),
        graph_(made_.network),
        route_(test::routeOnFirstLanes(graph_, "h01", "h21")) {
    options_.density = 30;
  }
  Eigen::Vector2d start() const { return route_.path().positionAt(0.0); }

  /// All that the generator wants to place at once in an empty network.
  std::vector<DemandVehicle> fill(std::uint64_t seed) const {
    DemandGenerator generator(options_, graph_, route_, seed);
    std::vector<DemandVehicle> vehicles;
    while (auto vehicle = generator.next({}, start(), 0.0, true)) vehicles.push_back(*vehicle);
    return vehicles;
  }
  const map::Lane& laneOf(const DemandVehicle& vehicle) const {
    return made_.network.lane(
        made_.network.findLane(vehicle.edges.front() + "_" + std::to_string(vehicle.depart_lane)));
  }
  geometry::OrientedBox boxOf(const DemandVehicle& vehicle) const {
    const geometry::Polyline& line = laneOf(vehicle).centerline;
    const double heading = line.headingAt(vehicle.depart_position);
    const Eigen::Vector2d center = line.positionAt(vehicle.depart_position) -
                                   0.5 * vehicle.dimensions.length * geometry::direction(heading);
    return {center, heading, vehicle.dimensions.length, vehicle.dimensions.width};
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
  map::LaneGraph graph_;
  map::Route route_;
  DemandOptions options_;
};

std::string textOf(const std::vector<DemandVehicle>& vehicles) {
  std::string text;
  for (const DemandVehicle& vehicle : vehicles) {
    text += vehicle.id + " " + std::to_string(vehicle.depart_position) + " " +
            std::to_string(vehicle.depart_lane) + " " + std::to_string(vehicle.depart_speed) + " " +
            std::to_string(vehicle.dimensions.length);
    for (const std::string& edge : vehicle.edges) text += " " + edge;
    text += "\n";
  }
  return text;
}

TEST_F(Grid, TheSeedDecidesTheVehicles) {
  EXPECT_EQ(textOf(fill(1)), textOf(fill(1)));
  EXPECT_NE(textOf(fill(1)), textOf(fill(2)));
}

TEST_F(Grid, FillsToTheDensityWithIdsInOrder) {
  const std::vector<DemandVehicle> vehicles = fill(3);
  ASSERT_EQ(vehicles.size(), 30U);
  EXPECT_EQ(vehicles.front().id, "bg_0");
  EXPECT_EQ(vehicles.back().id, "bg_29");
}

TEST_F(Grid, KeepsTheStartClear) {
  options_.clear_start = 40.0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::vector<DemandVehicle> vehicles = fill(seed);
    EXPECT_FALSE(vehicles.empty());
    for (const DemandVehicle& vehicle : vehicles) {
      EXPECT_GT((boxOf(vehicle).center - start()).norm(), 40.0) << vehicle.id;
    }
  }
}

TEST_F(Grid, RoutesAreConnectedByLanesAndLongEnough) {
  const simulation::EdgeGraph edges(made_.network);
  for (const DemandVehicle& vehicle : fill(4)) {
    double length = edges.length(edges.find(vehicle.edges.front())) - vehicle.depart_position;
    for (std::size_t i = 1; i < vehicle.edges.size(); ++i) {
      const int to = edges.find(vehicle.edges[i]);
      EXPECT_TRUE(edges.connected(edges.find(vehicle.edges[i - 1]), to))
          << vehicle.id << " " << vehicle.edges[i];
      length += edges.length(to);
    }
    EXPECT_GE(length, 400.0) << vehicle.id;
  }
}

TEST_F(Grid, CoversEveryDirection) {
  std::set<long> headings;
  std::set<std::string> sizes;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (const DemandVehicle& vehicle : fill(seed)) {
      headings.insert(std::lround(boxOf(vehicle).heading / (0.5 * core::kPi)) & 3);
      sizes.insert(std::to_string(vehicle.dimensions.length));
    }
  }
  EXPECT_EQ(headings.size(), 4U);
  EXPECT_GE(sizes.size(), 3U);
}

TEST_F(Grid, NoTwoVehiclesOnALaneAreNearerThanEightMeters) {
  options_.density = 200;  // more than there is room for
  const std::vector<DemandVehicle> vehicles = fill(5);
  EXPECT_LT(vehicles.size(), 200U);
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    EXPECT_LE(vehicles[i].depart_speed, laneOf(vehicles[i]).speed_limit);
    for (std::size_t j = 0; j < i; ++j) {
      const double gap = geometry::distance(boxOf(vehicles[i]), boxOf(vehicles[j]));
      EXPECT_GT(gap, laneOf(vehicles[i]).id == laneOf(vehicles[j]).id ? 8.0 - 1e-9 : 0.4);
    }
  }
}

/// The generator and SUMO together, as a session uses them.
class DemandInSumo : public Grid {
 protected:
  void startDemand(std::uint64_t seed) {
    simulation::SumoSession session;
    session.network_file = made_.file;
    session.seed = seed;
    simulator_ = std::make_unique<simulation::SumoSimulator>(simulation::SumoOptions{}, session,
                                                             made_.network);
    generator_ = std::make_unique<DemandGenerator>(options_, graph_, route_, seed);
    present_.clear();
  }
  std::vector<DemandVehicle> step(const Eigen::Vector2d& ego, bool warm_up) {
    std::vector<DemandVehicle> added;
    while (auto vehicle = generator_->next(present_, ego, 0.0, warm_up)) {
      EXPECT_TRUE(simulator_->addBackground(vehicle->id, vehicle->edges, vehicle->depart_position,
                                            vehicle->depart_lane, vehicle->depart_speed,
                                            vehicle->dimensions));
      added.push_back(*vehicle);
    }
    simulator_->step({});
    present_.clear();
    for (const simulation::SimulatedVehicle& vehicle : simulator_->vehicles()) {
      traffic::Vehicle entry;
      entry.id = vehicle.id;
      entry.state = vehicle.state;
      entry.dimensions = vehicle.dimensions;
      entry.lane_id = vehicle.lane_id;
      present_.push_back(entry);
    }
    return added;
  }
  std::size_t near(const Eigen::Vector2d& ego) const {
    return static_cast<std::size_t>(
        std::count_if(present_.begin(), present_.end(), [&](const auto& vehicle) {
          return (vehicle.state.position - ego).norm() <= options_.radius;
        }));
  }
  std::string trace() const {
    std::string text;
    for (const traffic::Vehicle& vehicle : present_) {
      text += vehicle.id + " " + std::to_string(vehicle.state.position.x()) + " " +
              std::to_string(vehicle.state.position.y()) + " " +
              std::to_string(vehicle.state.speed) + "\n";
    }
    return text;
  }

  std::unique_ptr<simulation::SumoSimulator> simulator_;
  std::unique_ptr<DemandGenerator> generator_;
  std::vector<traffic::Vehicle> present_;
};

TEST_F(DemandInSumo, KeepsTheDensityAndPlacesOutOfSight) {
  startDemand(1);
  for (int i = 0; i < 200; ++i) step(start(), true);
  EXPECT_GE(near(start()), 28U);
  std::size_t fewest = 1000;
  for (int i = 0; i < 600; ++i) {  // the ego drives at 8 m/s for 30 s
    const Eigen::Vector2d ego = route_.path().positionAt(8.0 * 0.05 * i);
    for (const DemandVehicle& vehicle : step(ego, false)) {
      EXPECT_GT((boxOf(vehicle).center - ego).norm(), 55.0) << vehicle.id;
    }
    fewest = std::min(fewest, near(ego));
  }
  EXPECT_GE(fewest, 27U);  // of 30: those that just left the radius are replaced in the next steps
  for (std::size_t i = 0; i < present_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(geometry::overlap(present_[i].box(), present_[j].box()))
          << present_[i].id << " " << present_[j].id;
    }
  }
}

TEST_F(DemandInSumo, TheSameSeedGivesTheSameTraffic) {
  std::string first;
  for (int run = 0; run < 2; ++run) {
    startDemand(7);
    for (int i = 0; i < 300; ++i) step(start(), true);
    if (run == 0) first = trace();
  }
  EXPECT_EQ(first, trace());
  startDemand(8);
  for (int i = 0; i < 300; ++i) step(start(), true);
  EXPECT_NE(first, trace());
}

}  // namespace
}  // namespace cdiff
