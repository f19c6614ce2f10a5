// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "storyboard/scenario.h"

namespace cdiff::storyboard {

/// An action that is being performed.
struct Performance {
  bool over = false;     ///< the action has reached its end, or another one has replaced it
  bool stopped = false;  ///< the storyboard wants no more of it
};

/// Interface of the world that a storyboard acts on: conditions of entities, time and parameters,
/// and actions. Implemented by the session's traffic, and by tests.
class Stage {
 public:
  virtual ~Stage() = default;
  /// Whether the condition holds at `time` [s]; never asked for states of elements.
  virtual bool holds(const Condition& condition, double time) = 0;
  /// Starts an action of these actors at `time` [s]; one performance for each actor, or one alone.
  virtual std::vector<std::shared_ptr<Performance>> begin(const Action& action,
                                                          const std::vector<std::string>& actors,
                                                          double time) = 0;
};

/// State of an element of the storyboard.
enum class ElementState { kStandby, kRunning, kComplete };

/// The storyboard of a scenario as a state machine: stories, acts, maneuver groups, maneuvers,
/// events and actions, each in standby, running or complete (OpenSCENARIO 1.2, 7.2). Before its
/// first evaluation a condition counts as false, so one that holds at once is a rising edge. A
/// transition is seen in the update in which it happens and in the next one.
class Storyboard {
 public:
  /// References must outlive the object. Throws InputError with file and line for a condition on an
  /// element that is not there.
  Storyboard(const Scenario& scenario, Stage& stage);
  ~Storyboard();

  /// Evaluates the triggers at `time` [s], which grows from call to call, and starts actions.
  void update(double time);
  /// Whether its stop trigger has fired, or its last story has ended where that ends the scenario.
  bool over() const { return over_; }
  /// State of the element of this type ("act", "event" ...) and name ("A::B" for B in A). Throws
  /// InputError for an unknown one.
  ElementState state(const std::string& type, const std::string& name) const;

 private:
  struct Element;
  struct ActionRun;
  struct EventRun;
  struct ManeuverRun;
  struct GroupRun;
  struct ActRun;
  /// What was found of a condition so far.
  struct ConditionMemory {
    std::deque<std::pair<double, bool>> values;  ///< by time, for the delay
    bool before = false;
  };

  void build(const Story& story);
  Element* add(const std::string& type, const std::string& name, const Element* parent);
  const Element* find(const std::string& type, const std::string& name) const;
  void requireElements(const Trigger& trigger) const;
  void requireAllElements() const;
  void enter(Element& element, ElementState state, const char* transition);
  bool fires(const Trigger& trigger);
  bool holds(const Condition& condition);
  bool holdsNow(const Condition& condition);
  bool elementHolds(const ElementStateCondition& condition) const;
  void updateAct(ActRun& act);
  void updateGroup(GroupRun& group);
  void updateEvent(EventRun& event, ManeuverRun& maneuver, const GroupRun& group);
  void startGroup(GroupRun& group);
  void startEvent(EventRun& event, ManeuverRun& maneuver, const GroupRun& group);
  void endEvent(EventRun& event, const char* transition);
  void leaveEvent(EventRun& event, const char* transition);
  void forgetDelays(const EventRun& event);
  void stopGroup(GroupRun& group);

  const Scenario& scenario_;
  Stage& stage_;
  double time_ = 0.0;
  std::uint64_t round_ = 0;
  bool over_ = false;
  std::deque<std::unique_ptr<Element>> elements_;
  std::vector<std::pair<Element*, std::vector<std::unique_ptr<ActRun>>>> stories_;
  std::map<const Condition*, ConditionMemory> memories_;
};

}  // namespace cdiff::storyboard
