// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/registry.h"
#include "learning/training_options.h"

namespace cdiff::learning {

/// What is known about a task before it is made: name, help and constructor.
struct TaskDescriptor {
  std::string name;  ///< value of --task
  std::string help;  ///< what is trained, a sentence without its full stop
  std::shared_ptr<Task> (*make)() = nullptr;
};

/// The table of what can be trained. The program that trains fills it from the list of planners.
class TaskRegistry {
 public:
  /// Throws InputError naming the planner's folder that must change: no constructor, a name that
  /// is not snake_case or that another task has.
  void add(const TaskDescriptor& descriptor);
  std::vector<std::string> names() const { return tasks_.names(); }
  /// The task of this name; an empty name means the first of the table. Throws InputError naming
  /// the nearest known task for an unknown name, and for an empty table.
  const TaskDescriptor& descriptor(const std::string& name) const;

  /// The task of this name with the default options; names and errors as in `descriptor`.
  Training training(const std::string& name = "") const;

 private:
  core::Registry<TaskDescriptor> tasks_{"training task", {}};
};

}  // namespace cdiff::learning
