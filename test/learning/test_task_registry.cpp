// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/task.h"
#include "learning/task_registry.h"
#include "learning/toy_task.h"
#include "support/error_text.h"

namespace cdiff::learning {
namespace {

using test::errorOf;

TaskDescriptor named(const std::string& name) {
  TaskDescriptor descriptor = test::toyTraining();
  descriptor.name = name;
  return descriptor;
}

TEST(TaskRegistry, MakesTheTaskThatIsAskedForAndElseTheFirst) {
  TaskRegistry tasks;
  tasks.add(named("line"));
  tasks.add(named("curve"));
  EXPECT_EQ(tasks.training().options.task, "line");
  const Training training = tasks.training("curve");
  EXPECT_EQ(training.options.task, "curve");
  EXPECT_EQ(training.tasks, (std::vector<std::string>{"line", "curve"}));
  EXPECT_NE(training.task, tasks.training("curve").task);
}

TEST(TaskRegistry, ATaskIsRegisteredOnceAndWhole) {
  TaskRegistry tasks;
  tasks.add(named("line"));
  EXPECT_EQ(
      errorOf([&] { tasks.add(named("line")); }),
      "a descriptor in planners/NAME/training: training task 'line' is already registered by a "
      "descriptor in planners/NAME/training; one of the two needs another name");
  TaskDescriptor half = named("half");
  half.make = nullptr;
  EXPECT_EQ(errorOf([&] { tasks.add(half); }),
            "a descriptor in planners/NAME/training: training task 'half' has no constructor");
  EXPECT_NE(errorOf([&] { tasks.add(named("")); }).find("its name must be snake_case"),
            std::string::npos);
  EXPECT_EQ(tasks.names(), std::vector<std::string>{"line"});
}

TEST(TaskRegistry, AnUnknownTaskIsNamedWithTheNearest) {
  TaskRegistry tasks;
  EXPECT_NE(errorOf([&] { tasks.training(); }).find("no training task is registered"),
            std::string::npos);
  tasks.add(named("line"));
  tasks.add(named("curve"));
  EXPECT_EQ(errorOf([&] { tasks.training("curv"); }),
            "unknown training task 'curv'; the nearest known training task is 'curve'");
}

/// Names of the described options, in their order.
std::vector<std::string> keysOf(const Training& training) {
  std::vector<std::string> keys;
  std::istringstream lines(core::dumpOptions(training));
  for (std::string line; std::getline(lines, line);) keys.push_back(line.substr(0, line.find(':')));
  return keys;
}

TEST(Training, DescribesTheOptionsOfEveryTrainingThenThoseOfTheTask) {
  TaskRegistry tasks;
  tasks.add(named("line"));
  Training training = tasks.training();
  const std::vector<std::string> keys = keysOf(training);
  EXPECT_EQ(keys.front(), "task");
  EXPECT_EQ(keys.back(), "slope");
  core::overrideOption("slope=3", "option", training);
  EXPECT_EQ(dynamic_cast<test::ToyTask&>(*training.task).slope, 3.0);
  for (const char* stage : {"fit", "export", "all"})
    EXPECT_NO_THROW(core::overrideOption(std::string("stage=") + stage, "option", training));
  EXPECT_THROW(core::overrideOption("stage=encoder", "option", training), core::InputError);
}

}  // namespace
}  // namespace cdiff::learning
