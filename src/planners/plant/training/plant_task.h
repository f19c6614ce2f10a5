// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task.h"
#include "learning/task_registry.h"
#include "planners/plant/training/plant_net.h"
#include "planners/plant/training/plant_samples.h"

namespace cdiff::planners {

/// What the training of PlanT asks beyond the options of every training.
struct PlantTrainingSettings {
  PlantArchitecture architecture;
  learning::SceneSampleOptions samples;

  void describe(core::OptionsVisitor& visitor) {
    architecture.describe(visitor);
    samples.describe(visitor);
  }
};

/// The network and all examples of a run.
struct PlantTrainingState {
  const learning::TrainingRun& run;
  PlantArchitecture architecture;
  PlantNet net;
  std::vector<PlantExample> examples;  ///< by index in the data set
};

/// The training of PlanT: it imitates the waypoints of the vehicles that were driven in scenes, in
/// one stage, `imitation`.
class PlantTask : public learning::OneStageTask {
 public:
  PlantTask();
  std::vector<std::string> weightFiles() const override { return {kPlant.file}; }
  learning::SampleSchema sceneFields() const override { return plantFields(); }
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  void describe(core::OptionsVisitor& visitor) override { settings.describe(visitor); }
  void validate() const override { settings.architecture.validate(); }

  void start(const learning::TrainingRun& run) override;
  nlohmann::json facts() const override;
  std::vector<learning::TrainedPart> parts() override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;
  learning::TrainedModel finish() override;

  PlantTrainingSettings settings;

 private:
  std::optional<PlantSampler> sampler_;
  std::unique_ptr<PlantTrainingState> state_;
};

/// The task "plant".
learning::TaskDescriptor plantTraining();

}  // namespace cdiff::planners
