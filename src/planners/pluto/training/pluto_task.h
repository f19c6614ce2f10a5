// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task_registry.h"
#include "planners/network_task.h"
#include "planners/pluto/training/pluto_examples.h"
#include "planners/pluto/training/pluto_scenes.h"
#include "planners/pluto/training/pluto_trainer_network.h"

namespace cdiff::planners {

/// What the training of Pluto asks beyond the options of every training.
struct PlutoTrainingSettings {
  PlutoArchitecture architecture;
  PlutoSampleOptions samples;
  double motion_dropout = 0.75;  ///< chance that speed, acceleration or steer is not shown
  double history_dropout = 0.1;  ///< chance that less of the history is shown, as after a start
  double layer_dropout = 0.1;    ///< chance that a step of the encoder is left out
  double disturbed_share = 0.5;  ///< chance that a moment is one off the way, to lead back from
  OwnDisturbance disturbance{1.0, 2.0, 0.35, 1.5, 1.0, 0.3};
  double contrast_share = 1.0 / 3.0;  ///< last part of the steps that learns from triplets, too

  void describe(core::OptionsVisitor& visitor);
};

/// The network and all moments of a run.
struct PlutoTrainingState {
  const learning::TrainingRun& run;
  const PlutoTrainingSettings& settings;
  PlutoNet net;
  const std::vector<PlutoScene>& scenes;
  std::vector<PlutoPlace> places;  ///< by index in the data set
};

/// The training of Pluto: it imitates the vehicles that were driven in scenes, in one stage,
/// `imitation`.
class PlutoTask : public NetworkTask<PlutoTrainingSettings, PlutoTrainingState> {
 public:
  PlutoTask();
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  void start(const learning::TrainingRun& run) override;
  nlohmann::json facts() const override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;

 protected:
  std::string table(const learning::Measures& held_out) const override;

 private:
  std::optional<PlutoWorlds> worlds_;
  std::vector<PlutoScene> scenes_;
};

/// The task "pluto".
learning::TaskDescriptor plutoTraining();

}  // namespace cdiff::planners
