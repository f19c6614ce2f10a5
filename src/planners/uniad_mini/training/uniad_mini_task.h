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
#include "planners/uniad_mini/training/track_chain.h"

namespace cdiff::planners {

/// What the training of `uniad_mini` asks beyond the options of every training.
struct UniadMiniTrainingSettings {
  UniadMiniArchitecture architecture;
  EgoSampleOptions samples;
  TrackDropOptions drops;
  bool intermediate_losses = true;  ///< in stage end_to_end the plan's losses are not alone

  void describe(core::OptionsVisitor& visitor);
};

/// The network and all moments of a run.
struct UniadTrainingState {
  const learning::TrainingRun& run;
  const UniadMiniTrainingSettings& settings;
  UniadMiniNet net;
  EgoData& data;
  std::optional<ConstantDetections> prior;
  std::string start;  ///< what the weights started from, for the record; empty: from nothing
};

/// The training of `uniad_mini` in two stages, as published: `perception` (image backbone, BEV
/// encoder, tracks and map) and `end_to_end` (tracks, map, motion, occupancy and plan; image
/// backbone and BEV encoder are frozen). It imitates the vehicles that were driven in scenes, whose
/// views it renders again.
class UniadMiniTask : public learning::Task {
 public:
  learning::TaskTexts texts() const override;
  std::vector<learning::StageInfo> stages() const override;
  std::vector<std::string> allStages() const override;
  std::vector<learning::PartSource> model() const override;
  std::vector<std::string> weightFiles() const override { return {kUniadMini.file}; }
  std::vector<std::string> fields() const override;
  learning::SampleSchema sceneFields() const override { return plutoFields(); }
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene) override;
  void setDefaults(learning::TrainingOptions& options) const override;
  void describe(core::OptionsVisitor& visitor) override { settings.describe(visitor); }
  void validate() const override { settings.architecture.validate(); }
  nlohmann::json facts() const override;
  void start(const learning::TrainingRun& run) override;
  std::vector<learning::TrainedPart> parts() override;
  std::unique_ptr<learning::Stage> makeStage(const std::string& name) override;
  learning::TrainedModel finish() override;

  UniadMiniTrainingSettings settings;

 private:
  /// Takes over what `--init` names.
  void startFrom(const std::string& init);

  EgoData data_;
  std::unique_ptr<UniadTrainingState> state_;
};

/// Ways that vehicles around the egos of up to `most` training samples took, for the anchors.
std::vector<TakenWay> takenWays(const learning::TrainingRun& run, EgoData& data, std::size_t most);
/// Those of an example, in the vehicles' own frames; ways that are not known to their end are left
/// out.
std::vector<TakenWay> takenWaysOf(const EgoExample& example);

/// The task "uniad_mini".
learning::TaskDescriptor uniadMiniTraining();

}  // namespace cdiff::planners
