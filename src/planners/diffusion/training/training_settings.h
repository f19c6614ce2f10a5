// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/options.h"

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
  diffusion::Architecture architecture;  ///< sizes that the data do not fix; not described

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key.
  void validate() const;
};

}  // namespace cdiff::planners
