// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "diffusion/sampler.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/guidance_options.h"

namespace cdiff::planners {

/// Options of the planner `diffusion` (paper III): model, what it sees, sampler, state branch.
struct DiffusionOptions {
  std::string model = "default";  ///< shipped model or folder of the weight files
  /// image_route | image (the paper's) | by_guidance
  std::string conditioning = "by_guidance";
  /// w of classifier-free guidance on the route (and the target speed, where the model takes it):
  /// 0 without, 1 with it, between and beyond a mix
  double route_scale = 1.0;
  /// Of the inputs beside the route that a model may take (Architecture::withMotion), those that it
  /// is given: all | previous_image | target_speed | none
  std::string motion = "all";
  /// pinned (before the trajectory, at each diffusion step) | none; as the model was trained
  std::string current_state = "none";
  std::string state_branch = "learned";  ///< learned | exact
  std::string response = "fitted";       ///< of the executed throttle: fitted | monotone
  double hysteresis = 0.1;               ///< a new mode must be better by this share of the score
  double frozen_image_time = 1.0;        ///< the same image for so long while moving is a fault [s]
  std::string precision = "auto";        ///< of the encoder: auto | fp32 | bf16 | int8
  std::string isa = "auto";              ///< of encoder and denoiser: auto | avx2 | avx512
  std::int64_t threads = 1;              ///< among which the vehicles of a decision are divided
  diffusion::SamplerOptions sampler;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for a route_scale where no vehicle is given its route; the model has its say
  /// when it is read.
  void validate() const;
  /// What `conditioning` comes to under a guidance: by_guidance is image where collision_seeking
  /// has a weight (an attacker that knows its route stops in its lane before the ego instead of
  /// driving at it), image_route elsewhere and where the sampler's mode is unguided.
  std::string conditioningUnder(const guidance::GuidanceOptions& guidance) const;
};

}  // namespace cdiff::planners
