// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/options.h"
#include "learning/task.h"
#include "planners/diffusion/training/diffusion_loss.h"

namespace cdiff::planners {

/// What the training of the diffusion planner asks beyond the options of every training.
struct DiffusionTrainingSettings {
  std::string precision = "auto";  ///< the encoder's convolutions in training: auto | f32 | bf16
  std::string loss = "weighted";   ///< weighted | plain (the paper's), see DiffusionLoss
  double image_scale = 1.0;        ///< scale of images in stage `encoder`: 1 or 0.5
  double route_drop = 0.2;         ///< share of samples without route in diffusion stages
  double balance = 0.5;         ///< 0: samples as collected; 1: all kinds of driving equally often
  double yielding_share = 1.0;  ///< part kept of samples that stop to give way
  bool mirror = true;           ///< every second sample is mirrored
  bool change_light = true;     ///< photometric changes of images
  /// default | paper (Architecture::imageAlone) | pinned (Architecture::pinned) | motion
  /// (Architecture::withMotion)
  std::string network = "default";
  diffusion::Architecture architecture;  ///< sizes that the data do not fix; not described

  /// Those of `network` where it is not the default.
  diffusion::Architecture sizes() const;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key.
  void validate() const;
};

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

/// Held-out samples as a batch with features of the current encoder, and features of a gray image.
struct HeldOut {
  TrainingBatch batch;
  at::Tensor gray_features;
};
HeldOut encodeHeldOut(const TrainingState& state);

}  // namespace cdiff::planners
