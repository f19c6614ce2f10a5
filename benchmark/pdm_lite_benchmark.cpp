// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "benchmark.h"
#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "map/lane_graph.h"
#include "planners/pdm_lite/pdm_lite.h"

namespace cdiff::benchmark {
namespace {

constexpr int kDecisions = 400;
constexpr double kSpeed = 8.0;       // of the ego [m/s]
constexpr double kPeriod = 0.1;      // [s]
constexpr double kDetection = 50.0;  // vehicles that are forecast [m]
constexpr std::size_t kNear = 60;    // vehicles within kNearRadius of the middle of the route
constexpr std::size_t kAll = 120;    // vehicles in the town
constexpr double kNearRadius = 150.0;

using Lanes = std::vector<map::LaneIndex>;

/// An ego that drives a route of a real town at constant speed, and traffic of fixed places.
class TownScene {
 public:
  TownScene()
      : network_(map::RoadNetwork::fromText(
            core::readFile(dataFolder() / "carla_towns" / "Town05.net.xml", "network"), "Town05")),
        area_(network_),
        route_(drawRoute()) {
    snapshot_.vehicles.resize(1);
    snapshot_.vehicles[0].id = "ego";
    snapshot_.vehicles[0].state.speed = kSpeed;
    addTraffic(lanesWithin(kNearRadius), kNear);
    addTraffic(usableLanes(), kAll);
  }

  /// Milliseconds of each decision, ascending; `near` counts vehicles that were forecast.
  std::vector<double> decide(double& near) {
    planners::PdmLite planner({}, {}, {network_, area_});
    std::vector<double> times;
    for (int i = 0; i < kDecisions; ++i) {
      placeEgo(5.0 + std::fmod(i * kSpeed * kPeriod, route_.length() - 10.0));
      const std::vector<planning::PlanningTask> tasks = {
          {traffic::kEgoSlot, &snapshot_.vehicles[0], &route_, kSpeed}};
      times.push_back(1e3 * secondsOf([&] { planner.plan(snapshot_, tasks); }));
      near += static_cast<double>(countNear()) / kDecisions;
    }
    std::sort(times.begin(), times.end());
    return times;
  }

 private:
  Lanes usableLanes() const {
    Lanes lanes;
    for (std::size_t i = 0; i < network_.lanes().size(); ++i) {
      const map::Lane& lane = network_.lanes()[i];
      const bool usable = lane.routable && !lane.internal && lane.centerline.length() > 10.0;
      if (usable) lanes.push_back(static_cast<map::LaneIndex>(i));
    }
    return lanes;
  }

  Lanes lanesWithin(double radius) const {
    const Eigen::Vector2d middle = route_.path().positionAt(0.5 * route_.length());
    Lanes lanes;
    for (const map::LaneIndex lane : usableLanes()) {
      const geometry::Polyline& line = network_.lane(lane).centerline;
      if ((line.positionAt(0.5 * line.length()) - middle).norm() < radius) lanes.push_back(lane);
    }
    return lanes;
  }

  map::Route drawRoute() const {
    const map::LaneGraph graph(network_);
    const Lanes lanes = usableLanes();
    const core::RandomStream random(7, "routes");
    for (std::uint32_t draw = 0; draw < 1000; ++draw) {
      const map::LanePosition start{lanes[random.index({}, 2 * draw, lanes.size())], 5.0};
      const map::LanePosition goal{lanes[random.index({}, 2 * draw + 1, lanes.size())], 5.0};
      const auto way = graph.shortestPath(start, goal, 500.0);
      if (way && way->length > 350.0) return graph.toRoute(*way, start.arc_length, goal.arc_length);
    }
    throw core::InputError("Town05 has no route of 350 to 500 m");
  }

  /// Fills the town up to `count` vehicles on lanes drawn at random.
  void addTraffic(const Lanes& lanes, std::size_t count) {
    const core::RandomStream random(3, "traffic");
    while (snapshot_.vehicles.size() <= count) {
      const core::RandomKey key{snapshot_.vehicles.size(), 0, 0};
      const map::Lane& lane = network_.lane(lanes[random.index(key, 0, lanes.size())]);
      const double s = random.uniform(key, 1, 0.0, lane.centerline.length());
      traffic::Vehicle vehicle;
      vehicle.id = "car" + std::to_string(snapshot_.vehicles.size());
      vehicle.state.position = lane.centerline.positionAt(s);
      vehicle.state.elevation = lane.centerline.pointAt(s).z();
      vehicle.state.heading = lane.centerline.headingAt(s);
      vehicle.state.speed = 5.0;
      vehicle.lane_id = lane.id;
      snapshot_.vehicles.push_back(vehicle);
    }
  }

  void placeEgo(double arc_length) {
    traffic::VehicleState& state = snapshot_.vehicles[0].state;
    state.position = route_.path().positionAt(arc_length);
    state.elevation = route_.path().pointAt(arc_length).z();
    state.heading = route_.path().headingAt(arc_length);
  }

  std::size_t countNear() const {
    const Eigen::Vector2d ego = snapshot_.vehicles[0].state.position;
    const auto near = [&](const traffic::Vehicle& vehicle) {
      return (vehicle.state.position - ego).norm() <= kDetection;
    };
    const auto& vehicles = snapshot_.vehicles;
    return static_cast<std::size_t>(std::count_if(vehicles.begin() + 1, vehicles.end(), near));
  }

  map::RoadNetwork network_;
  map::DrivableArea area_;
  map::Route route_;
  traffic::TrafficSnapshot snapshot_;
};

}  // namespace

void benchmarkPdmLite(Figures& figures) {
  TownScene scene;
  double near = 0.0;
  const std::vector<double> times = scene.decide(near);
  figures.push_back({"pdm_lite_town_p50", median(times), "ms", "<=0.3"});
  figures.push_back({"pdm_lite_town_p95", times[times.size() * 95 / 100], "ms", ""});
  figures.push_back({"pdm_lite_town_vehicles_within_50_m", near, "", ""});
}

}  // namespace cdiff::benchmark
