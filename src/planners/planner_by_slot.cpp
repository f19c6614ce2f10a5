// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/planner_by_slot.h"

#include <algorithm>
#include <exception>

#include "core/forked_work.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "traffic/shown_fault.h"

namespace cdiff::planners {
namespace {

using planning::PlannedAction;
using planning::PlannerDescriptor;
using planning::PlanningTask;
using Descriptors = std::vector<const PlannerDescriptor*>;

/// The actions of one member for its tasks; fail-safe ones with the fault when it fails.
std::vector<PlannedAction> planOne(PlannerBySlot::Member& member,
                                   const traffic::TrafficSnapshot& snapshot,
                                   const std::vector<PlanningTask>& tasks) {
  std::string fault = "the planner answered for other vehicles than it was asked for";
  const core::NamedCall call("planner", member.name);
  try {
    std::vector<PlannedAction> actions = member.planner->plan(snapshot, tasks);
    const bool all = std::equal(actions.begin(), actions.end(), tasks.begin(), tasks.end(),
                                [](const PlannedAction& action, const PlanningTask& task) {
                                  return action.slot == task.slot;
                                });
    if (all) return actions;
  } catch (const std::exception& error) {
    fault = traffic::thrownFaultText(error);
  } catch (...) {
    fault = "the planner threw something that is no std::exception";
  }
  std::vector<PlannedAction> actions;
  for (const PlanningTask& task : tasks) {
    actions.push_back(planning::failSafeAction(task));
    actions.back().fault = member.name + ": " + fault;
  }
  return actions;
}

/// "a + b" of one text per member that has one.
template <class TextOf>
std::string joinedOf(const Descriptors& members, const char* separator, const TextOf& text_of) {
  std::vector<std::string> texts;
  for (const PlannerDescriptor* member : members) texts.push_back(text_of(*member));
  return core::joinText(texts, separator);
}

Descriptors withNetwork(Descriptors members) {
  const auto none = [](const PlannerDescriptor* member) { return !member->network; };
  members.erase(std::remove_if(members.begin(), members.end(), none), members.end());
  return members;
}

planning::NetworkFacts networkOf(const Descriptors& members,
                                 const planning::PlannerOptionsTable& options,
                                 const guidance::GuidanceOptions& guidance) {
  planning::NetworkFacts joined;
  for (const PlannerDescriptor* member : members) {
    const planning::NetworkFacts facts = member->network(options, guidance);
    const auto add = [](std::string& text, const std::string& next) {
      if (!next.empty()) text += (text.empty() ? "" : " + ") + next;
    };
    add(joined.model, facts.model);
    add(joined.conditioning, facts.conditioning);
    add(joined.sampling, facts.sampling);
    joined.instruction_sets.insert(facts.instruction_sets.begin(), facts.instruction_sets.end());
  }
  return joined;
}

/// Names of the planners with this role, sorted; last the user's own node.
std::vector<std::string> plannersFor(Role role) {
  std::vector<std::string> names;
  for (const PlannerDescriptor* planner : registeredPlanners()) {
    if (role == Role::kEgo ? planner->drives_ego : planner->drives_cbv)
      names.push_back(planner->name);
  }
  names.emplace_back(planning::kExternalPlanner);
  return names;
}

/// Of one planner; `place` names key and value.
void requireOnePlanner(const std::string& place, const std::string& name, Role role) {
  const std::vector<std::string> names = plannersFor(role);
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  if (findPlanner(name) != nullptr) {
    throw core::InputError(place + ", a planner that does not drive " +
                           (role == Role::kEgo ? "the ego" : "CBVs") + "; expected one of " +
                           core::joinText(names, ", "));
  }
  throw core::InputError(place + ", an unknown planner" + core::didYouMean(name, names) +
                         "; known: " + core::joinText(names, ", "));
}

}  // namespace

PlannerBySlot::PlannerBySlot(std::vector<Member> members) : members_(std::move(members)) {}

std::vector<PlannedAction> PlannerBySlot::plan(const traffic::TrafficSnapshot& snapshot,
                                               const std::vector<PlanningTask>& tasks) {
  std::vector<PlannedAction> actions;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    std::vector<PlanningTask> own;
    for (const PlanningTask& task : tasks) {
      if (static_cast<std::size_t>(task.slot) % members_.size() == i) own.push_back(task);
    }
    if (own.empty()) continue;
    for (PlannedAction& action : planOne(members_[i], snapshot, own))
      actions.push_back(std::move(action));
  }
  std::sort(actions.begin(), actions.end(),
            [](const PlannedAction& a, const PlannedAction& b) { return a.slot < b.slot; });
  return actions;
}

void PlannerBySlot::setGuidance(const guidance::GuidanceOptions& guidance) {
  for (const Member& member : members_) member.planner->setGuidance(guidance);
}

std::vector<std::string> planningMembers(const std::string& joined) {
  return core::splitText(joined, '+');
}

std::string plannerOfSlot(const std::string& joined, int slot) {
  const std::vector<std::string> members = planningMembers(joined);
  return members[static_cast<std::size_t>(slot) % members.size()];
}

void requirePlanner(const std::string& key, const std::string& name, Role role) {
  const std::string place = "key '" + key + "' is '" + name + "'";
  const bool by_slot = role == Role::kCbv && name.find('+') != std::string::npos;
  if (!by_slot) return requireOnePlanner(place, name, role);
  const std::vector<std::string> members = planningMembers(name);
  for (const std::string& member : members) {
    if (member == planning::kExternalPlanner)
      throw core::InputError(place + "; 'external' drives the CBVs of all slots: give it alone");
    requireOnePlanner(place + ": '" + member + "'", member, role);
  }
  if (members.size() > 1 && core::joinText(members, "+") == name) return;
  std::vector<std::string> possible = plannersFor(role);
  possible.pop_back();
  throw core::InputError(place + "; expected names of planners by slot, joined by single '+', of " +
                         core::joinText(possible, ", "));
}

PlannerDescriptor describeBySlot(const Descriptors& members) {
  PlannerDescriptor joined;
  joined.name = joinedOf(members, "+", [](const auto& member) { return member.name; });
  joined.title = joinedOf(members, " + ", [](const auto& member) { return member.title; });
  joined.help = "By slot: " + joinedOf(members, ", ", [](const auto& each) { return each.name; });
  joined.drives_ego = false;
  for (const PlannerDescriptor* member : members) {
    joined.drives_cbv = joined.drives_cbv && member->drives_cbv;
    joined.guided = joined.guided || member->guided;
    for (const std::string& camera : member->cameras) {
      if (std::find(joined.cameras.begin(), joined.cameras.end(), camera) == joined.cameras.end())
        joined.cameras.push_back(camera);
    }
  }
  joined.options = members.front()->options;
  joined.make =
      [members](const planning::PlannerParts& parts) -> std::unique_ptr<planning::Planner> {
    std::vector<PlannerBySlot::Member> made;
    for (const PlannerDescriptor* member : members)
      made.push_back({member->name, makePlanner(member->name, parts)});
    return std::make_unique<PlannerBySlot>(std::move(made));
  };
  const Descriptors learned = withNetwork(members);
  if (learned.empty()) return joined;
  joined.network = [learned](const auto& options, const auto& guidance) {
    return networkOf(learned, options, guidance);
  };
  joined.weights_sha256 = [learned](const auto& options) {
    return joinedOf(learned, "+", [&](const auto& each) { return each.weights_sha256(options); });
  };
  return joined;
}

}  // namespace cdiff::planners
