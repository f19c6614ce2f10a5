// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/storyboard.h"

#include <algorithm>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::storyboard {

struct Storyboard::Element {
  std::string type;
  std::string path;  ///< names from the story on, with "::" between them
  ElementState state = ElementState::kStandby;
  std::string transition;   ///< last one
  std::uint64_t round = 0;  ///< of that transition
};

struct Storyboard::ActionRun {
  Element* element = nullptr;
  const Action* action = nullptr;
  std::vector<std::shared_ptr<Performance>> performances;
};

struct Storyboard::EventRun {
  Element* element = nullptr;
  const Event* event = nullptr;
  int executions = 0;
  std::vector<ActionRun> actions;
};

struct Storyboard::ManeuverRun {
  Element* element = nullptr;
  std::vector<EventRun> events;
};

struct Storyboard::GroupRun {
  Element* element = nullptr;
  const ManeuverGroup* group = nullptr;
  int executions = 0;
  std::vector<ManeuverRun> maneuvers;
};

struct Storyboard::ActRun {
  Element* element = nullptr;
  const Act* act = nullptr;
  std::vector<GroupRun> groups;
};

namespace {

constexpr const char* kStart = "startTransition";
constexpr const char* kEnd = "endTransition";
constexpr const char* kStop = "stopTransition";
constexpr const char* kSkip = "skipTransition";

/// Whether `path` ends with the names of `reference`.
bool endsWithNames(const std::string& path, const std::string& reference) {
  return path == reference || core::endsWith(path, "::" + reference);
}

template <class Runs>
bool allComplete(const Runs& runs) {
  return std::all_of(runs.begin(), runs.end(),
                     [](const auto& run) { return run.element->state == ElementState::kComplete; });
}

}  // namespace

Storyboard::Storyboard(const Scenario& scenario, Stage& stage)
    : scenario_(scenario), stage_(stage) {
  for (const Story& story : scenario.stories) build(story);
  requireAllElements();
}

Storyboard::~Storyboard() = default;

Storyboard::Element* Storyboard::add(const std::string& type, const std::string& name,
                                     const Element* parent) {
  auto element = std::make_unique<Element>();
  element->type = type;
  element->path = parent == nullptr ? name : parent->path + "::" + name;
  elements_.push_back(std::move(element));
  return elements_.back().get();
}

void Storyboard::build(const Story& story) {
  Element* const top = add("story", story.name, nullptr);
  stories_.emplace_back(top, std::vector<std::unique_ptr<ActRun>>());
  for (const Act& act : story.acts) {
    auto act_run = std::make_unique<ActRun>();
    act_run->element = add("act", act.name, top);
    act_run->act = &act;
    for (const ManeuverGroup& group : act.groups) {
      GroupRun group_run{add("maneuverGroup", group.name, act_run->element), &group, 0, {}};
      for (const Maneuver& maneuver : group.maneuvers) {
        ManeuverRun maneuver_run{add("maneuver", maneuver.name, group_run.element), {}};
        for (const Event& event : maneuver.events) {
          EventRun event_run{add("event", event.name, maneuver_run.element), &event, 0, {}};
          for (const Action& action : event.actions)
            event_run.actions.push_back(
                {add("action", action.name, event_run.element), &action, {}});
          maneuver_run.events.push_back(std::move(event_run));
        }
        group_run.maneuvers.push_back(std::move(maneuver_run));
      }
      act_run->groups.push_back(std::move(group_run));
    }
    stories_.back().second.push_back(std::move(act_run));
  }
}

const Storyboard::Element* Storyboard::find(const std::string& type,
                                            const std::string& name) const {
  for (const auto& element : elements_)
    if (element->type == type && endsWithNames(element->path, name)) return element.get();
  return nullptr;
}

void Storyboard::requireElements(const Trigger& trigger) const {
  for (const auto& group : trigger.groups) {
    for (const Condition& condition : group) {
      const auto* const state = std::get_if<ElementStateCondition>(&condition.what);
      if (state == nullptr || find(state->type, state->element) != nullptr) continue;
      std::vector<std::string> known;
      for (const auto& element : elements_)
        if (element->type == state->type) known.push_back(element->path);
      throw core::InputError(condition.source.text() + ": there is no " + state->type + " '" +
                             state->element + "'; expected one of {" +
                             core::shortened(core::joinText(known, ", "), 300) + "}");
    }
  }
}

void Storyboard::requireAllElements() const {
  if (scenario_.stop) requireElements(*scenario_.stop);
  for (const Story& story : scenario_.stories) {
    for (const Act& act : story.acts) {
      if (act.start) requireElements(*act.start);
      if (act.stop) requireElements(*act.stop);
      for (const ManeuverGroup& group : act.groups)
        for (const Maneuver& maneuver : group.maneuvers)
          for (const Event& event : maneuver.events)
            if (event.start) requireElements(*event.start);
    }
  }
}

ElementState Storyboard::state(const std::string& type, const std::string& name) const {
  const Element* const element = find(type, name);
  if (element == nullptr) throw core::InputError("there is no " + type + " '" + name + "'");
  return element->state;
}

void Storyboard::enter(Element& element, ElementState state, const char* transition) {
  element.state = state;
  element.transition = transition;
  element.round = round_;
}

bool Storyboard::elementHolds(const ElementStateCondition& condition) const {
  const Element& element = *find(condition.type, condition.element);
  if (condition.state == "standbyState") return element.state == ElementState::kStandby;
  if (condition.state == "runningState") return element.state == ElementState::kRunning;
  if (condition.state == "completeState") return element.state == ElementState::kComplete;
  return element.transition == condition.state && element.round + 1 >= round_;
}

bool Storyboard::holdsNow(const Condition& condition) {
  const auto* const state = std::get_if<ElementStateCondition>(&condition.what);
  return state != nullptr ? elementHolds(*state) : stage_.holds(condition, time_);
}

/// With edge and delay. The edge is found first, and its answer is delayed.
bool Storyboard::holds(const Condition& condition) {
  constexpr double kTolerance = 1e-6;  // [s]
  using Edge = Condition::Edge;
  ConditionMemory& memory = memories_[&condition];
  const bool now = holdsNow(condition);
  const bool rises = now && !memory.before;
  const bool falls = !now && memory.before;
  memory.before = now;
  const bool found = condition.edge == Edge::kNone      ? now
                     : condition.edge == Edge::kRising  ? rises
                     : condition.edge == Edge::kFalling ? falls
                                                        : rises || falls;
  if (condition.delay <= 0.0) return found;
  memory.values.emplace_back(time_, found);
  bool delayed = false;
  while (!memory.values.empty() &&
         memory.values.front().first <= time_ - condition.delay + kTolerance) {
    delayed = delayed || memory.values.front().second;
    memory.values.pop_front();
  }
  return delayed;
}

bool Storyboard::fires(const Trigger& trigger) {
  bool any = false;
  for (const auto& group : trigger.groups) {
    bool all = !group.empty();
    for (const Condition& condition : group) all = holds(condition) && all;
    any = any || all;
  }
  return any;
}

void Storyboard::update(double time) {
  if (over_) return;
  time_ = time;
  ++round_;
  for (auto& [story, acts] : stories_) {
    if (story->state == ElementState::kStandby) enter(*story, ElementState::kRunning, kStart);
    bool complete = true;
    for (const auto& act : acts) {
      updateAct(*act);
      complete = complete && act->element->state == ElementState::kComplete;
    }
    if (complete && story->state == ElementState::kRunning)
      enter(*story, ElementState::kComplete, kEnd);
  }
  const bool told =
      !stories_.empty() && std::all_of(stories_.begin(), stories_.end(), [](const auto& story) {
        return story.first->state == ElementState::kComplete;
      });
  over_ = (scenario_.stop && fires(*scenario_.stop)) || (scenario_.ends_with_stories && told);
}

void Storyboard::updateAct(ActRun& act) {
  Element& element = *act.element;
  if (element.state == ElementState::kStandby) {
    if (act.act->start && !fires(*act.act->start)) return;
    enter(element, ElementState::kRunning, kStart);
    for (GroupRun& group : act.groups) startGroup(group);
  }
  if (element.state != ElementState::kRunning) return;
  if (act.act->stop && fires(*act.act->stop)) {
    for (GroupRun& group : act.groups) stopGroup(group);
    enter(element, ElementState::kComplete, kStop);
    return;
  }
  for (GroupRun& group : act.groups) updateGroup(group);
  if (allComplete(act.groups)) enter(element, ElementState::kComplete, kEnd);
}

void Storyboard::startGroup(GroupRun& group) {
  ++group.executions;
  enter(*group.element, ElementState::kRunning, kStart);
  for (ManeuverRun& maneuver : group.maneuvers) {
    enter(*maneuver.element, ElementState::kRunning, kStart);
    for (EventRun& event : maneuver.events) {
      event.executions = 0;
      event.element->state = ElementState::kStandby;
      forgetDelays(event);
      for (const ActionRun& action : event.actions) action.element->state = ElementState::kStandby;
    }
  }
}

void Storyboard::stopGroup(GroupRun& group) {
  for (ManeuverRun& maneuver : group.maneuvers) {
    for (EventRun& event : maneuver.events) {
      if (event.element->state != ElementState::kComplete) endEvent(event, kStop);
    }
    if (maneuver.element->state != ElementState::kComplete)
      enter(*maneuver.element, ElementState::kComplete, kStop);
  }
  if (group.element->state != ElementState::kComplete)
    enter(*group.element, ElementState::kComplete, kStop);
}

void Storyboard::updateGroup(GroupRun& group) {
  if (group.element->state != ElementState::kRunning) return;
  for (ManeuverRun& maneuver : group.maneuvers) {
    for (EventRun& event : maneuver.events) updateEvent(event, maneuver, group);
    if (maneuver.element->state == ElementState::kRunning && allComplete(maneuver.events))
      enter(*maneuver.element, ElementState::kComplete, kEnd);
  }
  if (!allComplete(group.maneuvers)) return;
  if (group.executions < group.group->executions) {
    startGroup(group);
  } else {
    enter(*group.element, ElementState::kComplete, kEnd);
  }
}

void Storyboard::updateEvent(EventRun& event, ManeuverRun& maneuver, const GroupRun& group) {
  if (event.element->state == ElementState::kStandby) {
    if (!event.event->start || fires(*event.event->start)) startEvent(event, maneuver, group);
    return;
  }
  if (event.element->state != ElementState::kRunning) return;
  for (const ActionRun& action : event.actions) {
    const bool over = std::all_of(action.performances.begin(), action.performances.end(),
                                  [](const auto& performance) { return performance->over; });
    if (over && action.element->state == ElementState::kRunning)
      enter(*action.element, ElementState::kComplete, kEnd);
  }
  if (allComplete(event.actions)) endEvent(event, kEnd);
}

void Storyboard::startEvent(EventRun& event, ManeuverRun& maneuver, const GroupRun& group) {
  for (EventRun& other : maneuver.events) {
    if (other.element->state != ElementState::kRunning) continue;
    if (event.event->priority == Event::Priority::kSkip) {
      ++event.executions;
      return leaveEvent(event, kSkip);
    }
    if (event.event->priority == Event::Priority::kOverride) endEvent(other, kStop);
  }
  ++event.executions;
  enter(*event.element, ElementState::kRunning, kStart);
  for (ActionRun& action : event.actions) {
    enter(*action.element, ElementState::kRunning, kStart);
    action.performances = stage_.begin(*action.action, group.group->actors, time_);
  }
}

void Storyboard::endEvent(EventRun& event, const char* transition) {
  for (ActionRun& action : event.actions) {
    for (const auto& performance : action.performances) performance->stopped = true;
    action.performances.clear();
    if (action.element->state == ElementState::kRunning)
      enter(*action.element, ElementState::kComplete, transition);
  }
  leaveEvent(event, transition);
}

/// To standby where it may run again, and complete where it may not or was stopped.
void Storyboard::leaveEvent(EventRun& event, const char* transition) {
  const bool stopped = std::string(transition) == kStop;
  const bool last = stopped || event.executions >= event.event->executions;
  enter(*event.element, last ? ElementState::kComplete : ElementState::kStandby, transition);
  if (!last) forgetDelays(event);
}

/// What a delayed condition found before its event came to standby counts no more.
void Storyboard::forgetDelays(const EventRun& event) {
  if (!event.event->start) return;
  for (const auto& group : event.event->start->groups)
    for (const Condition& condition : group) memories_[&condition].values.clear();
}

}  // namespace cdiff::storyboard
