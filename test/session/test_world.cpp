// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The world over a scripted simulator: contacts, hand-over, invalid actions, a lost simulator.
// All boxes are 4.5 x 1.8 m and head east: they overlap where the centers are less than 4.5 m apart
// along x and less than 1.8 m along y.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "session/scripted_session.h"
#include "session/world.h"

namespace cdiff::session {
namespace {

using Texts = std::vector<std::string>;
using test::ScriptedSession;
using traffic::ControlAction;
using traffic::VehicleRole;

constexpr double kEgoStart = 100.0;  // [m] along x

planning::PlannedAction of(const std::string& id, const ControlAction& action, int slot = -1) {
  return {slot, id, action, {}};
}

/// Contacts of the present tick as "first second".
Texts pairs(const World& world) {
  Texts texts;
  for (const traffic::Contact& contact : world.snapshot().contacts)
    texts.push_back(contact.first + " " + contact.second);
  return texts;
}

// The car stands 10 m ahead of an ego of 8 m/s: 5.5 m between the bumpers are driven in less than
// 0.7 s, 14 ticks.
TEST(World, ACrashIsOneContactAtTheFirstOverlapAndTheCbvIsGoneAtTheNextTick) {
  ScriptedSession scripted(8.0);
  scripted.simulator().place("car", {kEgoStart + 10.0});
  const auto world = scripted.makeWorld();
  Texts all;
  for (int tick = 0; tick < 30; ++tick) {
    const traffic::Vehicle* car = world->snapshot().find("car");
    const double apart =
        car == nullptr ? 1e9
                       : car->state.position.x() - world->snapshot().ego()->state.position.x();
    const Texts now = pairs(*world);
    EXPECT_EQ(now.size(), apart < 4.5 ? 1U : 0U) << apart << " m apart at tick " << tick;
    all.insert(all.end(), now.begin(), now.end());
    const auto selection = scripted.selectionOf("car");
    world->advance(&selection, {of("ego", {1.0, 0.0, 0.0}), of("car", {0.0, 0.0, 1.0}, 0)});
    if (now.empty()) continue;
    EXPECT_EQ(world->snapshot().find("car"), nullptr);
    EXPECT_EQ(world->snapshot().removed, Texts{"car"});
  }
  EXPECT_EQ(all, Texts{"car ego"});
  EXPECT_EQ(scripted.simulator().asked, (Texts{"take over car", "remove car"}));
  EXPECT_GT(world->snapshot().ego()->state.position.x(), kEgoStart + 10.0) << "the ego goes on";
}

// Centers up to |(4.5, 1.8)| = 4.85 m apart overlap, farther than half the lengths' sum, 4.5 m.
TEST(World, ContactsReachToTheCornersOfBothBoxes) {
  struct Case {
    double along, aside;
    bool contact;
  };
  for (const Case& c : {Case{4.4, 0.0, true}, Case{4.6, 0.0, false}, Case{4.4, 1.75, true},
                        Case{4.4, 1.85, false}, Case{-4.4, -1.75, true}, Case{0.0, 1.85, false}}) {
    ScriptedSession scripted;
    scripted.simulator().place("car", {kEgoStart + c.along, c.aside});
    const auto world = scripted.makeWorld();
    ASSERT_NE(world->snapshot().find("car"), nullptr);
    EXPECT_EQ(pairs(*world), c.contact ? Texts{"car ego"} : Texts{})
        << c.along << " m ahead, " << c.aside << " m aside";
    world->advance(nullptr, {});
    EXPECT_EQ(world->snapshot().find("car") == nullptr, c.contact);
    EXPECT_EQ(pairs(*world), Texts{});
  }
}

// Levels are more than 2.5 m apart.
TEST(World, BoxesOnTwoLevelsDoNotTouch) {
  for (const auto& [z, contact] : {std::pair{2.4, true}, {2.6, false}, {8.0, false}}) {
    ScriptedSession scripted;
    scripted.simulator().place("above", {kEgoStart, 0.0, 0.0, 0.0, z});
    const auto world = scripted.makeWorld();
    ASSERT_NE(world->snapshot().find("above"), nullptr);
    EXPECT_EQ(pairs(*world), contact ? Texts{"above ego"} : Texts{}) << z << " m above";
  }
}

// The CBV starts 4.4 m behind a car that stands, 200 m ahead of the ego.
TEST(World, ACbvAndABackgroundVehicleInContactBothLeave) {
  ScriptedSession scripted;
  scripted.simulator().place("back", {kEgoStart + 195.6});
  scripted.simulator().place("front", {kEgoStart + 200.0});
  const auto world = scripted.makeWorld();
  EXPECT_EQ(pairs(*world), Texts{}) << "among background vehicles nobody looks";
  const auto selection = scripted.selectionOf("back");
  world->advance(&selection, {});
  EXPECT_EQ(pairs(*world), Texts{"back front"});
  world->advance(&selection, {});
  EXPECT_EQ(world->snapshot().vehicles.size(), 1U) << "the ego alone, though it is selected again";
  EXPECT_EQ(world->snapshot().removed, (Texts{"back", "front"}));
}

// Full braking is at least 2 m/s^2: 0.1 m/s a tick.
TEST(World, AnInvalidActionIsFullBrakingAndARecordedFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [action, word] : {std::pair{ControlAction{nan, 0.0, 0.0}, "throttle nan"},
                                     {ControlAction{0.0, 1.5, 0.0}, "steer 1.5"},
                                     {ControlAction{0.0, 0.0, -0.5}, "brake -0.5"}}) {
    ScriptedSession scripted(5.0);
    const auto world = scripted.makeWorld();
    world->advance(nullptr, {of("ego", action)});
    ASSERT_EQ(world->snapshot().faults.size(), 1U);
    EXPECT_EQ(world->snapshot().faults[0].source, "command");
    EXPECT_NE(world->snapshot().faults[0].text.find(word), std::string::npos)
        << world->snapshot().faults[0].text;
    EXPECT_EQ(world->snapshot().ego()->applied_action, ControlAction::failSafe());
    EXPECT_LT(world->snapshot().ego()->state.speed, 4.9);
    world->advance(nullptr, {of("ego", {1.0, 0.0, 0.0})});
    EXPECT_TRUE(world->snapshot().faults.empty());
    EXPECT_EQ(world->snapshot().ego()->applied_action, (ControlAction{1.0, 0.0, 0.0}));
  }
}

// At 10 m/s a vehicle moves 0.5 m a tick.
TEST(World, AVehicleTakenOverMovesByItsActionUntilItIsReleasedWhereItIs) {
  ScriptedSession scripted;
  scripted.simulator().place("car", {200.0, 0.0, 0.0, 10.0});
  const auto world = scripted.makeWorld();
  EXPECT_EQ(world->snapshot().find("car")->role, VehicleRole::kBackground);
  EXPECT_FALSE(world->snapshot().find("car")->applied_action);
  const double before = world->snapshot().find("car")->state.position.x();

  auto selection = scripted.selectionOf("car");
  selection.assignments[0].slot = 1;
  world->advance(&selection, {of("car", {0.0, 0.0, 1.0}, 1)});
  const traffic::Vehicle taken = *world->snapshot().find("car");
  EXPECT_EQ(taken.role, VehicleRole::kCbv);
  EXPECT_EQ(taken.cbv_slot, 1);
  EXPECT_EQ(taken.lane_id, "road_0") << "where the simulator has it";
  EXPECT_EQ(taken.applied_action, ControlAction::failSafe());
  EXPECT_LT(taken.state.speed, 9.9) << "the scripted one would keep its speed";
  EXPECT_NEAR(taken.state.position.x(), before + 0.5, 0.02);
  world->advance(nullptr, {});
  EXPECT_LT(world->snapshot().find("car")->state.speed, taken.state.speed) << "the action is held";

  const traffic::VehicleState last = world->snapshot().find("car")->state;
  cbv::CbvSelection none;
  none.released.push_back({1, "car", "route_end"});
  world->advance(&none, {});
  EXPECT_EQ(scripted.simulator().asked, (Texts{"take over car", "release car"}));
  EXPECT_EQ(scripted.simulator().last_released.state.position, last.position);
  EXPECT_EQ(scripted.simulator().last_released.state.speed, last.speed);
  EXPECT_EQ(world->snapshot().find("car")->role, VehicleRole::kBackground);
}

TEST(World, ATakeOverStartsWhereTheDisturbanceSays) {
  ScriptedSession scripted;
  scripted.simulator().place("car", {200.0});
  const auto world = scripted.makeWorld();
  world->setTakeOverDisturbance([](const std::string& id, traffic::VehicleState state) {
    EXPECT_EQ(id, "car");
    state.position.y() += 0.5;
    return state;
  });
  const auto selection = scripted.selectionOf("car");
  world->advance(&selection, {});
  EXPECT_EQ(world->snapshot().find("car")->state.position, Eigen::Vector2d(200.0, 0.5));
}

TEST(World, CbvsComeByTheirSlotsAfterTheEgo) {
  ScriptedSession scripted;
  for (const char* id : {"a", "b", "c"})
    scripted.simulator().place(id, {200.0 + 50.0 * (id[0] - 'a')});
  const auto world = scripted.makeWorld();
  cbv::CbvSelection selection = scripted.selectionOf("a");
  selection.assignments[0].slot = 2;
  world->advance(&selection, {});
  selection.assignments.insert(selection.assignments.begin(), selection.assignments[0]);
  selection.assignments[0].slot = 0;
  selection.assignments[0].vehicle_id = "c";
  world->advance(&selection, {});
  Texts ids;
  for (const traffic::Vehicle& vehicle : world->snapshot().vehicles) ids.push_back(vehicle.id);
  EXPECT_EQ(ids, (Texts{"ego", "c", "a", "b"}));
}

TEST(World, WhatTheSimulatorFailsWithEndsTheSession) {
  for (const bool at_fault : {false, true}) {
    ScriptedSession scripted;
    const auto world = scripted.makeWorld();
    scripted.simulator().failNext(at_fault);
    world->advance(nullptr, {});
    EXPECT_EQ(world->snapshot().status, traffic::SessionStatus::kError);
    ASSERT_EQ(world->snapshot().faults.size(), 1U);
    EXPECT_EQ(world->snapshot().faults[0].source, at_fault ? traffic::kInputFault : "simulator");
    EXPECT_THROW(world->advance(nullptr, {}), std::logic_error);
  }
}

// At 2.5 m/s^2 a car of 30 m/s needs 30^2 / (2 x 2.5) = 180 m to stop behind an ego that stands.
TEST(World, WhoCouldNotAvoidTheEgoIsRemovedBeforeItStarts) {
  ScriptedSession scripted;
  scripted.simulator().place("ahead", {kEgoStart + 20.0, 0.0, 0.0, 30.0});
  scripted.simulator().place("behind", {kEgoStart - 50.0, 0.0, 0.0, 30.0});
  scripted.simulator().place("below", {kEgoStart - 50.0, 0.0, 0.0, 30.0, -8.0});
  const auto world = scripted.makeWorld();
  EXPECT_EQ(scripted.simulator().asked, Texts{"remove behind"});
  EXPECT_EQ(world->snapshot().find("behind"), nullptr);
  EXPECT_NE(world->snapshot().find("below"), nullptr);
}

TEST(World, WhatIsAskedForComesWithTheNextDecisionAndNoEarlier) {
  ScriptedSession scripted;
  scripted.simulator().place("car", {kEgoStart + 50.0});
  const auto world = scripted.makeWorld();
  world->control().ask({"me", "target_speed", "9"});
  world->advance(nullptr, {});
  EXPECT_TRUE(world->snapshot().steering.empty()) << "tick 1 is no decision";
  world->advance(nullptr, {});
  ASSERT_EQ(world->snapshot().steering.size(), 1U);
  EXPECT_EQ(world->snapshot().steering[0].after, "9");
  EXPECT_EQ(world->snapshot().steering[0].by, "me");
  world->advance(nullptr, {});
  EXPECT_TRUE(world->snapshot().steering.empty());
}

TEST(World, AVehicleIsTakenAwayWhoeverDrivesIt) {
  ScriptedSession scripted;
  scripted.simulator().place("car", {kEgoStart + 50.0});
  scripted.simulator().place("other", {kEgoStart + 150.0});
  const auto world = scripted.makeWorld();
  const auto selection = scripted.selectionOf("car");
  world->advance(&selection, {of("car", {0.0, 0.0, 1.0}, 0)});
  world->control().ask({"me", "remove", "car"});
  world->control().ask({"me", "remove", "other"});
  world->advance(nullptr, {});
  EXPECT_EQ(world->snapshot().vehicles.size(), 1U);
  EXPECT_EQ(world->snapshot().removed, (Texts{"car", "other"}));
  EXPECT_EQ(world->snapshot().steering.size(), 2U);
}

TEST(World, AVehicleThatFindsNoRoomIsAFaultAndNoChange) {
  ScriptedSession scripted;  // whose simulator takes no vehicle
  const auto world = scripted.makeWorld();
  world->control().ask({"me", "place", "probe road_0 300 5"});
  world->advance(nullptr, {});
  world->advance(nullptr, {});
  EXPECT_TRUE(world->snapshot().steering.empty());
  world->advance(nullptr, {});
  ASSERT_EQ(world->snapshot().faults.size(), 1U);
  EXPECT_EQ(world->snapshot().faults[0].source, "steering");
}

TEST(World, WhatOthersSayOfAFaultIsCutAndMadePlain) {
  ScriptedSession scripted;
  const auto world = scripted.makeWorld();
  const std::string loud = "\033[31m" + std::string(1'000'000, 'x');
  world->recordFault(loud, loud);
  world->end(traffic::SessionStatus::kError, {0, loud, loud});
  ASSERT_EQ(world->snapshot().faults.size(), 2U);
  for (const traffic::Fault& fault : world->snapshot().faults) {
    for (const std::string& text : {fault.source, fault.text}) {
      EXPECT_LT(text.size(), 10000U);
      EXPECT_EQ(text.find('\033'), std::string::npos);
    }
  }
}

TEST(World, ASessionThatEndedIsOverForWhoSteers) {
  ScriptedSession scripted;
  const auto world = scripted.makeWorld();
  EXPECT_EQ(world->control().state(), SessionControl::State::kPlaying);
  world->end(traffic::SessionStatus::kInterrupted, {0, "user", "interrupted"});
  EXPECT_EQ(world->control().state(), SessionControl::State::kOver);
}

}  // namespace
}  // namespace cdiff::session
