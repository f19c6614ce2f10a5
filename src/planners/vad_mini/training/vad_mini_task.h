// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task_registry.h"
#include "planners/camera_ego/training/ego_data.h"
#include "planners/camera_ego/training/open_loop.h"
#include "planners/network_task.h"
#include "planners/vad_mini/training/vad_mini_loss.h"
#include "planners/vad_mini/training/vad_mini_trainer_network.h"

namespace cdiff::planners {

/// What the training of `vad_mini` asks beyond the options of every training.
struct VadMiniTrainingSettings {
  VadMiniArchitecture architecture;
  EgoSampleOptions samples;
  bool intermediate_losses = true;  ///< detection, forecasts and map are supervised
  double constraint_start = 0.4;    ///< part of the steps before the three constraints count
  double past_start = 0.3;          ///< part of the steps before past looks are encoded
  std::string judged_by_network;    ///< file for the held-out measures of each network; "": none

  void describe(core::OptionsVisitor& visitor);
};

/// The network and all moments of a run.
struct VadMiniTrainingState {
  const learning::TrainingRun& run;
  const VadMiniTrainingSettings& settings;
  VadMiniNet net;
  EgoData& data;
  std::optional<ConstantDetections> prior;
};

/// The training of `vad_mini`: it imitates the vehicles that were driven in scenes, whose views it
/// renders again, in one stage, `imitation`.
class VadMiniTask : public NetworkTask<VadMiniTrainingSettings, VadMiniTrainingState> {
 public:
  VadMiniTask();
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  nlohmann::json facts() const override;
  void start(const learning::TrainingRun& run) override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;

 protected:
  std::string table(const learning::Measures& held_out) const override;

 private:
  EgoData data_;
};

/// The task "vad_mini".
learning::TaskDescriptor vadMiniTraining();

}  // namespace cdiff::planners
