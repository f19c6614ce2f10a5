// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "learning/task.h"
#include "learning/task_registry.h"
#include "planners/diffusion/training/diffusion_stages.h"

namespace cdiff::planners {

/// The training of the diffusion planner by the paper's loss in stages: `encoder` (image encoder
/// with a regression head, optionally on smaller images), `fine_tune` (the same at full size),
/// `denoiser` (on the frozen encoder's features, computed once) and `joint` (everything by the
/// diffusion loss). `fine_tune` alone makes a model with the denoiser of the output folder or of
/// the initial model, where one is.
class DiffusionTask : public learning::Task {
 public:
  learning::TaskTexts texts() const override;
  std::vector<learning::StageInfo> stages() const override;
  std::vector<std::string> allStages() const override;
  std::vector<learning::PartSource> model() const override;
  std::vector<std::string> weightFiles() const override;
  std::vector<std::string> otherFiles() const override;
  std::vector<std::string> fields() const override;
  void describe(core::OptionsVisitor& visitor) override { settings.describe(visitor); }
  void validate() const override { settings.validate(); }

  void start(const learning::TrainingRun& run) override;
  nlohmann::json facts() const override;
  std::vector<learning::TrainedPart> parts() override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;
  learning::TrainedModel finish() override;

  DiffusionTrainingSettings settings;

 private:
  std::unique_ptr<TrainingState> state_;
  FeatureCache cache_;  ///< of stage `denoiser`
};

/// The task "diffusion".
learning::TaskDescriptor diffusionTraining();

}  // namespace cdiff::planners
