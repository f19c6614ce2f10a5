// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What tests of training tasks share: a folder with data and trainings, which are made, run,
/// interrupted and compared.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/task_registry.h"
#include "learning/trainer.h"
#include "learning/training_folder.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

/// Sets a flag when a line with `text` is logged.
class StoppingBuffer : public std::stringbuf {
 public:
  StoppingBuffer(std::atomic<bool>& stop, std::string text) : stop_(stop), text_(std::move(text)) {}

 protected:
  int sync() override {
    if (str().find(text_) != std::string::npos) stop_ = true;
    return 0;
  }

 private:
  std::atomic<bool>& stop_;
  std::string text_;
};

/// Fixture with an empty folder data/ beside the output folders.
class TrainingFixture : public ::testing::Test {
 protected:
  TrainingFixture() { std::filesystem::create_directories(path("data")); }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  /// A training on the CPU of what lies in data/, with the task's defaults.
  learning::Training trainingOf(const learning::TaskDescriptor& task,
                                const std::string& output) const {
    learning::TaskRegistry tasks;
    tasks.add(task);
    learning::Training training = tasks.training(task.name);
    if (training.needsSamples()) training.options.data = path("data").string();
    training.options.output = path(output).string();
    training.options.device = "cpu";
    training.options.report_every = 0.0;
    return training;
  }
  void train(const learning::Training& training) { learning::train(training, stop_, log_); }
  /// Trains until `text` is logged.
  void trainUntil(const learning::Training& training, const std::string& text) {
    StoppingBuffer buffer(stop_, text);
    std::ostream log(&buffer);
    EXPECT_THROW(learning::train(training, stop_, log), core::Interrupted);
    stop_ = false;
  }
  /// "trained", or what a training that is refused says.
  std::string trainingText(const learning::Training& training) {
    try {
      train(training);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "trained";
  }

  learning::Checkpoint checkpoint(const std::string& output, const std::string& stage) const {
    return learning::readCheckpoint(learning::checkpointPath(path(output).string(), stage));
  }
  /// Weights, moments and averages to the last bit.
  void expectSameCheckpoints(const std::string& left, const std::string& right,
                             const std::string& stage) const {
    const learning::Checkpoint expected = checkpoint(left, stage);
    const learning::Checkpoint found = checkpoint(right, stage);
    ASSERT_EQ(found.tensors.size(), expected.tensors.size());
    for (const auto& [name, tensor] : expected.tensors)
      EXPECT_TRUE(at::equal(found.tensors.at(name), tensor)) << name;
  }
  nlohmann::json record(const std::string& output) const {
    return nlohmann::json::parse(text(output, "training.json"));
  }
  std::string text(const std::string& output, const std::string& file) const {
    return core::readFile(path(output) / file, "file of a training");
  }

  TemporaryFolder folder_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

}  // namespace cdiff::test
