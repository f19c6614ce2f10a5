// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task_registry.h"
#include "planners/ppo/training/ppo_stage.h"

namespace cdiff::planners {

/// The training of the planner ppo: proximal policy optimization in sessions of its own.
class PpoTask : public learning::OneStageTask {
 public:
  PpoTask()
      : OneStageTask(PpoStage::kStage, PpoStage::kBatch,
                     {{"actor", "an actor"}, {"critic", "a critic"}}) {}
  std::vector<std::string> weightFiles() const override { return {kPpo.file}; }
  bool needsSamples() const override { return false; }
  void setDefaults(learning::TrainingOptions& options) const override;
  void describe(core::OptionsVisitor& visitor) override;
  void validate() const override;
  void start(const learning::TrainingRun& run) override;
  nlohmann::json facts() const override;
  std::vector<learning::TrainedPart> parts() override {
    return {{"actor", &training_->networks.actor()}, {"critic", &training_->networks.critic()}};
  }
  std::unique_ptr<learning::Stage> makeStage(const std::string&) override {
    return std::make_unique<PpoStage>(*training_);
  }
  learning::TrainedModel finish() override;

 private:
  std::string sentence() const;
  std::string measuresText(const learning::Measures& held_out) const;

  PpoSettings settings_;
  std::optional<PpoRoutes> routes_;
  std::optional<PpoTraining> training_;
};

/// The task "ppo".
learning::TaskDescriptor ppoTraining();

}  // namespace cdiff::planners
