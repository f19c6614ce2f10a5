// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Trains the diffusion planner by the paper's loss in stages: `encoder` (image encoder with a
/// regression head, optionally on smaller images), `fine_tune` (the same at full size), `denoiser`
/// (on the frozen encoder's features, computed once) and `joint` (everything by the diffusion
/// loss). Each stage starts from the averaged weights of the checkpoints in the output folder.
#pragma once

#include <atomic>
#include <cstdint>
#include <iosfwd>
#include <string>

#include "diffusion/architecture.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"

namespace cdiff::training {

struct TrainingOptions {
  std::string stage = "all";   ///< encoder | fine_tune | denoiser | joint | export | all
  std::string data;            ///< folder with *.shard
  std::string output;          ///< folder for checkpoints and the model
  std::string init;            ///< model to start from where no checkpoint is; empty: none
  std::int64_t steps = 20000;  ///< of the stage
  std::int64_t batch = 0;      ///< samples per step; 0: 32 with images, 128 on features
  std::int64_t threads = 1;
  std::int64_t seed = 1;
  double time_limit = 0.0;         ///< of the stage's steps, over all resumptions [s]; 0: none
  bool anneal_by_time = false;     ///< learning rate falls with time instead of steps
  bool resume = false;             ///< the stage goes on from its checkpoint if there is one
  bool overwrite = false;          ///< the stage replaces an earlier training
  std::string device = "auto";     ///< auto | cpu | cuda
  std::string precision = "auto";  ///< of the encoder's convolutions in training: auto | f32 | bf16
  double image_scale = 1.0;        ///< of stage `encoder`: 1 or 0.5
  double learning_rate = 2e-4;
  double weight_decay = 1e-4;
  std::int64_t warm_up = 500;    ///< steps
  double clip = 1.0;             ///< norm of the gradient
  double average_decay = 0.999;  ///< of the moving average of the weights, at most
  double route_drop = 0.2;       ///< share of samples without route in diffusion stages
  double balance = 0.5;  ///< 0: samples as often as collected; 1: every kind of driving alike
  double yielding_share = 1.0;    ///< part kept of samples that stop to give way
  bool mirror = true;             ///< every second sample is mirrored
  bool change_light = true;       ///< photometric changes of images
  double validation_share = 0.1;  ///< of the sessions
  std::int64_t validation_samples = 256;
  std::int64_t validation_every = 1000;  ///< steps
  double checkpoint_every = 300.0;       ///< [s]
  double report_every = 10.0;            ///< [s]
  diffusion::Architecture architecture;  ///< sizes that the data do not fix; not described

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key.
  void validate() const;
};

/// A loss or a weight stopped being finite. `cdiff train` exits with 2.
class DivergedError : public core::Error {
 public:
  using core::Error::Error;
};

/// Runs the stage, or all of them, and writes the model (`encoder.safetensors`,
/// `denoiser.safetensors`, `training.json`, `model_card.md`) after the last; `fine_tune`
/// alone writes it with the denoiser of the output folder or the initial model, where one is.
/// `stop`, set from another thread or a signal, ends it after the current step with a checkpoint
/// and core::Interrupted. Throws InputError for wrong options or data, and for an output folder
/// that holds a training of the stage unless it is to be resumed or overwritten.
void train(const TrainingOptions& options, const std::atomic<bool>& stop, std::ostream& log);

}  // namespace cdiff::training
