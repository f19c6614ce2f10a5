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
  std::string state_branch = "learned";  ///< learned | exact
  std::int64_t candidates = 1;           ///< samples per vehicle
  double hysteresis = 0.1;               ///< a new mode must be better by this share of the score
  double frozen_image_time = 1.0;        ///< the same image for so long while moving is a fault [s]
  diffusion::SamplerOptions sampler;

  void describe(core::OptionsVisitor& visitor);
  /// Every value that `describe` admits is fine here; the model has its say when it is read.
  void validate() const {}
  /// What `conditioning` comes to under a guidance: by_guidance is image where collision_seeking
  /// has a weight (an attacker that knows its route stops in its lane before the ego
  /// instead of driving at it), image_route elsewhere and where the sampler's mode is unguided.
  std::string conditioningUnder(const guidance::GuidanceOptions& guidance) const;
};

}  // namespace cdiff::planners
