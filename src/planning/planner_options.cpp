// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner_options.h"

namespace cdiff::planning {

PlannerOptionsTable::PlannerOptionsTable(const PlannerOptionsTable& other) {
  for (const Entry& entry : other.entries_)
    entries_.push_back({entry.name, entry.help, entry.options->clone()});
}

PlannerOptionsTable& PlannerOptionsTable::operator=(const PlannerOptionsTable& other) {
  if (this != &other) *this = PlannerOptionsTable(other);
  return *this;
}

void PlannerOptionsTable::describe(core::OptionsVisitor& visitor) {
  for (Entry& entry : entries_)
    visitor.group({entry.name.c_str(), "", entry.help.c_str()}, *entry.options);
}

void PlannerOptionsTable::validate() const {
  for (const Entry& entry : entries_) entry.options->validate();
}

}  // namespace cdiff::planning
