// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "learning/task.h"
#include "planners/diffusion/training/diffusion_loss.h"
#include "planners/diffusion/training/training_settings.h"

namespace cdiff::planners {

// The stages of the diffusion planner's training: which weights each trains by which loss, and how
// held-out samples judge it.

/// The networks and what all stages share.
struct TrainingState {
  const learning::TrainingRun& run;
  learning::DrivingDataset dataset;
  const DiffusionTrainingSettings& settings;
  diffusion::Architecture architecture;
  diffusion::Normalizer normalizer;
  ImageEncoderNet encoder;
  RegressionHead head;
  DenoiserNet denoiser;
  DiffusionLoss loss;
  bool half_precision;  ///< of the encoder's convolutions while training
};

/// The encoder under a regression head: MSE of normalized rollout and auxiliary targets.
std::unique_ptr<learning::Stage> makeEncoderStage(TrainingState& state, const std::string& name,
                                                  double image_scale);
/// The denoiser on cached features, or with the encoder where `cache` is nullptr.
std::unique_ptr<learning::Stage> makeDiffusionStage(TrainingState& state, const std::string& name,
                                                    const FeatureCache* cache);

/// Held-out samples as a batch with features of the present encoder, and features of a gray image.
struct HeldOut {
  TrainingBatch batch;
  at::Tensor grey_features;
};
HeldOut encodeHeldOut(const TrainingState& state);

}  // namespace cdiff::planners
