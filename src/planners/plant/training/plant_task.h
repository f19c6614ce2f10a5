// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task_registry.h"
#include "planners/network_task.h"
#include "planners/plant/training/plant_samples.h"
#include "planners/plant/training/plant_trainer_network.h"

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
class PlantTask : public NetworkTask<PlantTrainingSettings, PlantTrainingState> {
 public:
  PlantTask();
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  void start(const learning::TrainingRun& run) override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;

 protected:
  std::string table(const learning::Measures& held_out) const override;

 private:
  std::optional<PlantSampler> sampler_;
};

/// The task "plant".
learning::TaskDescriptor plantTraining();

}  // namespace cdiff::planners
