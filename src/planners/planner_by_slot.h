// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner_descriptor.h"

namespace cdiff::planners {

/// Several planners of the CBVs as one: slot k is driven by the (k mod n)-th of n. Each plans its
/// vehicles in one batch, in slot order. One that fails has fail-safe actions and a fault for its
/// vehicles; those of the others are driven on.
class PlannerBySlot final : public planning::Planner {
 public:
  struct Member {
    std::string name;
    std::unique_ptr<planning::Planner> planner;
  };
  explicit PlannerBySlot(std::vector<Member> members);

  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  void setGuidance(const guidance::GuidanceOptions& guidance) override;

 private:
  std::vector<Member> members_;
};

/// The names in "NAME+NAME...", as the key cbv_planner joins them; one name is a list of one.
std::vector<std::string> planningMembers(const std::string& joined);

/// The member of "NAME+NAME..." that drives a slot.
std::string plannerOfSlot(const std::string& joined, int slot);

/// Whom a planner drives.
enum class Role { kEgo, kCbv };

/// Throws InputError naming `key`, its value and what is possible, unless `name` is a planner for
/// this role: for CBVs also several by slot, for the ego also the external one.
void requirePlanner(const std::string& key, const std::string& name, Role role);

/// The descriptor of several planners by slot: it drives CBVs when all of them do, sees and is
/// guided when one does (the others get images, too, and leave them). `members`: two or more.
planning::PlannerDescriptor describeBySlot(
    const std::vector<const planning::PlannerDescriptor*>& members);

}  // namespace cdiff::planners
