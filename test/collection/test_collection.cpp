// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collection/collection_loop.h"
#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "collection/displaced_samples.h"
#include "collection/traffic_driver.h"
#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/error_text.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"
#include "support/temporary_folder.h"

namespace cdiff::collection {
namespace {

using test::Motion;

/// A road of 600 m along x, 4 m wide, and a driver of two vehicles on it.
struct Road {
  Road() { options.vehicles = 2; }
  TrafficDriver driver() const { return TrafficDriver(options, graph, area, 1); }

  map::RoadNetwork network = test::NetworkText().edge("road", {"0,0 600,0"}).network();
  map::LaneGraph graph{network};
  map::DrivableArea area{network};
  CollectionOptions options;
};

traffic::TrafficSnapshot snapshotWith(double time, const std::vector<traffic::Vehicle>& others) {
  auto snapshot = test::snapshotWithEgo(static_cast<std::uint64_t>(std::llround(time / 0.05)),
                                        {80.0, 0.0, 0.0, 8.0});
  snapshot.vehicles.insert(snapshot.vehicles.end(), others.begin(), others.end());
  return snapshot;
}

TEST(TrafficDriver, FillsItsSlotsNearestFirstWithThoseThatHaveARoute) {
  const Road road;
  TrafficDriver driver = road.driver();
  // c is nearest to the ego (15 m), then b (20 m), then a (30 m); d has only 40 m of road left.
  const auto selection = driver.update(snapshotWith(
      0.0,
      {test::vehicle("a", {50.0, 0.0, 0.0, 8.0}), test::vehicle("b", {100.0, 0.0, 0.0, 8.0}),
       test::vehicle("c", {65.0, 0.0, 0.0, 8.0}), test::vehicle("d", {560.0, 0.0, 0.0, 8.0})}));
  ASSERT_EQ(selection.assignments.size(), 2u);
  EXPECT_EQ(selection.assignments[0].vehicle_id, "c");
  EXPECT_EQ(selection.assignments[1].vehicle_id, "b");
  // 250 m as wished, from the vehicle's place on.
  EXPECT_NEAR(selection.assignments[1].conflict_aware_route.length(), 250.0, 1.0);
  EXPECT_NEAR(selection.assignments[1].conflict_aware_route.path().positionAt(0.0).x(), 100.0, 0.1);
}

TEST(TrafficDriver, LeavesOutVehiclesWithTooLittleRoadAhead) {
  const Road road;
  TrafficDriver driver = road.driver();
  auto snapshot = snapshotWith(0.0, {test::vehicle("d", {490.0, 0.0, 0.0, 8.0})});
  snapshot.vehicles.front().state.position.x() = 450.0;
  EXPECT_TRUE(driver.update(snapshot).assignments.empty()) << "110 m of road, 120 m needed";
}

TEST(TrafficDriver, ReleasesNearTheEndOfTheRoute) {
  const Road road;
  TrafficDriver driver = road.driver();
  double released_at = 0.0;
  for (int i = 0; i < 30 && released_at == 0.0; ++i) {
    const double x = 100.0 + 10.0 * i;
    const auto selection =
        driver.update(snapshotWith(0.1 * i, {test::vehicle("b", {x, 0.0, 0.0, 8.0})}));
    if (selection.released.empty()) continue;
    released_at = x;
    EXPECT_EQ(selection.released.front().vehicle_id, "b");
    EXPECT_STREQ(selection.released.front().reason.c_str(), "route_end");
    EXPECT_TRUE(selection.assignments.empty()) << "not again at once";
  }
  // The route ends at 350: at 310 there are 40 m left, at 320 less.
  EXPECT_EQ(released_at, 320.0);
}

/// Reason of release when, after the first decision, everything is as in `later`.
std::string reasonAfter(const traffic::TrafficSnapshot& later) {
  const Road road;
  TrafficDriver driver = road.driver();
  driver.update(snapshotWith(0.0, {test::vehicle("b", {100.0, 0.0, 0.0, 8.0})}));
  const auto selection = driver.update(later);
  return selection.released.empty() ? "" : selection.released.front().reason;
}

TEST(TrafficDriver, ReleasesWhatLeavesTheRoadTouchesOrIsGone) {
  // The road ends at y = 2: 4.9 is 2.9 m outside, 5.1 is 3.1 m outside.
  EXPECT_EQ(reasonAfter(snapshotWith(0.1, {test::vehicle("b", {101.0, 4.9, 0.0, 8.0})})), "");
  EXPECT_EQ(reasonAfter(snapshotWith(0.1, {test::vehicle("b", {101.0, 5.1, 0.0, 8.0})})),
            "left_road");
  EXPECT_EQ(reasonAfter(snapshotWith(0.1, {})), "gone");
  auto touching = snapshotWith(0.1, {test::vehicle("b", {101.0, 0.0, 0.0, 8.0})});
  touching.contacts.push_back({"b", "ego"});
  EXPECT_EQ(reasonAfter(touching), "contact");
}

TEST(TrafficDriver, ReleasesAfterStandingAndDrivesAgainAfterThePause) {
  const Road road;
  TrafficDriver driver = road.driver();
  const auto at = [&](double time) {
    return driver.update(snapshotWith(time, {test::vehicle("b", {100.0, 0.0, 0.0, 0.0})}));
  };
  at(0.0);
  at(0.1);  // stands from here on
  EXPECT_TRUE(at(8.05).released.empty());
  ASSERT_EQ(at(8.15).released.size(), 1u);
  EXPECT_TRUE(at(11.1).assignments.empty()) << "the pause of 3 s ends at 11.15";
  EXPECT_EQ(at(11.2).assignments.size(), 1u);
}

/// Always the same action; remembers what it was asked.
class Steady : public planning::Planner {
 public:
  explicit Steady(std::vector<planning::PlanningTask>* asked = nullptr) : asked_(asked) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot&, const std::vector<planning::PlanningTask>& tasks) override {
    std::vector<planning::PlannedAction> actions;
    for (const planning::PlanningTask& task : tasks) {
      if (asked_ != nullptr) asked_->push_back(task);
      actions.push_back({task.slot, task.vehicle->id, {0.5, 0.1, 0.0}, {}});
    }
    return actions;
  }

 private:
  std::vector<planning::PlanningTask>* asked_;
};

struct Noise {
  std::vector<traffic::ControlAction> actions;
  std::vector<bool> marks;
};

Noise noiseOf(std::uint64_t seed, double speed, int decisions, double stall_share = 0.0) {
  CollectionOptions options;
  options.noise.stall_share = stall_share;
  PerturbedPlanner planner(std::make_unique<Steady>(), options, seed, 0.1);
  Noise noise;
  for (int i = 0; i < decisions; ++i) {
    const auto snapshot = snapshotWith(0.1 * i, {test::vehicle("b", {0.0, 0.0, 0.0, speed})});
    const auto actions = planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0}});
    noise.actions.push_back(actions.front().action);
    noise.marks.push_back(planner.perturbed().count("b") != 0);
  }
  return noise;
}

TEST(PerturbedPlanner, MarksExactlyTheActionsThatItChanges) {
  const Noise noise = noiseOf(1, 8.0, 6000);
  int marked = 0;
  for (std::size_t i = 0; i < noise.actions.size(); ++i) {
    const bool changed = !(noise.actions[i] == traffic::ControlAction{0.5, 0.1, 0.0});
    EXPECT_EQ(changed, noise.marks[i]) << i;
    EXPECT_TRUE(noise.actions[i].valid());
    // At 8 m/s at most 0.45 x 3.5 / 8.
    EXPECT_LE(std::abs(noise.actions[i].steer - 0.1), 0.45 * 3.5 / 8.0 + 1e-12);
    marked += noise.marks[i];
  }
  // Bursts of 0.55 s, 6 s apart on average: 8.4 %; with some 90 bursts in 600 s +- 1 %.
  EXPECT_GT(marked, 300);
  EXPECT_LT(marked, 720);
}

TEST(PerturbedPlanner, AStallBrakesToItsEndEvenWhereTheVehicleStands) {
  CollectionOptions options;
  options.noise.stall_share = 1.0;
  PerturbedPlanner planner(std::make_unique<Steady>(), options, 1, 0.1);
  double speed = 8.0;
  std::vector<int> stops = {0};  // decisions each
  for (int i = 0; i < 3000; ++i) {
    const auto snapshot = snapshotWith(0.1 * i, {test::vehicle("b", {0.0, 0.0, 0.0, speed})});
    const auto action =
        planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0}}).front().action;
    const bool stalled = planner.perturbed().count("b") != 0;
    EXPECT_EQ(action, stalled ? (traffic::ControlAction{0.0, 0.1, 0.5})
                              : (traffic::ControlAction{0.5, 0.1, 0.0}));
    if (stalled) ++stops.back();
    if (!stalled && stops.back() > 0) stops.push_back(0);
    speed = stalled ? std::max(0.0, speed - 0.4) : 8.0;
  }
  ASSERT_GT(stops.size(), 10U);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    EXPECT_GE(stops[i], 29) << "3 s";
    EXPECT_LE(stops[i], 61) << "6 s";
  }
}

TEST(PerturbedPlanner, AStallThatFindsAStandingVehicleIsLeftOut) {
  CollectionOptions options;
  options.noise.stall_share = 1.0;
  options.noise.interval = 5.0;
  options.noise.stall_minimum_time = options.noise.stall_maximum_time = 60.0;
  PerturbedPlanner planner(std::make_unique<Steady>(), options, 1, 0.1);
  int marked = 0;
  for (int i = 0; i <= 100; ++i) {
    // Several stalls would have begun while it stands; they are over when it moves.
    const double speed = i < 100 ? 0.0 : 5.0;
    const auto snapshot = snapshotWith(0.1 * i, {test::vehicle("b", {0.0, 0.0, 0.0, speed})});
    planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0}});
    marked += !planner.perturbed().empty();
  }
  EXPECT_EQ(marked, 0);
}

/// A policy that is told from the planner it takes turns with.
class Turning : public planning::Planner {
 public:
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot&, const std::vector<planning::PlanningTask>& tasks) override {
    std::vector<planning::PlannedAction> actions;
    for (const planning::PlanningTask& task : tasks)
      actions.push_back({task.slot, task.vehicle->id, {0.0, -0.7, 0.0}, {}});
    return actions;
  }
};

TEST(PerturbedPlanner, APolicyDrivesInItsTurnsWhichCountAsNoise) {
  CollectionOptions options;
  options.noise.interval = 1e9;
  options.policy_share = 1.0;
  PerturbedPlanner planner(std::make_unique<Steady>(), options, 1, 0.1,
                           {std::make_unique<Turning>(), nullptr});
  std::map<std::string, std::vector<int>> turns;  // decisions of each
  std::map<std::string, bool> drove;
  for (int i = 0; i < 4000; ++i) {
    const auto snapshot = snapshotWith(0.1 * i, {test::vehicle("a", {0.0, 0.0, 0.0, 5.0}),
                                                 test::vehicle("b", {9.0, 0.0, 0.0, 5.0})});
    const auto actions = planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0},
                                                 {1, &snapshot.vehicles[2], nullptr, 8.0}});
    for (const planning::PlannedAction& action : actions) {
      const std::string& id = action.vehicle_id;
      const bool policy = action.action.steer == -0.7;
      EXPECT_EQ(policy, planner.policyDrives(id, snapshot.time));
      EXPECT_EQ(policy, planner.perturbed().count(id) != 0);
      if (policy && !drove[id]) turns[id].push_back(0);
      if (policy) ++turns[id].back();
      drove[id] = policy;
    }
  }
  for (const char* id : {"a", "b"}) {
    ASSERT_NEAR(static_cast<double>(turns[id].size()), 50.0, 1.0) << "one each 8 s";
    for (std::size_t i = 1; i + 1 < turns[id].size(); ++i) {
      EXPECT_GE(turns[id][i], 9) << "1 s";
      EXPECT_LE(turns[id][i], 41) << "4 s";
    }
  }
  EXPECT_NE(turns["a"], turns["b"]);
}

TEST(PerturbedPlanner, WithoutAPolicyNoneTakesTurns) {
  PerturbedPlanner planner(std::make_unique<Steady>(), {}, 1, 0.1);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(planner.policyDrives("a", 0.1 * i));
}

TEST(DisplacedSample, TheImageBeforeIsSeenFromWhereTheVehicleWouldHaveBeen) {
  traffic::VehicleState before;
  before.position = {10.0, 4.0};
  before.heading = 0.1;
  traffic::VehicleState here = before;
  here.position = {12.0, 4.2};
  EXPECT_NEAR((displacedAlike(before, here, here).position - before.position).norm(), 0.0, 1e-12);
  traffic::VehicleState beside = here;
  beside.position += Eigen::Vector2d(-0.5, 0.5);
  beside.heading += 0.2;
  const traffic::VehicleState moved = displacedAlike(before, here, beside);
  // It saw the same of its own motion.
  EXPECT_NEAR((beside.pose().toBody(moved.position) - here.pose().toBody(before.position)).norm(),
              0.0, 1e-12);
  EXPECT_NEAR(moved.heading, 0.3, 1e-12);
}

TEST(CollectionOptions, AStallMustEndBeforeAStandingVehicleIsReleased) {
  CollectionOptions options;
  options.standing_time = 5.0;
  EXPECT_THROW(options.validate(), core::InputError);
  options.noise.stall_share = 0.0;
  options.validate();
}

TEST(PerturbedPlanner, IsDeterministicAndLeavesStandingVehiclesAlone) {
  EXPECT_EQ(noiseOf(1, 8.0, 600).actions, noiseOf(1, 8.0, 600).actions);
  EXPECT_NE(noiseOf(1, 8.0, 600).actions, noiseOf(2, 8.0, 600).actions);
  const Noise standing = noiseOf(1, 0.0, 600);
  EXPECT_EQ(std::count(standing.marks.begin(), standing.marks.end(), true), 0);
}

// One of two drives on without a break, the other is not driven from 1 s to 60 s, and no one asks
// in between: it starts as a vehicle does that was never driven.
TEST(PerturbedPlanner, NoiseStartsOverAfterDecisionsWithoutTheVehicle) {
  PerturbedPlanner planner(std::make_unique<Steady>(), {}, 1, 0.1);
  PerturbedPlanner fresh(std::make_unique<Steady>(), {}, 1, 0.1);
  const auto plan = [](PerturbedPlanner& with, int decision) {
    const auto snapshot = snapshotWith(0.1 * decision, {test::vehicle("b", {0.0, 0.0, 0.0, 8.0})});
    return with.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0}}).front().action;
  };
  for (int i = 0; i < 10; ++i) plan(planner, i);
  int noisy = 0;
  for (int i = 600; i < 1200; ++i) {
    EXPECT_EQ(plan(planner, i), plan(fresh, i)) << i;
    noisy += !fresh.perturbed().empty();
  }
  EXPECT_GT(noisy, 0);
}

// Every fifth decision, one slot after the other: decision + slot + 1 is a multiple of 5.
TEST(ImageSchedule, TakesTurnsAndLooksAfterDisturbances) {
  traffic::Vehicle driven = test::vehicle("a", {});
  driven.applied_action = traffic::ControlAction();
  const auto turns = [&](int slot, std::int64_t noisy_at) {
    ImageSchedule schedule(5);
    std::vector<std::int64_t> due;
    for (std::int64_t i = 0; i < 12; ++i) {
      if (schedule.due(driven, slot, i, i == noisy_at)) due.push_back(i);
    }
    return due;
  };
  using Turns = std::vector<std::int64_t>;
  EXPECT_EQ(turns(-1, -1), (Turns{0, 5, 10}));
  EXPECT_EQ(turns(0, -1), (Turns{4, 9}));
  EXPECT_EQ(turns(1, -1), (Turns{3, 8}));
  // One and four decisions after the noise of decision 5.
  EXPECT_EQ(turns(0, 5), (Turns{4, 6, 9}));
  EXPECT_EQ(turns(1, 5), (Turns{3, 6, 8, 9}));
}

TEST(ImageSchedule, TakesNoneAtTheTakeOverAndOneAfterIt) {
  traffic::Vehicle vehicle = test::vehicle("a", {});
  ImageSchedule schedule(100);
  EXPECT_FALSE(schedule.due(vehicle, 0, 99, false)) << "its turn, but nothing drives it yet";
  vehicle.applied_action = traffic::ControlAction();
  EXPECT_TRUE(schedule.due(vehicle, 0, 100, false));
  EXPECT_FALSE(schedule.due(vehicle, 0, 101, false));
}

/// What two vehicles are asked in two decisions.
std::vector<planning::PlanningTask> askedWith(const CollectionOptions& options) {
  std::vector<planning::PlanningTask> asked;
  PerturbedPlanner planner(std::make_unique<Steady>(&asked), options, 1, 0.1);
  const auto snapshot = snapshotWith(0.0, {test::vehicle("a", {}), test::vehicle("b", {})});
  for (int i = 0; i < 2; ++i) {
    planner.plan(snapshot, {{0, &snapshot.vehicles[1], nullptr, 8.0},
                            {1, &snapshot.vehicles[2], nullptr, 8.0}});
  }
  return asked;
}

TEST(PerturbedPlanner, GivesEachVehicleOneTargetSpeedInRange) {
  const auto asked = askedWith(CollectionOptions());
  ASSERT_EQ(asked.size(), 4u);
  for (std::size_t i : {0, 1}) {
    EXPECT_EQ(asked[i].target_speed, asked[i + 2].target_speed);
    EXPECT_GE(asked[i].target_speed, 5.0);
    EXPECT_LE(asked[i].target_speed, 12.0);
  }
  EXPECT_NE(asked[0].target_speed, asked[1].target_speed);
}

TEST(DisturbedStart, MovesSidewaysAndTurnsWithinTwoStandardDeviations) {
  traffic::VehicleState state;
  state.position = {10.0, 20.0};  // heading along x: sideways is y
  double largest = 0.0;
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    const auto start = disturbedStart(NoiseOptions(), 1, tick, "a", state);
    EXPECT_NEAR(start.position.x(), 10.0, 1e-12);
    EXPECT_LE(std::abs(start.position.y() - 20.0), 0.8 + 1e-12);
    EXPECT_LE(std::abs(start.heading), core::degreesToRadians(10.0) + 1e-12);
    largest = std::max(largest, std::abs(start.position.y() - 20.0));
  }
  EXPECT_GT(largest, 0.3);
}

TEST(CollectionOptions, ContradictionsAreInputErrors) {
  CollectionOptions options;
  options.minimum_speed = 13.0;
  EXPECT_THROW(options.validate(), core::InputError);
  options = {};
  options.noise.stall_minimum_time = 7.0;
  EXPECT_THROW(options.validate(), core::InputError);
  options = {};
  options.minimum_acceleration = 4.0;
  EXPECT_THROW(options.validate(), core::InputError);
}

TEST(CollectionScenario, TheExpertDrivesInPlaceOfPlannersThatSee) {
  session::ScenarioOptions scenario;
  scenario.ego_planner = "two_stage_pid";
  scenario.cbv_planner = "diffusion";
  const session::ScenarioOptions collected = collectionScenario(scenario, {});
  ASSERT_FALSE(planners::seesImages(session::ScenarioOptions().ego_planner));
  EXPECT_EQ(collected.cbv_planner, session::ScenarioOptions().ego_planner);
  EXPECT_EQ(collected.ego_planner, session::ScenarioOptions().ego_planner);
}

// The file need not even be there.
TEST(CollectionScenario, RoutesOfBench2DriveAreRefused) {
  CollectRequest request;
  request.scenario = "crossing_straight";
  EXPECT_NO_THROW(resolveCollection(request));
  request.set = {"route.bench2drive_file=b2d.xml"};
  try {
    resolveCollection(request);
    FAIL() << "nothing was thrown";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("are for evaluation"), std::string::npos);
  }
}

TEST(DatasetStatistics, AFileThatHoldsNoneIsNamedInPlainWords) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "statistics.json";
  for (const std::string& text : {std::string("{"), std::string("{}"), std::string("[1]"),
                                  std::string(300000, '[') + std::string(300000, ']')}) {
    core::writeFileAtomically(file, text);
    const std::string error = test::errorOf([&] { readStatistics(file); });
    EXPECT_NE(error.find(file.string()), std::string::npos) << error;
    EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
  }
}

TEST(CollectionScenario, EndsByTheDurationUnderEveryProtocol) {
  for (const std::string& preset : session::shippedProtocols()) {
    session::ScenarioOptions scenario;
    scenario.protocol = session::loadProtocol(preset);
    CollectionOptions options;
    options.duration = 25.0;
    const session::SessionSetup setup(session::loadScenario("crossing_straight"));
    const session::ProtocolOptions protocol = collectionScenario(scenario, options).protocol;
    EXPECT_EQ(session::longestTime(protocol, setup.egoRoute()), 25.0) << preset;
    EXPECT_EQ(protocol.deviation_percent, 100.0) << preset;
  }
}

}  // namespace
}  // namespace cdiff::collection
