// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Many hand-overs in real towns, with joints of lanes that overlap, edges shorter than a step and
// parking lanes. SUMO 1.15 ends itself there within minutes when vehicles are put from lane to lane
// (moveToXY).
#include <gtest/gtest.h>

#include <map>

#include "e2e_cdiff/core/angle.h"
#include "map/import/network_import.h"
#include "simulation/crossing_world.h"
#include "simulation/demand_generator.h"
#include "support/real_data.h"

namespace cdiff {
namespace {

using simulation::DrivenVehicle;
using simulation::SimulatedVehicle;
using test::kStep;

/// A vehicle that we drive at constant speed along its lane's route, drifting to `target` meters
/// left.
struct Taken {
  map::Route route;
  double arc_length = 0.0;
  double offset = 0.0;
  double target = 0.0;
  double length = 4.5;
  int steps_left = 0;
  traffic::VehicleState state;
};

class Town {
 public:
  Town(const std::filesystem::path& file, double reach)
      : reach_(reach),
        imported_(map::importNetwork(file.string())),
        network_(map::RoadNetwork::fromText(imported_.text, file.string())),
        graph_(network_),
        ego_route_(firstLongRoute()),
        demand_(options(), graph_, ego_route_, 1) {
    simulation::SumoSession session;
    session.network_file = imported_.file;
    simulator_ =
        std::make_unique<simulation::SumoSimulator>(simulation::SumoOptions{}, session, network_);
  }

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      if (i % 20 == 0) addTraffic();
      if (i > 300 && i % 10 == 0 && taken_.size() < 6) takeOne(static_cast<std::uint32_t>(i));
      const std::map<std::string, traffic::VehicleState> released = releaseDue();
      std::vector<DrivenVehicle> driven;
      for (auto& [id, vehicle] : taken_) driven.push_back(advance(id, vehicle));
      simulator_->step(driven);
      // From farther off a vehicle may come back before something for which SUMO brakes at once.
      if (reach_ < 2.0) checkReleased(released);
    }
  }
  int hand_overs = 0;

 private:
  static simulation::DemandOptions options() {
    simulation::DemandOptions options;
    options.density = 40;
    return options;
  }
  map::Route firstLongRoute() const {
    for (map::LaneIndex lane = 0; lane < static_cast<map::LaneIndex>(network_.lanes().size());
         ++lane) {
      const map::Lane& at = network_.lane(lane);
      if (!at.routable || at.internal || at.centerline.length() < 60.0) continue;
      const map::Route route = graph_.extended(graph_.toRoute({{lane}, 50.0}, 5.0, 55.0), 500.0);
      if (route.length() > 400.0) return route;
    }
    throw std::runtime_error("no long route");
  }
  void addTraffic() {
    std::vector<traffic::Vehicle> present;
    for (const SimulatedVehicle& vehicle : simulator_->vehicles()) {
      traffic::Vehicle entry;
      entry.id = vehicle.id;
      entry.state = vehicle.state;
      entry.dimensions = vehicle.dimensions;
      entry.lane_id = vehicle.lane_id;
      present.push_back(entry);
    }
    while (auto vehicle = demand_.next(present, ego_route_.path().positionAt(0.0), 0.0, true)) {
      simulator_->addBackground(vehicle->id, vehicle->edges, vehicle->depart_position,
                                vehicle->depart_lane, vehicle->depart_speed, vehicle->dimensions);
    }
  }
  void takeOne(std::uint32_t draw) {
    const auto& vehicles = simulator_->vehicles();
    const SimulatedVehicle vehicle = vehicles[random_.index({}, draw, vehicles.size())];
    const map::LaneIndex lane = network_.findLane(vehicle.lane_id);
    if (taken_.count(vehicle.id) != 0 || lane == map::kNoLane) return;
    const map::Lane& on = network_.lane(lane);
    const double s = on.centerline.project(vehicle.state.position).arc_length;
    if (on.internal || !on.routable || s < 6.0 || s + 3.0 > on.centerline.length()) return;
    Taken taken;
    taken.route = graph_.extended(graph_.toRoute({{lane}, 2.0}, s - 5.0, s + 1.0), 300.0);
    if (taken.route.length() < 200.0) return;
    simulator_->takeOver(vehicle.id);
    ++hand_overs;
    const geometry::Projection place = taken.route.path().project(vehicle.state.position);
    taken.arc_length = place.arc_length;
    taken.offset = place.lateral_offset;
    taken.target = random_.uniform({1, 0, 0}, draw, -reach_, reach_);
    taken.length = vehicle.dimensions.length;
    taken.steps_left = 40 + static_cast<int>(random_.index({2, 0, 0}, draw, 60));
    taken.state = vehicle.state;
    taken.state.speed = std::max(2.0, vehicle.state.speed);
    taken_.emplace(vehicle.id, std::move(taken));
  }
  std::map<std::string, traffic::VehicleState> releaseDue() {
    std::map<std::string, traffic::VehicleState> released;
    for (auto entry = taken_.begin(); entry != taken_.end();) {
      if (--entry->second.steps_left > 0) {
        ++entry;
        continue;
      }
      DrivenVehicle vehicle;
      vehicle.id = entry->first;
      vehicle.state = entry->second.state;
      vehicle.route = &entry->second.route;
      if (simulator_->release(vehicle)) released.emplace(vehicle.id, vehicle.state);
      entry = taken_.erase(entry);
    }
    return released;
  }
  DrivenVehicle advance(const std::string& id, Taken& taken) const {
    taken.arc_length += taken.state.speed * kStep;
    taken.offset += std::clamp(taken.target - taken.offset, -0.02 * reach_, 0.02 * reach_);
    const geometry::Polyline& path = taken.route.path();
    const Eigen::Vector2d front = path.positionAt(taken.arc_length + 0.5 * taken.length);
    const Eigen::Vector2d rear = path.positionAt(taken.arc_length - 0.5 * taken.length);
    taken.state.heading = std::atan2(front.y() - rear.y(), front.x() - rear.x());
    taken.state.position =
        0.5 * (front + rear) +
        taken.offset * geometry::leftNormal(geometry::direction(taken.state.heading));
    taken.state.elevation = path.pointAt(taken.arc_length).z();
    DrivenVehicle vehicle;
    vehicle.id = id;
    vehicle.state = taken.state;
    vehicle.route = &taken.route;
    return vehicle;
  }
  /// The first step after a release: straight on at the speed of the release.
  void checkReleased(const std::map<std::string, traffic::VehicleState>& released) const {
    for (const SimulatedVehicle& vehicle : simulator_->vehicles()) {
      const auto before = released.find(vehicle.id);
      if (before == released.end()) continue;
      const traffic::VehicleState& state = before->second;
      const Eigen::Vector2d moved = state.pose().toBody(vehicle.state.position);
      EXPECT_NEAR(moved.x(), state.speed * kStep, 0.3) << vehicle.id;
      EXPECT_NEAR(moved.y(), 0.0, 0.3) << vehicle.id;
      EXPECT_LT(std::abs(core::angleDifference(vehicle.state.heading, state.heading)),
                core::degreesToRadians(5.0))
          << vehicle.id;
      EXPECT_NEAR(vehicle.state.speed, state.speed, 0.5) << vehicle.id;
    }
  }

  double reach_;  ///< largest offset to the side [m]
  map::ImportedNetwork imported_;
  map::RoadNetwork network_;
  map::LaneGraph graph_;
  map::Route ego_route_;
  simulation::DemandGenerator demand_;
  core::RandomStream random_{3, "soak"};
  std::unique_ptr<simulation::SumoSimulator> simulator_;
  std::map<std::string, Taken> taken_;
};

class TownSoak : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(TownSoak, HandOversWithoutJumpOrLoss) {
  const std::filesystem::path file =
      test::realData(std::string("carla_towns/") + std::get<0>(GetParam()) + ".net.xml");
  CDIFF_SKIP_WITHOUT(file);
  Town town(file, std::get<1>(GetParam()));
  town.run(2500);
  EXPECT_GT(town.hand_overs, 50);
}

INSTANTIATE_TEST_SUITE_P(Towns, TownSoak,
                         testing::Combine(testing::Values("Town03", "Town05"),
                                          testing::Values(1.0, 6.0)));

}  // namespace
}  // namespace cdiff
