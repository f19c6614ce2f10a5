// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The state machine, on a stage that only writes down what it is asked to do.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "storyboard/storyboard.h"

namespace cdiff::storyboard {
namespace {

/// Conditions on parameters hold where the test says so; times are compared with the clock.
class ScriptedStage : public Stage {
 public:
  std::map<std::string, bool> truth;
  std::vector<std::string> begun;
  std::map<std::string, std::shared_ptr<Performance>> performing;

  bool holds(const Condition& condition, double time) override {
    if (const auto* clock = std::get_if<TimeCondition>(&condition.what))
      return time >= clock->value - 1e-9;
    return truth[std::get<ParameterCondition>(condition.what).name];
  }
  std::vector<std::shared_ptr<Performance>> begin(const Action& action,
                                                  const std::vector<std::string>&,
                                                  double) override {
    begun.push_back(action.name);
    performing[action.name] = std::make_shared<Performance>();
    return {performing[action.name]};
  }
};

Trigger when(const std::string& name, Condition::Edge edge = Condition::Edge::kNone,
             double delay = 0.0) {
  Condition condition;
  condition.edge = edge;
  condition.delay = delay;
  condition.what = ParameterCondition{name, Rule::kEqual, "true"};
  return {{{condition}}};
}

Trigger whenState(const std::string& type, const std::string& element, const std::string& state) {
  Condition condition;
  condition.source = {"file.xosc", 12};
  condition.what = ElementStateCondition{type, element, state};
  return {{{condition}}};
}

Event event(const std::string& name, const std::optional<Trigger>& start,
            Event::Priority priority = Event::Priority::kParallel, int executions = 1) {
  return {name, priority, executions, {{"act_of_" + name, {}, NoAction{}}}, start};
}

/// One story with one act, group and maneuver of these events.
Scenario scenarioOf(const std::vector<Event>& events) {
  Scenario scenario;
  ManeuverGroup group{"group", 1, {"car"}, {{"maneuver", events}}};
  scenario.stories = {{"story", {{"act", {group}, std::nullopt, std::nullopt}}}};
  return scenario;
}

TEST(Storyboard, AnEventWaitsRunsAndCompletesWithAllAboveIt) {
  const Scenario scenario = scenarioOf({event("first", when("go"))});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  board.update(0.0);
  EXPECT_EQ(board.state("act", "act"), ElementState::kRunning);
  EXPECT_EQ(board.state("event", "first"), ElementState::kStandby);
  stage.truth["go"] = true;
  board.update(0.1);
  EXPECT_EQ(board.state("event", "first"), ElementState::kRunning);
  EXPECT_EQ(stage.begun, std::vector<std::string>{"act_of_first"});
  stage.performing["act_of_first"]->over = true;
  board.update(0.2);
  for (const char* type : {"action", "event", "maneuver", "maneuverGroup", "act", "story"}) {
    const std::string name = std::string(type) == "event"           ? "first"
                             : std::string(type) == "action"        ? "act_of_first"
                             : std::string(type) == "maneuverGroup" ? "group"
                                                                    : type;
    EXPECT_EQ(board.state(type, name), ElementState::kComplete) << type;
  }
}

TEST(Storyboard, EndsWithItsStoriesWhereTheFileSaysSo) {
  for (const bool ends : {true, false}) {
    Scenario scenario = scenarioOf({event("first", std::nullopt)});
    scenario.ends_with_stories = ends;
    ScriptedStage stage;
    Storyboard board(scenario, stage);
    board.update(0.0);
    EXPECT_FALSE(board.over());
    stage.performing["act_of_first"]->over = true;
    board.update(0.1);
    EXPECT_EQ(board.over(), ends);
  }
}

TEST(Storyboard, AnEventFollowsTheEndOfAnother) {
  const Scenario scenario =
      scenarioOf({event("second", whenState("event", "maneuver::first", "endTransition")),
                  event("first", std::nullopt)});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  board.update(0.0);
  stage.performing["act_of_first"]->over = true;
  board.update(0.1);
  EXPECT_EQ(board.state("event", "first"), ElementState::kComplete);
  board.update(0.2);
  EXPECT_EQ(board.state("event", "second"), ElementState::kRunning);
}

TEST(Storyboard, PrioritiesStopSkipOrRunBeside) {
  for (const auto& [priority, first, second] :
       {std::make_tuple(Event::Priority::kOverride, ElementState::kComplete,
                        ElementState::kRunning),
        std::make_tuple(Event::Priority::kSkip, ElementState::kRunning, ElementState::kComplete),
        std::make_tuple(Event::Priority::kParallel, ElementState::kRunning,
                        ElementState::kRunning)}) {
    const Scenario scenario =
        scenarioOf({event("first", std::nullopt), event("second", when("go"), priority)});
    ScriptedStage stage;
    Storyboard board(scenario, stage);
    board.update(0.0);
    const auto performing = stage.performing["act_of_first"];
    stage.truth["go"] = true;
    board.update(0.1);
    EXPECT_EQ(board.state("event", "first"), first);
    EXPECT_EQ(board.state("event", "second"), second);
    EXPECT_EQ(performing->stopped, priority == Event::Priority::kOverride);
  }
}

TEST(Storyboard, ARisingEdgeFiresOnceForEachRise) {
  const Scenario scenario = scenarioOf(
      {event("twice", when("go", Condition::Edge::kRising), Event::Priority::kParallel, 2)});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  stage.truth["go"] = true;
  board.update(0.0);  // holds at once: before, it counts as false
  stage.performing["act_of_twice"]->over = true;
  board.update(0.1);
  board.update(0.2);
  EXPECT_EQ(stage.begun.size(), 1U);
  stage.truth["go"] = false;
  board.update(0.3);
  stage.truth["go"] = true;
  board.update(0.4);
  EXPECT_EQ(stage.begun.size(), 2U);
}

TEST(Storyboard, ADelayIsCountedFromTheRise) {
  const Scenario scenario = scenarioOf({event("late", when("go", Condition::Edge::kRising, 0.25))});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  stage.truth["go"] = true;
  for (int tick = 0; tick <= 4; ++tick) {  // 0.25 s are over at the first tick from 0.25 s on
    EXPECT_TRUE(stage.begun.empty()) << tick;
    if (tick < 3) board.update(0.1 * tick);
    if (tick == 3) break;
  }
  board.update(0.3);
  EXPECT_EQ(stage.begun.size(), 1U);
}

TEST(Storyboard, AnEventThatIsOverriddenRunsNoMore) {
  const Scenario scenario = scenarioOf({event("first", when("a"), Event::Priority::kParallel, 2),
                                        event("second", when("b"), Event::Priority::kOverride)});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  stage.truth["a"] = true;
  board.update(0.0);
  stage.truth["b"] = true;
  board.update(0.1);
  board.update(0.2);
  EXPECT_EQ(board.state("event", "first"), ElementState::kComplete);
  EXPECT_EQ(stage.begun, (std::vector<std::string>{"act_of_first", "act_of_second"}));
}

TEST(Storyboard, ADelayCountsFromStandbyOn) {
  const Scenario scenario = scenarioOf(
      {event("twice", when("go", Condition::Edge::kNone, 0.2), Event::Priority::kParallel, 2)});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  stage.truth["go"] = true;
  for (const double time : {0.0, 0.1, 0.2}) board.update(time);
  ASSERT_EQ(stage.begun.size(), 1U);
  stage.truth["go"] = false;
  stage.performing["act_of_twice"]->over = true;
  for (const double time : {0.3, 0.4, 0.5, 0.6}) board.update(time);
  EXPECT_EQ(stage.begun.size(), 1U);
}

TEST(Storyboard, AGroupNeedsAllOfItsConditionsAndATriggerOneGroup) {
  Trigger trigger = when("a");
  trigger.groups[0].push_back(when("b").groups[0][0]);
  trigger.groups.push_back(when("c").groups[0]);
  for (const auto& [names, fires] : {std::make_pair(std::vector<std::string>{"a"}, false),
                                     std::make_pair(std::vector<std::string>{"a", "b"}, true),
                                     std::make_pair(std::vector<std::string>{"c"}, true)}) {
    const Scenario scenario = scenarioOf({event("first", trigger)});
    ScriptedStage stage;
    for (const std::string& name : names) stage.truth[name] = true;
    Storyboard board(scenario, stage);
    board.update(0.0);
    EXPECT_EQ(!stage.begun.empty(), fires) << names.front();
  }
}

TEST(Storyboard, ATriggerWithoutConditionsNeverFires) {
  const Scenario scenario = scenarioOf({event("never", Trigger())});
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  board.update(0.0);
  EXPECT_TRUE(stage.begun.empty());
}

TEST(Storyboard, AGroupRepeatsAsOftenAsItSays) {
  Scenario scenario = scenarioOf({event("again", std::nullopt)});
  scenario.stories[0].acts[0].groups[0].executions = 2;
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  for (int tick = 0; tick < 6; ++tick) {
    board.update(0.1 * tick);
    stage.performing["act_of_again"]->over = true;
  }
  EXPECT_EQ(stage.begun.size(), 2U);
  EXPECT_EQ(board.state("act", "act"), ElementState::kComplete);
}

TEST(Storyboard, StopTriggersEndTheActAndTheStoryboard) {
  Scenario scenario = scenarioOf({event("long", std::nullopt)});
  scenario.stories[0].acts[0].stop = when("stop_act");
  scenario.stop = when("stop_all");
  ScriptedStage stage;
  Storyboard board(scenario, stage);
  board.update(0.0);
  stage.truth["stop_act"] = true;
  board.update(0.1);
  EXPECT_EQ(board.state("event", "long"), ElementState::kComplete);
  EXPECT_EQ(board.state("act", "act"), ElementState::kComplete);
  EXPECT_TRUE(stage.performing["act_of_long"]->stopped);
  EXPECT_FALSE(board.over());
  stage.truth["stop_all"] = true;
  board.update(0.2);
  EXPECT_TRUE(board.over());
}

TEST(Storyboard, AConditionOnAnElementThatIsNotThereIsNamed) {
  const Scenario scenario =
      scenarioOf({event("first", whenState("event", "other", "completeState"))});
  ScriptedStage stage;
  try {
    const Storyboard board(scenario, stage);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("file.xosc:12: there is no event 'other'"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::storyboard
