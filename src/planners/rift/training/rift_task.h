// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task.h"
#include "learning/task_registry.h"
#include "planners/rift/training/rift_groups.h"
#include "planners/rift/training/rift_objective.h"

namespace cdiff::planners {

/// What the fine-tuning of RIFT asks beyond the options of every training.
struct RiftTrainingSettings {
  learning::SceneSampleOptions samples;
  std::string objective = "rift";                 ///< rift | grpo
  double kl_weight = 0.2;                         ///< of `grpo`
  std::int64_t buffer = 4096;                     ///< states gathered at a time
  std::int64_t epochs = 16;                       ///< passes over them
  std::string tracker = planning::kTunedTracker;  ///< of plans, that drives the candidates

  void describe(core::OptionsVisitor& visitor);
  RiftObjective objectiveOf() const;
};

/// The network and all moments of a run.
struct RiftTrainingState {
  const learning::TrainingRun& run;
  const RiftTrainingSettings& settings;
  PlutoModel model;             ///< that it started from
  std::string start;            ///< SHA-256 of its file
  learning::ParameterSet head;  ///< what is trained: the score head
  RiftGroups groups;
  const std::vector<PlutoScene>& scenes;
  const std::vector<RiftMoment>& moments;  ///< by index in the data set
};

/// The fine-tuning of RIFT: Pluto's score head learns by simulated returns, in one stage,
/// `fine_tune`, which alternately gathers states and trains on them. It can be resumed where states
/// are to be gathered again.
class RiftTask : public learning::OneStageTask {
 public:
  RiftTask();
  std::vector<std::string> weightFiles() const override { return {kRift.file}; }
  learning::SampleSchema sceneFields() const override { return plutoFields(); }
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  void describe(core::OptionsVisitor& visitor) override { settings.describe(visitor); }

  /// Throws InputError for steps that are not a multiple of a buffer's.
  void start(const learning::TrainingRun& run) override;
  nlohmann::json facts() const override;
  std::vector<learning::TrainedPart> parts() override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;
  learning::TrainedModel finish() override;

  RiftTrainingSettings settings;

 private:
  std::optional<PlutoWorlds> worlds_;
  std::vector<PlutoScene> scenes_;
  std::vector<RiftMoment> moments_;
  std::unique_ptr<RiftTrainingState> state_;
};

/// The task "rift".
learning::TaskDescriptor riftTraining();

}  // namespace cdiff::planners
