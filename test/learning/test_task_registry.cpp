// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/task.h"
#include "learning/task_registry.h"
#include "learning/toy_task.h"

namespace cdiff::learning {
namespace {

template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "taken";
}

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
  EXPECT_EQ(refusal([&] { tasks.add(named("line")); }),
            "training task 'line' is registered twice; one of the two planners must give its "
            "descriptor another name");
  TaskDescriptor half = named("half");
  half.make = nullptr;
  EXPECT_EQ(refusal([&] { tasks.add(half); }),
            "training task 'half' is registered without make; its descriptor in "
            "planners/NAME/training must give one");
  EXPECT_NE(refusal([&] { tasks.add(named("")); }).find("is registered without name"),
            std::string::npos);
  EXPECT_EQ(tasks.names(), std::vector<std::string>{"line"});
}

TEST(TaskRegistry, AnUnknownTaskIsNamedWithTheNearest) {
  TaskRegistry tasks;
  EXPECT_NE(refusal([&] { tasks.training(); }).find("no training task is registered"),
            std::string::npos);
  tasks.add(named("line"));
  tasks.add(named("curve"));
  EXPECT_EQ(refusal([&] { tasks.training("curv"); }),
            "unknown training task 'curv'; the nearest known task is 'curve'");
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
