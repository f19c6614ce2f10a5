// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/closed_loop.h"
#include "session/session_request.h"
#include "support/real_data.h"

namespace cdiff::session {
namespace {

using traffic::SessionStatus;
using traffic::VehicleRole;

ScenarioOptions scenarioWith(const std::string& name, const std::vector<std::string>& set) {
  SessionRequest request;
  request.scenario = name;
  request.cbv_planner = "pdm_lite";  // unless `set` names another
  request.set = set;
  return resolveRequest(request);
}

/// Keeps the whole course of a session as text, and counts.
class Course : public SessionObserver {
 public:
  void observe(const TickRecord& record) override {
    const traffic::TrafficSnapshot& snapshot = *record.snapshot;
    EXPECT_EQ(snapshot.tick, ticks_++);
    for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
      text_ << snapshot.tick << vehicle.id << toText(vehicle.role)
            << core::formatNumber(vehicle.state.position.x())
            << core::formatNumber(vehicle.state.position.y())
            << core::formatNumber(vehicle.state.heading) << core::formatNumber(vehicle.state.speed)
            << "\n";
      cbv_ticks_ += vehicle.role == VehicleRole::kCbv;
    }
    for (const traffic::Fault& fault : snapshot.faults) faults_.push_back(fault);
    last_ = snapshot;
  }
  std::string hash() const { return core::sha256(text_.str()); }

  std::uint64_t ticks_ = 0;
  std::size_t cbv_ticks_ = 0;
  std::vector<traffic::Fault> faults_;
  traffic::TrafficSnapshot last_;

 private:
  std::ostringstream text_;
};

Course runScenario(const ScenarioOptions& options) {
  const SessionSetup setup(options);
  ClosedLoop loop(setup);
  Course course;
  loop.addObserver(course);
  const std::atomic<bool> stop{false};
  loop.run(stop);
  return course;
}

class Determinism : public testing::TestWithParam<std::string> {};

TEST_P(Determinism, SameSeedSameCourseOtherSeedDiffers) {
  const Course first = runScenario(scenarioWith(GetParam(), {"seed=1"}));
  const Course second = runScenario(scenarioWith(GetParam(), {"seed=1"}));
  const Course other = runScenario(scenarioWith(GetParam(), {"seed=2"}));
  EXPECT_GT(first.ticks_, 100u);
  EXPECT_EQ(first.hash(), second.hash());
  EXPECT_NE(first.hash(), other.hash());
}

TEST(ClosedLoop, DiffusionPlannerDrivesTwoCbvsToTheSameBytes) {
  const std::vector<std::string> set = {"cbv_planner=diffusion", "protocol.time_limit=12"};
  const Course first = runScenario(scenarioWith("roundabout_cross", set));
  const Course second = runScenario(scenarioWith("roundabout_cross", set));
  EXPECT_EQ(first.hash(), second.hash());
  EXPECT_GT(first.cbv_ticks_, 60u);
  EXPECT_TRUE(first.faults_.empty());
  const Course rules = runScenario(scenarioWith("roundabout_cross", {"protocol.time_limit=12"}));
  EXPECT_NE(first.hash(), rules.hash());
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Determinism,
                         testing::Values("crossing_left_turn", "roundabout_entry"));

TEST(ClosedLoop, DrivesCbvsAndCompletes) {
  const Course course = runScenario(scenarioWith("crossing_left_turn", {}));
  EXPECT_EQ(course.last_.status, SessionStatus::kCompleted);
  EXPECT_GT(course.cbv_ticks_, 60u);
  EXPECT_TRUE(course.faults_.empty());
}

TEST(ClosedLoop, WithoutCbvsNobodyIsTakenOver) {
  EXPECT_EQ(runScenario(scenarioWith("crossing_left_turn", {"max_cbv=0"})).cbv_ticks_, 0u);
}

TEST(ClosedLoop, UnknownPlannerAndExternalEgoAreInputErrors) {
  EXPECT_THROW(scenarioWith("crossing_left_turn", {"cbv_planner=pdm_lit"}), core::InputError);
  const SessionSetup external(scenarioWith("crossing_left_turn", {"ego_planner=external"}));
  EXPECT_THROW(ClosedLoop{external}, core::InputError);
}

TEST(ClosedLoop, PlannersBySlotDriveLikeThemselves) {
  // Slot 0 is PDM-Lite's in both: the first CBV alone drives alike until a second one is there.
  const std::vector<std::string> one = {"max_cbv=1", "protocol.time_limit=12"};
  const Course alone = runScenario(scenarioWith("roundabout_cross", one));
  ScenarioOptions joined = scenarioWith("roundabout_cross", one);
  joined.cbv_planner = "pdm_lite+diffusion";
  joined.validate();
  EXPECT_EQ(runScenario(joined).hash(), alone.hash());
  joined.max_cbv = 2;
  const Course both = runScenario(joined);
  EXPECT_TRUE(both.faults_.empty());
  EXPECT_NE(both.hash(),
            runScenario(scenarioWith("roundabout_cross", {"protocol.time_limit=12", "max_cbv=2"}))
                .hash());
}

TEST(ClosedLoop, PlannersBySlotAreNamedInErrors) {
  const auto errorOf = [](const std::string& name) -> std::string {
    try {
      scenarioWith("crossing_left_turn", {"cbv_planner=" + name});
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(errorOf("pdm_lite+difusion").find("'difusion', an unknown planner"), std::string::npos)
      << errorOf("pdm_lite+difusion");
  EXPECT_NE(errorOf("pdm_lite+external").find("'external' drives the CBVs of all slots"),
            std::string::npos)
      << errorOf("pdm_lite+external");
  EXPECT_NE(errorOf("pdm_lite+").find("joined by single '+'"), std::string::npos)
      << errorOf("pdm_lite+");
  EXPECT_THROW(scenarioWith("crossing_left_turn", {"ego_planner=pdm_lite+diffusion"}),
               core::InputError);
}

TEST(ClosedLoop, AtMostSleepsAndChangesNothing) {
  const Course free = runScenario(scenarioWith("crossing_left_turn", {"protocol.time_limit=2"}));
  const auto begin = std::chrono::steady_clock::now();
  const Course slow =
      runScenario(scenarioWith("crossing_left_turn", {"protocol.time_limit=2", "at_most=2"}));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(slow.hash(), free.hash());
  EXPECT_GE(taken.count(), 0.975);  // the last tick is published at 1.95 s / 2
}

// 8 s of a crossing, at which a car is placed 20 m down the first lane of the ego's route at 3 s.
TEST(ClosedLoop, SteeringChangesTheCourseTheSameWayEachTime) {
  const ScenarioOptions free = scenarioWith("crossing_left_turn", {"protocol.time_limit=8"});
  const SessionSetup setup(free);
  const map::Lane& lane = setup.network().lane(setup.egoRoute().lanes().front());
  const std::string place = "steering=[{at: 3, place: probe, lane: " + lane.id +
                            ", position: 20, speed: 2}, {at: 4, remove: probe}]";
  const std::vector<std::string> set = {"protocol.time_limit=8", place};
  const Course one = runScenario(scenarioWith("crossing_left_turn", set));
  const Course two = runScenario(scenarioWith("crossing_left_turn", set));
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_NE(one.hash(), runScenario(free).hash());
  EXPECT_TRUE(one.faults_.empty()) << one.faults_.front().text;
  EXPECT_EQ(one.last_.find("probe"), nullptr);
}

TEST(ClosedLoop, RealTimeFactorNeedsTheNodeGraph) {
  const SessionSetup paced(scenarioWith("crossing_left_turn", {"real_time_factor=1"}));
  try {
    ClosedLoop loop(paced);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("at_most"), std::string::npos) << error.what();
  }
  EXPECT_THROW(scenarioWith("crossing_left_turn", {"real_time_factor=1", "at_most=1"}),
               core::InputError);
}

TEST(ClosedLoop, StopEndsAsInterrupted) {
  const SessionSetup setup(scenarioWith("crossing_left_turn", {}));
  ClosedLoop loop(setup);
  Course course;
  loop.addObserver(course);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(loop.run(stop), SessionStatus::kInterrupted);
  EXPECT_EQ(course.ticks_, 2u) << "tick 0 and the final one";
}

/// Does something to SUMO's process at one tick.
class Saboteur : public SessionObserver {
 public:
  Saboteur(int process, int signal) : process_(process), signal_(signal) {}
  void observe(const TickRecord& record) override {
    if (record.snapshot->tick != 40) return;
    ::kill(process_, signal_);
    when_ = std::chrono::steady_clock::now();
  }
  double secondsSince() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - when_).count();
  }

 private:
  int process_;
  int signal_;
  std::chrono::steady_clock::time_point when_;
};

double secondsUntilErrorAfter(int signal, const std::vector<std::string>& set) {
  const SessionSetup setup(scenarioWith("crossing_left_turn", set));
  auto simulator = setup.makeSimulator();
  Saboteur saboteur(dynamic_cast<simulation::SumoSimulator&>(*simulator).processId(), signal);
  LoopParts parts = makeParts(setup);
  parts.world = std::make_unique<World>(setup, std::move(simulator));
  ClosedLoop loop(setup, std::move(parts));
  Course course;
  loop.addObserver(course);
  loop.addObserver(saboteur);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop.run(stop), SessionStatus::kError);
  const double seconds = saboteur.secondsSince();
  EXPECT_FALSE(course.faults_.empty());
  EXPECT_EQ(course.faults_.back().source, "simulator");
  return seconds;
}

TEST(ClosedLoop, KilledSumoIsAnErrorBeforeTheStepTimeout) {
  EXPECT_LT(secondsUntilErrorAfter(SIGKILL, {"sumo.step_timeout=200"}), 200.0);
}

TEST(ClosedLoop, FrozenSumoIsAnErrorAfterTheStepTimeout) {
  EXPECT_GT(secondsUntilErrorAfter(SIGSTOP, {"sumo.step_timeout=2"}), 1.5);
}

// Full brake is at most 8 m/s^2: 0.4 m/s a tick; nothing moves farther than speed x 0.05 s (+ the
// hand-over's rounding).
TEST(World, NoVehicleJumps) {
  const SessionSetup setup(scenarioWith("crossing_left_turn", {}));
  ClosedLoop loop(setup);
  class Steps : public SessionObserver {
   public:
    void observe(const TickRecord& record) override {
      for (const traffic::Vehicle& vehicle : record.snapshot->vehicles) {
        const auto before = last_.find(vehicle.id);
        if (before == nullptr) continue;
        hand_overs += vehicle.role == VehicleRole::kCbv && before->role == VehicleRole::kBackground;
        if ((vehicle.role != VehicleRole::kBackground || before->role != VehicleRole::kBackground))
          check(*before, vehicle);
      }
      last_ = *record.snapshot;
    }
    void check(const traffic::Vehicle& before, const traffic::Vehicle& after) {
      const double moved = (after.state.position - before.state.position).norm();
      const double speed = std::max(before.state.speed, after.state.speed);
      EXPECT_LT(moved, 0.05 * speed + 0.1) << after.id << " at tick " << last_.tick;
      EXPECT_LT(std::abs(after.state.speed - before.state.speed), 0.6)
          << after.id << " at tick " << last_.tick;
    }
    traffic::TrafficSnapshot last_;
    int hand_overs = 0;
  } steps;
  loop.addObserver(steps);
  const std::atomic<bool> stop{false};
  loop.run(stop);
  EXPECT_GT(steps.hand_overs, 0) << "the test needs a vehicle that is taken over";
}

// Real demand of a real junction, lights on: the ego goes straight through the signal.
TEST(ClosedLoop, Cologne1WithItsDemandAndLights) {
  CDIFF_SKIP_WITHOUT(test::realData("resco/cologne1.net.xml"));
  ScenarioOptions options;
  options.name = "cologne1";
  options.network = test::realData("resco/cologne1.net.xml").string();
  options.demand = test::realData("resco/cologne1.rou.xml").string();
  options.begin_time = 25200.0;
  options.lights = "program";
  options.route.edges = {"28198821#3", "32038056#0"};
  options.route.end_offset = 250.0;
  options.protocol.time_limit = 60.0;
  options.protocol.blocked_time = 1000.0;
  const Course course = runScenario(options);
  EXPECT_EQ(course.last_.status, SessionStatus::kCompleted);
  EXPECT_GT(course.last_.vehicles.size(), 5u);
}

}  // namespace
}  // namespace cdiff::session
