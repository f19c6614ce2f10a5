// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The stages of training: which weights each trains by which loss, and how held-out samples judge
/// it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "training/diffusion_task.h"

namespace cdiff::training {

/// The networks and what all stages share.
struct TrainingState {
  const Dataset& dataset;
  const TrainingOptions& options;
  diffusion::Architecture architecture;
  diffusion::Normalizer normalizer;
  at::Device device;
  ImageEncoderNet encoder;
  RegressionHead head;
  DenoiserNet denoiser;
  DiffusionTask task;
  std::vector<std::size_t> held_out;  ///< validation samples that judge
  bool half_precision;                ///< of the encoder's convolutions while training
};

/// Weights that a stage trains; their names in checkpoints begin with `name`.
struct TrainedPart {
  std::string name;
  ParameterSet* parameters;
};

class Stage {
 public:
  virtual ~Stage() = default;
  virtual const std::string& name() const = 0;
  virtual std::vector<TrainedPart> parts() = 0;
  virtual std::int64_t batchSize() const = 0;
  virtual Loss loss(std::int64_t step) = 0;
  /// Samples of a step, for messages.
  virtual std::vector<std::size_t> samplesOf(std::int64_t step) = 0;
  virtual Figures judge() = 0;
};

/// The encoder under a regression head: MSE of normalised rollout and auxiliary targets.
std::unique_ptr<Stage> makeEncoderStage(TrainingState& state, const std::string& name,
                                        double image_scale);
/// The denoiser on cached features, or with the encoder where `cache` is nullptr.
std::unique_ptr<Stage> makeDiffusionStage(TrainingState& state, const std::string& name,
                                          const FeatureCache* cache);

/// Held-out samples as a batch with features of the present encoder, and features of a grey image.
struct HeldOut {
  TrainingBatch batch;
  at::Tensor grey_features;
};
HeldOut encodeHeldOut(const TrainingState& state);

}  // namespace cdiff::training
