// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A priority crossing at the origin for tests with the real SUMO: a major road along x (edges
/// west_in, east_out, east_far and back) and a minor road along y (south_in, north_out and back),
/// all of 13.89 m/s. With `bridge`, another road passes 8 m above the major road at x = -30 m.
/// Lanes are 3.2 m wide and SUMO drives on the right: eastward lane at y = -1.6 m, northward lane
/// at x = 1.6 m.
#pragma once

#include <memory>

#include "map/lane_graph.h"
#include "simulation/sumo_simulator.h"
#include "support/sumo_network.h"

namespace cdiff::test {

constexpr double kStep = 0.05;  ///< simulation step [s]

inline std::string roadEdges(const std::string& name, const std::string& from,
                             const std::string& to, int priority, int lanes) {
  const std::string rest = "\" priority=\"" + std::to_string(priority) + "\" numLanes=\"" +
                           std::to_string(lanes) + "\" speed=\"13.89\"/>";
  return "<edge id=\"" + name + "\" from=\"" + from + "\" to=\"" + to + rest + "<edge id=\"" +
         name + "_back\" from=\"" + to + "\" to=\"" + from + rest;
}

inline SumoNetwork makeCrossing(const TemporaryFolder& folder, bool bridge, int major_lanes = 1) {
  std::string nodes =
      "<node id=\"w\" x=\"-200\" y=\"0\"/><node id=\"c\" x=\"0\" y=\"0\" type=\"priority\"/>"
      "<node id=\"e\" x=\"200\" y=\"0\"/><node id=\"f\" x=\"400\" y=\"0\"/>"
      "<node id=\"s\" x=\"0\" y=\"-200\"/><node id=\"n\" x=\"0\" y=\"200\"/>";
  std::string edges = roadEdges("west", "w", "c", 3, major_lanes) +
                      roadEdges("east", "c", "e", 3, major_lanes) +
                      roadEdges("far", "e", "f", 3, major_lanes) +
                      roadEdges("south", "s", "c", 1, 1) + roadEdges("north", "c", "n", 1, 1);
  if (bridge) {
    nodes +=
        "<node id=\"a\" x=\"-30\" y=\"-150\" z=\"8\"/><node id=\"b\" x=\"-30\" y=\"150\" z=\"8\"/>";
    edges += roadEdges("bridge", "a", "b", 1, 1);
  }
  return makeSumoNetwork(folder, nodes, edges);
}

/// From 5 m after the start of one edge's rightmost lane to 5 m before the end of another's.
inline map::Route routeOnFirstLanes(const map::LaneGraph& graph, const std::string& from,
                                    const std::string& to) {
  const map::LanePosition start{graph.network().findLane(from + "_0"), 5.0};
  map::LanePosition goal{graph.network().findLane(to + "_0"), 0.0};
  goal.arc_length = graph.network().lane(goal.lane).centerline.length() - 5.0;
  return graph.toRoute(graph.shortestPath(start, goal, 5000.0).value(), start.arc_length,
                       goal.arc_length);
}

/// One simulator on the crossing with a vehicle that we drive eastward.
class CrossingWorld {
 public:
  explicit CrossingWorld(bool bridge = false, int major_lanes = 1,
                         const simulation::SumoOptions& options = {})
      : made_(makeCrossing(folder_, bridge, major_lanes)),
        graph_(made_.network),
        route_(routeOnFirstLanes(graph_, "west", "east")) {
    simulation::SumoSession session;
    session.network_file = made_.file;
    session.simulation_step = kStep;
    simulator_ = std::make_unique<simulation::SumoSimulator>(options, session, made_.network);
  }

  simulation::SumoSimulator& simulator() { return *simulator_; }
  const map::RoadNetwork& network() const { return made_.network; }
  const map::LaneGraph& graph() const { return graph_; }
  const map::Route& route() const { return route_; }
  void close() { simulator_.reset(); }

  /// Our vehicle, heading east with its center at (x, y).
  simulation::DrivenVehicle ours(double x, double y, double speed) const {
    simulation::DrivenVehicle vehicle;
    vehicle.id = "ours";
    vehicle.state.position = {x, y};
    vehicle.state.speed = speed;
    vehicle.route = &route_;
    return vehicle;
  }
  const simulation::SimulatedVehicle* find(const std::string& id) const {
    for (const simulation::SimulatedVehicle& vehicle : simulator_->vehicles()) {
      if (vehicle.id == id) return &vehicle;
    }
    return nullptr;
  }

 private:
  TemporaryFolder folder_;
  SumoNetwork made_;
  map::LaneGraph graph_;
  map::Route route_;
  std::unique_ptr<simulation::SumoSimulator> simulator_;
};

}  // namespace cdiff::test
