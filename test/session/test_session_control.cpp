// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Pace and steering of a session, without a world: ticks are asked for one by one, and the wall
// clock is the test's own.
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"
#include "session/scripted_session.h"
#include "session/session_control.h"

namespace cdiff::session {
namespace {

using State = SessionControl::State;
using Clock = SessionControl::Clock;
using Texts = std::vector<std::string>;
using traffic::VehicleRole;

const VehicleRoles kVehicles = {
    {"ego", VehicleRole::kEgo}, {"car", VehicleRole::kBackground}, {"attacker", VehicleRole::kCbv}};

std::string refusalOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The road of ScriptedSession, 600 m long, whose CBVs are guided.
class Guided {
 public:
  explicit Guided(const std::function<void(ScenarioOptions&)>& change = {})
      : setup_(changed(scripted_.setup().options(), change)) {}
  const SessionSetup& setup() const { return setup_; }

 private:
  static ScenarioOptions changed(ScenarioOptions options,
                                 const std::function<void(ScenarioOptions&)>& change) {
    options.cbv_planner = "diffusion";
    options.guidance = guidance::loadProfile("naturalistic");
    if (change) change(options);
    return options;
  }
  test::ScriptedSession scripted_;
  SessionSetup setup_;
};

bool goesOn(SessionControl& control, double simulated = 0.0) {
  return control.holdBack(simulated, Clock::time_point()) == Clock::duration::zero();
}

TEST(SessionControl, PausesBeforeTheNextTickAndStepsCount) {
  const test::ScriptedSession scripted;
  SessionControl control(scripted.setup());
  EXPECT_TRUE(goesOn(control));
  EXPECT_TRUE(mentions(refusalOf([&] { control.step(3); }), "pause it before"));
  EXPECT_TRUE(mentions(refusalOf([&] { control.resume(); }), "not paused"));
  control.pause();
  EXPECT_TRUE(mentions(refusalOf([&] { control.pause(); }), "paused already"));
  EXPECT_FALSE(goesOn(control));
  EXPECT_TRUE(mentions(refusalOf([&] { control.step(0); }), "expected 1 to"));
  control.step(3);
  EXPECT_TRUE(mentions(refusalOf([&] { control.step(1); }), "3 ticks of another step"));
  int ticks = 0;
  while (goesOn(control)) ++ticks;
  EXPECT_EQ(ticks, 3);
  EXPECT_EQ(control.state(), State::kPaused);
  control.resume();
  EXPECT_TRUE(goesOn(control));
}

TEST(SessionControl, AwaitsTheStepsOfAnotherThread) {
  const test::ScriptedSession scripted;
  SessionControl control(scripted.setup());
  control.pause();
  control.step(2);
  EXPECT_FALSE(control.awaitSteps(0.0));
  std::thread loop([&] {
    while (control.state() == State::kStepping) goesOn(control);
  });
  EXPECT_TRUE(control.awaitSteps(60.0));
  loop.join();
  EXPECT_EQ(control.state(), State::kPaused);
}

// Twice real time: 1 s is due half a second after the first tick was asked for, in looks of 20 ms.
TEST(SessionControl, PaceCountsFromWhereItWasSet) {
  const test::ScriptedSession scripted(0.0, 2.0);
  SessionControl control(scripted.setup());
  const Clock::time_point begin;
  using std::chrono::milliseconds;
  EXPECT_EQ(control.holdBack(0.0, begin), Clock::duration::zero());
  EXPECT_EQ(control.holdBack(1.0, begin), milliseconds(20));
  EXPECT_EQ(control.holdBack(1.0, begin + milliseconds(490)), milliseconds(10));
  EXPECT_EQ(control.holdBack(1.0, begin + milliseconds(500)), Clock::duration::zero());
  control.setPace(1.0);
  EXPECT_EQ(control.holdBack(5.0, begin + milliseconds(600)), Clock::duration::zero());
  EXPECT_EQ(control.holdBack(5.5, begin + milliseconds(1090)), milliseconds(10));
  control.setPace(0.0);
  EXPECT_EQ(control.holdBack(50.0, begin + milliseconds(1100)), Clock::duration::zero());
  EXPECT_TRUE(
      mentions(refusalOf([&] { control.setPace(101.0); }), "expected a number in [0, 100]"));
  EXPECT_EQ(control.pace(), 0.0);
}

TEST(SessionControl, NothingHoldsASessionOfTheWallClock) {
  const Guided guided([](ScenarioOptions& options) { options.real_time_factor = 1.0; });
  SessionControl control(guided.setup());
  for (const std::function<void()>& call : {std::function<void()>([&] { control.pause(); }),
                                            {[&] { control.step(1); }},
                                            {[&] { control.setPace(1.0); }}})
    EXPECT_TRUE(mentions(refusalOf(call), "real_time_factor 1"));
  EXPECT_TRUE(goesOn(control, 100.0));
}

TEST(SessionControl, RefusesWhatCannotBeAndChangesNothing) {
  const Guided guided;
  SessionControl control(guided.setup());
  control.note(kVehicles);
  struct Case {
    std::string what, value, reason;
  };
  for (const Case& c :
       {Case{"choose", "cart", "'cart' is not there; did you mean 'car'?"},
        Case{"choose", "attacker", "is a CBV already"}, Case{"choose", "ego", "is the ego"},
        Case{"release", "car", "is no CBV"}, Case{"remove", "ego", "is the ego"},
        Case{"weight.speed", "1001", "[0, 1000]"}, Case{"weight.speed", "much", "much"},
        Case{"weight.sped", "1", "'speed'"},
        Case{"profile", "natural", "did you mean 'naturalistic'"},
        Case{"mode", "gentle", "naturalistic"}, Case{"target_speed", "0.1", "[0.5, 40] m/s"},
        Case{"target_speed", "nan", "[0.5, 40] m/s"}, Case{"color", "red", "cannot be steered"},
        Case{"place", "probe", "'ID LANE POSITION SPEED'"},
        Case{"place", "car road_0 100 5", "there already"},
        Case{"place", "bg_7 road_0 100 5", "not beginning with 'bg_'"},
        Case{"place", "probe rode_0 100 5", "lane 'rode_0'"},
        Case{"place", "probe road_0 1 5", "[2.25, 597.75]"},
        Case{"place", "probe road_0 100 50", "the lane's limit"}}) {
    const std::string reason = refusalOf([&] { control.ask({"me", c.what, c.value}); });
    EXPECT_TRUE(mentions(reason, c.reason)) << c.what << " " << c.value << ": " << reason;
  }
  Texts refused;
  EXPECT_TRUE(control.take(1.0, kVehicles, refused).empty());
  EXPECT_EQ(refused, Texts{});
}

TEST(SessionControl, GuidanceNeedsAGuidedPlanner) {
  const Guided blind([](ScenarioOptions& options) { options.cbv_planner = "pdm_lite"; });
  SessionControl control(blind.setup());
  const std::string reason = refusalOf([&] { control.ask({"me", "profile", "none"}); });
  EXPECT_TRUE(mentions(reason, "'pdm_lite' is not guided; expected one of diffusion")) << reason;
  control.ask({"me", "target_speed", "9"});
  Texts refused;
  EXPECT_EQ(control.take(0.0, {}, refused).size(), 1U);
}

/// "WHAT BEFORE>AFTER" of each change.
Texts textsOf(const std::vector<traffic::SteeringChange>& changes) {
  Texts texts;
  for (const auto& change : changes)
    texts.push_back(change.what + " " + change.before + ">" + change.after);
  return texts;
}

TEST(SessionControl, ChangesSayWhatWasBefore) {
  const Guided guided;
  SessionControl control(guided.setup());
  control.note(kVehicles);
  const double weight = guidance::loadProfile("safety_critical").find("collision_seeking").weight;
  ASSERT_EQ(weight, 50.0);
  control.ask({"me", "profile", "safety_critical"});
  control.ask({"me", "weight.collision_seeking", "20"});
  control.ask({"me", "target_speed", "9.5"});
  control.ask({"me", "choose", "car"});
  control.ask({"me", "release", "attacker"});
  Texts refused;
  EXPECT_EQ(textsOf(control.take(0.1, kVehicles, refused)),
            (Texts{"profile naturalistic>safety_critical", "weight.collision_seeking 50>20",
                   "target_speed 8>9.5", "choose >car", "release attacker>"}));
  control.ask({"me", "mode", "naturalistic"});
  control.ask({"me", "weight.collision_seeking", "3"});
  EXPECT_EQ(textsOf(control.take(0.2, kVehicles, refused)),
            (Texts{"mode naturalistic>naturalistic", "weight.collision_seeking 0>3"}));
  EXPECT_EQ(refused, Texts{});
}

TEST(SessionControl, OfASliderTheNewestValueCounts) {
  const Guided guided;
  SessionControl control(guided.setup());
  for (int i = 1; i <= 5000; ++i) control.ask({"me", "weight.speed", std::to_string(0.1 * i)});
  Texts refused;
  const auto changes = control.take(0.1, kVehicles, refused);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].after, "500");
}

TEST(SessionControl, AScenariosListIsDueInTheOrderOfTime) {
  const Guided guided([](ScenarioOptions& options) {
    options.steering.resize(3);
    options.steering[0].at = 0.2;
    options.steering[0].target_speed = 9.0;
    options.steering[1].at = 0.1;
    options.steering[1].profile = "none";
    options.steering[1].remove = "gone";
    options.steering[2].at = 0.1;
    options.steering[2].objective = "speed";
    options.steering[2].weight = 2.0;
  });
  SessionControl control(guided.setup());
  Texts refused;
  EXPECT_TRUE(control.take(0.05, kVehicles, refused).empty());
  const auto first = control.take(0.1, kVehicles, refused);
  EXPECT_EQ(textsOf(first), (Texts{"profile naturalistic>none", "weight.speed 0>2"}));
  EXPECT_EQ(first[0].by, traffic::kSteeredByScenario);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_TRUE(mentions(refused[0], "vehicle 'gone' is not there")) << refused[0];
  EXPECT_EQ(textsOf(control.take(0.2, kVehicles, refused)), Texts{"target_speed 8>9"});
  EXPECT_TRUE(control.take(0.3, kVehicles, refused).empty());
}

TEST(SessionControl, WhoIsGoneByTheDecisionIsRefusedThere) {
  const Guided guided;
  SessionControl control(guided.setup());
  control.note(kVehicles);
  control.ask({"me", "remove", "car"});
  Texts refused;
  EXPECT_TRUE(control.take(0.1, {{"ego", VehicleRole::kEgo}}, refused).empty());
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_TRUE(mentions(refused[0], "nothing was changed")) << refused[0];
}

TEST(SessionControl, WhatOneChangeTakesAnotherCannotHave) {
  const Guided guided;
  SessionControl control(guided.setup());
  control.note(kVehicles);
  for (int i = 0; i < 2; ++i) {
    control.ask({"me", "remove", "car"});
    control.ask({"me", "place", "probe road_0 100 5"});
  }
  Texts refused;
  EXPECT_EQ(textsOf(control.take(0.1, kVehicles, refused)),
            (Texts{"remove car>", "place >probe road_0 100 5"}));
  EXPECT_EQ(refused.size(), 2U);
}

TEST(SessionControl, NothingCanBeAskedOfASessionThatIsOver) {
  const Guided guided;
  SessionControl control(guided.setup());
  control.pause();
  control.step(5);
  control.end();
  EXPECT_TRUE(control.awaitSteps(0.0)) << "who waits for steps goes on";
  EXPECT_TRUE(mentions(refusalOf([&] { control.pause(); }), "over"));
  EXPECT_TRUE(mentions(refusalOf([&] { control.ask({"me", "profile", "none"}); }), "over"));
}

}  // namespace
}  // namespace cdiff::session
