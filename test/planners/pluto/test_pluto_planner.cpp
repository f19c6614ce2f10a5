// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/pluto/pluto_course.h"
#include "planners/registry.h"

namespace cdiff::planners {
namespace {

using testing::PlutoCourse;

bool sameAction(const planning::PlannedAction& a, const planning::PlannedAction& b) {
  if (!(a.action == b.action) || a.rollout.size() != b.rollout.size()) return false;
  for (std::size_t i = 0; i < a.rollout.size(); ++i) {
    if (a.rollout[i].state.position != b.rollout[i].state.position) return false;
  }
  return true;
}

// exp(0), exp(-1), exp(-2): of the two largest 1 / (1 + 1/e) = 0.7311 and 0.2689.
TEST(PlutoChoice, SharesProbabilityAmongTheLargestLogits) {
  const PlutoChoice choice = choosePlan({1.0F, 3.0F, 2.0F}, 2, 0.25);
  ASSERT_EQ(choice.scores.size(), 4U);
  EXPECT_EQ(choice.scores[0], 0.0);
  EXPECT_NEAR(choice.scores[1], 0.731059, 1e-6);
  EXPECT_NEAR(choice.scores[2], 0.268941, 1e-6);
  EXPECT_EQ(choice.scores[3], 0.25);
  EXPECT_EQ(choice.index, 1U);
}

// Of five equal candidates each has 0.2, less than the free plan; of four the first wins the tie.
TEST(PlutoChoice, TheFreePlanWinsWhereNoCandidateIsLikely) {
  EXPECT_EQ(choosePlan(std::vector<float>(5, 0.0F), 10, 0.25).index, 5U);
  EXPECT_EQ(choosePlan(std::vector<float>(4, 0.0F), 10, 0.25).index, 0U);
}

TEST_F(PlutoCourse, GivesAllCandidatesWithTheirScores) {
  PlutoPlanner planner = makePlanner();
  const auto actions = planner.plan(snapshot_, tasks());
  ASSERT_EQ(actions.size(), 2U);
  for (const planning::PlannedAction& action : actions) {
    EXPECT_TRUE(action.fault.empty()) << action.fault;
    EXPECT_EQ(action.rollout.size(), 80U);
    ASSERT_EQ(action.candidates.size(), 13U) << "one line of 12 modes, and the free plan";
    double sum = 0.0;
    int chosen = 0;
    for (const planning::PlannedCandidate& candidate : action.candidates) {
      ASSERT_EQ(candidate.places.size(), 16U) << "8 s, every 0.5 s";
      sum += candidate.score;
      if (!candidate.chosen) continue;
      ++chosen;
      for (std::size_t i = 0; i < 16; ++i)
        EXPECT_EQ(candidate.places[i], action.rollout[5 * i + 4].state.position) << i;
    }
    EXPECT_EQ(chosen, 1);
    EXPECT_NEAR(sum, 1.25, 1e-9);
  }
}

TEST_F(PlutoCourse, ADecisionDependsOnNothingButItsCalls) {
  PlutoPlanner first = makePlanner();
  PlutoPlanner second = makePlanner();
  for (int i = 0; i < 4; ++i, advance()) {
    const auto one = first.plan(snapshot_, tasks());
    const auto two = second.plan(snapshot_, tasks());
    for (std::size_t n = 0; n < 2; ++n) EXPECT_TRUE(sameAction(one[n], two[n])) << i;
  }
}

TEST_F(PlutoCourse, AVehicleIsPlannedAsIfItWereAlone) {
  PlutoPlanner both = makePlanner();
  PlutoPlanner single = makePlanner();
  for (int i = 0; i < 3; ++i, advance()) {
    const auto all = both.plan(snapshot_, tasks());
    const auto one = single.plan(snapshot_, {tasks()[1]});
    EXPECT_TRUE(sameAction(all[1], one[0])) << i;
  }
}

TEST_F(PlutoCourse, TheHistoryCounts) {
  PlutoPlanner old = makePlanner();
  for (int i = 0; i < 5; ++i, advance()) old.plan(snapshot_, tasks());
  PlutoPlanner fresh = makePlanner();
  EXPECT_FALSE(sameAction(old.plan(snapshot_, tasks())[0], fresh.plan(snapshot_, tasks())[0]));
}

// Each joins what its query found with the vehicle's own token.
TEST_F(PlutoCourse, AllCandidatesDependOnTheSpeed) {
  PlutoPlanner planner = makePlanner();
  const auto slow = planner.plan(snapshot_, tasks())[0].candidates;
  snapshot_.vehicles[1].state.speed = 7.0;
  PlutoPlanner other = makePlanner();
  const auto fast = other.plan(snapshot_, tasks())[0].candidates;
  ASSERT_EQ(slow.size(), fast.size());
  for (std::size_t i = 0; i < slow.size(); ++i)
    EXPECT_GT((slow[i].places.back() - fast[i].places.back()).norm(), 1e-3) << i;
}

TEST_F(PlutoCourse, BrakesWhereAStateIsNotFinite) {
  PlutoPlanner planner = makePlanner();
  planner.plan(snapshot_, tasks());
  advance();
  snapshot_.vehicles[0].state.speed = std::numeric_limits<double>::quiet_NaN();
  for (const auto& action : planner.plan(snapshot_, tasks())) {
    EXPECT_EQ(action.action, traffic::ControlAction::failSafe());
    EXPECT_EQ(action.fault, "vehicle '" + action.vehicle_id +
                                "': the state of 'ego' is not finite; full braking instead");
  }
  snapshot_.vehicles[0].state.speed = 5.0;
  advance();
  EXPECT_TRUE(planner.plan(snapshot_, tasks())[0].fault.empty()) << "goes on";
}

// max(0, x) would make numbers of it again, and a plan of those.
TEST_F(PlutoCourse, BrakesWhereItsAccelerationIsNotFinite) {
  PlutoPlanner planner = makePlanner();
  const std::string driven = tasks()[0].vehicle->id;
  for (traffic::Vehicle& vehicle : snapshot_.vehicles) {
    if (vehicle.id == driven) vehicle.acceleration = std::numeric_limits<double>::quiet_NaN();
  }
  const planning::PlannedAction planned = planner.plan(snapshot_, tasks())[0];
  EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
  EXPECT_EQ(planned.fault,
            "vehicle '" + driven + "': its acceleration is not finite; full braking instead");
}

TEST_F(PlutoCourse, BrakesOutsideTheSnapshot) {
  PlutoPlanner planner = makePlanner();
  const traffic::Vehicle gone = testing::vehicleAt("gone", 20.0, 0.0, 0.0, 5.0);
  const planning::PlannedAction planned = planner.plan(snapshot_, {{0, &gone, &route_, 8.0}})[0];
  EXPECT_EQ(planned.action, traffic::ControlAction::failSafe());
  EXPECT_EQ(planned.fault, "vehicle 'gone': it is not in the snapshot; full braking instead");
}

// With a score of 1 it is chosen; its speeds are the ways of 0.1 s.
TEST_F(PlutoCourse, TheFreePlanIsAsFastAsItsPlacesAreApart) {
  PlutoOptions options;
  options.free_score = 1.0;
  PlutoPlanner planner(options, testing::randomPluto(), network_, 0.1);
  const planning::PlannedAction planned = planner.plan(snapshot_, tasks())[0];
  ASSERT_TRUE(planned.candidates.back().chosen);
  Eigen::Vector2d last = snapshot_.vehicles[1].state.position;
  for (const planning::RolloutPoint& point : planned.rollout) {
    EXPECT_NEAR(point.state.speed, (point.state.position - last).norm() / 0.1, 1e-9);
    last = point.state.position;
  }
}

TEST_F(PlutoCourse, BrakesWithoutARoute) {
  PlutoPlanner planner = makePlanner();
  auto asked = tasks();
  asked[0].route = nullptr;
  const auto actions = planner.plan(snapshot_, asked);
  EXPECT_EQ(actions[0].fault, "vehicle 'cbv1': it has no route; full braking instead");
  EXPECT_TRUE(actions[1].fault.empty());
}

TEST_F(PlutoCourse, PlansAloneInCrowdsOffTheRoadAndAtTheEndOfTheRoute) {
  PlutoPlanner planner = makePlanner();
  snapshot_.vehicles.erase(snapshot_.vehicles.begin());
  snapshot_.vehicles.resize(1);
  const auto lonely = [&](double x, double y) {
    snapshot_.time += 1.0;
    snapshot_.vehicles[0].state.position = {x, y};
    return planner.plan(snapshot_, {{0, &snapshot_.vehicles[0], &route_, 8.0}})[0];
  };
  for (const auto& [x, y] : {std::make_pair(0.0, 0.0), std::make_pair(249.5, 0.0),
                             std::make_pair(260.0, 0.0), std::make_pair(0.0, 400.0)}) {
    const auto action = lonely(x, y);
    EXPECT_TRUE(action.fault.empty()) << action.fault;
    EXPECT_TRUE(action.action.valid());
  }
  for (int i = 0; i < 60; ++i)
    snapshot_.vehicles.push_back(
        testing::vehicleAt("v" + std::to_string(i), 10.0 + i, 3.0, 0.0, 1.0));
  EXPECT_TRUE(lonely(0.0, 0.0).fault.empty());
}

class PlutoWeights : public PlutoCourse {
 protected:
  std::string errorOf(double period = 0.1) {
    planning::PlannerOptionsTable options = defaultOptions();
    options.of<PlutoOptions>().weights = folder_.path().string();
    planning::PlanningContext context{network_, area_};
    context.decision_period = period;
    try {
      planners::makePlanner("pluto", {context, options, vehicle_, camera_, guidance_});
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "made";
  }

  test::TemporaryFolder folder_;
  map::DrivableArea area_{network_};
  dynamics::BicycleModelOptions vehicle_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
};

TEST_F(PlutoWeights, AreReadFromTheirFolder) {
  testing::writePluto(folder_.path(), kPluto, kPluto.format);
  EXPECT_EQ(errorOf(), "made");
}

TEST_F(PlutoWeights, ThatAreMissingAreNamedWithTheCommandThatTrainsThem) {
  const std::string text = errorOf();
  EXPECT_NE(text.find("planner 'pluto' has no weights: there is no file '"), std::string::npos)
      << text;
  EXPECT_NE(text.find("cdiff train --task pluto --data FOLDER"), std::string::npos) << text;
}

TEST_F(PlutoWeights, OfAnotherPlannerAreRefused) {
  testing::writePluto(folder_.path(), kPluto, kRift.format);
  const std::string text = errorOf();
  EXPECT_NE(text.find("its format is 'e2e_cdiff.rift.1', not 'e2e_cdiff.pluto.1'"),
            std::string::npos)
      << text;
}

TEST_F(PlutoWeights, KnowOneDecisionPeriodOnly) {
  testing::writePluto(folder_.path(), kPluto, kPluto.format);
  EXPECT_EQ(errorOf(0.2),
            "key 'decision_period' is 0.2 s; planner 'pluto' was trained for 0.1 s and knows no "
            "other");
}

}  // namespace
}  // namespace cdiff::planners
