// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/course.h"
#include "planners/plant/plant.h"
#include "planners/plant/plant_weights.h"
#include "planners/registry.h"
#include "support/temporary_folder.h"

namespace cdiff::planners {
namespace {

using testing::constantPlant;
using testing::drawnPlant;
using testing::vehicleAt;

class PlantPlannerTest : public ::testing::Test {
 protected:
  /// The ego at the beginning of a road of 200 m, others where the test puts them.
  static traffic::TrafficSnapshot snapshotOf(double speed,
                                             const std::vector<traffic::Vehicle>& others = {}) {
    traffic::TrafficSnapshot snapshot;
    snapshot.vehicles.push_back(vehicleAt("ego", 0.0, 0.0, 0.0, speed));
    snapshot.vehicles.insert(snapshot.vehicles.end(), others.begin(), others.end());
    return snapshot;
  }
  planning::PlannedAction planOf(PlantPlanner& planner, const traffic::TrafficSnapshot& snapshot) {
    return planner.plan(snapshot, {{-1, &snapshot.vehicles.front(), &route_}}).at(0);
  }
  std::string refusal(const std::string& weights) const {
    planning::PlannerOptionsTable options = defaultOptions();
    core::overrideOption("plant.weights=" + weights, "test", options);
    try {
      makePlanner("plant", {{network_, area_}, options, dynamics_, camera_, guidance_});
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "made";
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 200.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  dynamics::BicycleModelOptions dynamics_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
};

// Waypoints 4 m apart mean 8 m/s. At 7.9 m/s the error is 0.1: 5 x 0.1 + 0.5 x 0.1 / 20 + 0.1.
TEST_F(PlantPlannerTest, DrivesAsFastAsItsWaypointsSay) {
  PlantPlanner planner({}, constantPlant(4.0, 0.0));
  const planning::PlannedAction planned = planOf(planner, snapshotOf(7.9));
  EXPECT_EQ(planned.fault, "");
  EXPECT_NEAR(planned.action.throttle, 0.6025, 1e-5);
  EXPECT_EQ(planned.action.brake, 0.0);
  EXPECT_NEAR(planned.action.steer, 0.0, 1e-9);
  ASSERT_EQ(planned.rollout.size(), 20U);
  EXPECT_NEAR(planned.rollout[4].state.position.x(), 4.0, 1e-5);
  EXPECT_NEAR(planned.rollout[19].state.position.x(), 16.0, 1e-5);
  EXPECT_NEAR(planned.rollout[19].state.speed, 8.0, 1e-5);
}

// The error counts up to 0.25: 0.25 x 6.025 = 1.506, more than the largest throttle, 0.75.
TEST_F(PlantPlannerTest, NoThrottleIsLargerThanTheLargest) {
  PlantPlanner planner({}, constantPlant(4.0, 0.0));
  EXPECT_EQ(planOf(planner, snapshotOf(2.0)).action.throttle, 0.75);
}

// Waypoints (4, 1) and (8, 2): the aim (6, 1.5) bears atan 0.25 = 0.24498 rad, 0.15596 of a right
// angle; 0.9 + 0.75 / 20 + 0.3 = 1.2375 times that.
TEST_F(PlantPlannerTest, SteersToTheMiddleOfTheFirstTwoWaypoints) {
  PlantPlanner planner({}, constantPlant(4.0, 1.0));
  EXPECT_NEAR(planOf(planner, snapshotOf(8.0)).action.steer, 1.2375 * 0.15596, 1e-5);
  PlantPlanner mirrored({}, constantPlant(4.0, -1.0));
  EXPECT_NEAR(planOf(mirrored, snapshotOf(8.0)).action.steer, -1.2375 * 0.15596, 1e-5);
}

// 8.9 m/s is more than 1.1 x 8 m/s, 8.7 is not; waypoints 0.19 m apart mean 0.38 m/s, below 0.4.
TEST_F(PlantPlannerTest, BrakesFullyWhereItIsTooFastOrIsToStand) {
  PlantPlanner planner({}, constantPlant(4.0, 1.0));
  const traffic::ControlAction fast = planOf(planner, snapshotOf(9.2)).action;
  EXPECT_EQ(fast, (traffic::ControlAction{0.0, 0.0, 1.0})) << "no turn error while it brakes";
  PlantPlanner even({}, constantPlant(4.0, 0.0));
  EXPECT_EQ(planOf(even, snapshotOf(8.9)).action.brake, 1.0);
  EXPECT_EQ(planOf(even, snapshotOf(8.7)).action.brake, 0.0);
  PlantPlanner standing({}, constantPlant(0.19, 0.0));
  EXPECT_EQ(planOf(standing, snapshotOf(0.0)).action.brake, 1.0);
  PlantPlanner creeping({}, constantPlant(0.21, 0.0));
  EXPECT_EQ(planOf(creeping, snapshotOf(0.0)).action.brake, 0.0);
}

// While it brakes the steering is half of what the PID asks: after one step with error e = 0.15596
// the next, with none, asks 0.75 e / 20 - 0.3 e = -0.2625 e.
TEST_F(PlantPlannerTest, SteeringIsDampedWhileItBrakes) {
  WaypointTracker tracker((PlantOptions()));
  const PlantWaypoints waypoints = {Eigen::Vector2d(4.0, 1.0), Eigen::Vector2d(8.0, 2.0),
                                    Eigen::Vector2d(12.0, 3.0), Eigen::Vector2d(16.0, 4.0)};
  tracker.track(8.0, waypoints);
  EXPECT_NEAR(tracker.track(20.0, waypoints).steer, 0.5 * -0.2625 * 0.15596, 1e-6);
}

// Weights of 0 attend to every token alike: CLS, two vehicles and two segments.
TEST_F(PlantPlannerTest, SaysWhatItLookedAt) {
  PlantPlanner planner({}, constantPlant(4.0, 0.0));
  const auto planned = planOf(planner, snapshotOf(8.0, {vehicleAt("b", 40.0, 0.0, 0.0, 5.0),
                                                        vehicleAt("a", 20.0, 0.0, 0.0, 5.0)}));
  ASSERT_EQ(planned.attended.size(), 2U);
  EXPECT_EQ(planned.attended[0].vehicle_id, "a") << "nearest first";
  EXPECT_EQ(planned.attended[1].vehicle_id, "b");
  for (const planning::AttendedVehicle& vehicle : planned.attended)
    EXPECT_NEAR(vehicle.weight, 0.2, 1e-6);
}

// What it looks at says whether the network was given another speed: below 4 m/s it is not.
TEST_F(PlantPlannerTest, ItsOwnTokenShowsNoLessThanTheLeastSpeed) {
  PlantArchitecture architecture = testing::smallPlant();
  architecture.own_vehicle = true;
  const auto weightAt = [&](double speed, double least, double speed_of_other = 1.0) {
    PlantOptions options;
    options.least_own_speed = least;
    PlantPlanner planner(options, drawnPlant(0.3, architecture));
    const auto planned =
        planOf(planner, snapshotOf(speed, {vehicleAt("a", 20.0, 0.0, 0.0, speed_of_other)}));
    return planned.attended.at(0).weight;
  };
  EXPECT_EQ(weightAt(0.0, 4.0), weightAt(4.0, 4.0));
  EXPECT_NE(weightAt(0.0, 4.0), weightAt(4.5, 4.0));
  EXPECT_NE(weightAt(0.0, 0.0), weightAt(4.0, 0.0));
  EXPECT_NE(weightAt(0.0, 4.0, 1.0), weightAt(0.0, 4.0, 3.0)) << "others are shown as they are";
  EXPECT_EQ(PlantOptions().least_own_speed, 4.0);
}

TEST_F(PlantPlannerTest, OfMoreVehiclesThanTokensTheNearestCount) {
  std::vector<traffic::Vehicle> others;
  for (int i = 0; i < 6; ++i)
    others.push_back(vehicleAt("v" + std::to_string(i), 45.0 - 5.0 * i, 3.0, 0.0, 5.0));
  PlantPlanner planner({}, drawnPlant(0.3));
  const auto six = planOf(planner, snapshotOf(8.0, others));
  ASSERT_EQ(six.attended.size(), 4U);
  EXPECT_EQ(six.attended[0].vehicle_id, "v5");
  EXPECT_EQ(six.attended[3].vehicle_id, "v2");
  PlantPlanner other({}, drawnPlant(0.3));
  others.erase(others.begin(), others.begin() + 2);
  EXPECT_EQ(planOf(other, snapshotOf(8.0, others)).action, six.action);
}

TEST_F(PlantPlannerTest, AVehicleIsDrivenTheSameToTheBitWhateverOthersAreAskedFor) {
  const auto snapshot =
      snapshotOf(7.0, {vehicleAt("a", 30.0, 0.5, 0.1, 6.0), vehicleAt("b", 60.0, -0.5, -0.1, 5.0)});
  const auto task = [&](int slot) {
    return planning::PlanningTask{slot, &snapshot.vehicles[static_cast<std::size_t>(slot + 1)],
                                  &route_};
  };
  PlantPlanner together({}, drawnPlant(0.3)), alone({}, drawnPlant(0.3));
  const auto all = together.plan(snapshot, {task(-1), task(0), task(1)});
  const auto one = alone.plan(snapshot, {task(1)});
  EXPECT_EQ(all[2].action, one[0].action);
  ASSERT_EQ(all[2].rollout.size(), one[0].rollout.size());
  for (std::size_t i = 0; i < one[0].rollout.size(); ++i)
    EXPECT_EQ(all[2].rollout[i].state.position, one[0].rollout[i].state.position);
  EXPECT_EQ(all[0].vehicle_id, "ego");
  EXPECT_EQ(all[2].slot, 1);
}

TEST_F(PlantPlannerTest, DrivesInAnEmptySceneAndBeyondTheRoutesEnd) {
  PlantPlanner planner({}, drawnPlant(0.3));
  EXPECT_EQ(planOf(planner, snapshotOf(8.0)).fault, "");
  EXPECT_TRUE(planOf(planner, snapshotOf(8.0)).attended.empty());
  for (const double x : {195.0, 200.0, 215.0}) {
    PlantPlanner fresh({}, drawnPlant(0.3));
    auto snapshot = snapshotOf(8.0);
    snapshot.vehicles.front().state.position.x() = x;
    const auto planned = planOf(fresh, snapshot);
    EXPECT_EQ(planned.fault, "") << x;
    EXPECT_TRUE(planned.action.valid()) << x;
  }
}

TEST_F(PlantPlannerTest, WithoutARouteItBrakes) {
  PlantPlanner planner({}, constantPlant(4.0, 0.0));
  const auto snapshot = snapshotOf(8.0);
  const map::Route empty;
  for (const map::Route* route : {static_cast<const map::Route*>(nullptr), &empty}) {
    const auto planned = planner.plan(snapshot, {{-1, &snapshot.vehicles.front(), route}}).at(0);
    EXPECT_EQ(planned.fault, "vehicle 'ego': it has no route; full braking instead");
    EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
  }
}

TEST_F(PlantPlannerTest, AStateThatIsNotFiniteIsAFaultAndFullBraking) {
  PlantPlanner planner({}, constantPlant(4.0, 0.0));
  auto own = snapshotOf(std::nan(""));
  EXPECT_EQ(planOf(planner, own).fault,
            "vehicle 'ego': its state is not finite; full braking instead");
  auto snapshot = snapshotOf(8.0, {vehicleAt("a", 20.0, std::nan(""), 0.0, 5.0)});
  const auto planned = planOf(planner, snapshot);
  EXPECT_EQ(planned.fault, "vehicle 'ego': the state of 'a' is not finite; full braking instead");
  EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
  snapshot.vehicles[1].state.position.y() = 0.0;
  EXPECT_EQ(planOf(planner, snapshot).fault, "") << "it goes on when all is well again";
}

// Squares of 3e38 overflow in the first normalization.
TEST_F(PlantPlannerTest, APlanThatIsNotFiniteIsAFaultAndFullBraking) {
  PlantModel model = drawnPlant(0.3);
  model.weights.at("token.bias").values.assign(32, 3e38F);
  model.weights.at("token.bias").values[0] = -3e38F;
  PlantPlanner planner({}, model);
  const auto planned = planOf(planner, snapshotOf(8.0));
  EXPECT_EQ(planned.fault,
            "vehicle 'ego': a waypoint of its plan is not finite; full braking instead");
  EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
}

TEST_F(PlantPlannerTest, MissingWeightsAreNamedWithTheCommandThatTrainsThem) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path().string();
  EXPECT_EQ(refusal(path), "planner 'plant' has no weights: there is no file '" + path +
                               "/plant.safetensors'; train them with cdiff train --task plant "
                               "--data FOLDER --output " +
                               path + ", or name a folder that holds them (plant.weights)");
}

TEST_F(PlantPlannerTest, WeightsOfAnotherPlannerOrOtherSizesAreRefused) {
  const test::TemporaryFolder folder;
  const PlantModel model = drawnPlant(0.1);
  testing::writePlant(folder.path(), model);
  EXPECT_EQ(refusal(folder.path().string()), "made");
  inference::SafetensorsFile file{networkMetadata(kPlant, model.architecture), model.weights};
  const auto refusalOf = [&] {
    inference::writeSafetensors(folder.path() / kPlant.file, file, inference::TensorType::kF32);
    return refusal(folder.path().string());
  };
  file.metadata["format"] = "e2e_cdiff.denoiser.1";
  EXPECT_NE(refusalOf().find("its format is 'e2e_cdiff.denoiser.1', not 'e2e_cdiff.plant.1': these "
                             "are not weights of this version's planner 'plant'"),
            std::string::npos);
  file.metadata.erase("format");
  EXPECT_NE(refusalOf().find("its format is not named"), std::string::npos);
  file.metadata = networkMetadata(kPlant, model.architecture);
  file.metadata["architecture"] += "depth: 3\n";
  EXPECT_NE(refusalOf().find("depth"), std::string::npos);
  PlantArchitecture wider = model.architecture;
  wider.width = 64;
  file.metadata = networkMetadata(kPlant, wider);
  EXPECT_NE(refusalOf().find("has shape"), std::string::npos);
  file.metadata.erase("architecture");
  EXPECT_NE(refusalOf().find("lacks the key 'architecture'"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::planners
