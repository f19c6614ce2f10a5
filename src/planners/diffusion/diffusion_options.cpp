// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_options.h"

namespace cdiff::planners {

void DiffusionOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"model", "", "Shipped model, or folder with its weight files."}, model, {});
  visitor.text(
      {"conditioning", "",
       "What the network is given: image and route, the image alone, or the image alone where "
       "collision_seeking has a weight."},
      conditioning, {"image_route", "image", "by_guidance"});
  visitor.text({"state_branch", "", "States from actions: learned head, or exact dynamics."},
               state_branch, {"learned", "exact"});
  visitor.integer({"candidates", "", "Samples per vehicle and decision."}, candidates, 1, 64);
  visitor.number({"hysteresis", "", "Share of the score by which another mode must be better."},
                 hysteresis, 0.0, 1.0);
  visitor.number({"frozen_image_time", "s", "The same image for so long while moving is a fault."},
                 frozen_image_time, 0.1, 60.0);
  visitor.group({"sampler", "", "How trajectories are denoised."}, sampler);
}

std::string DiffusionOptions::conditioningUnder(const guidance::GuidanceOptions& guidance) const {
  if (conditioning != "by_guidance") return conditioning;
  const bool attacks = sampler.mode != "unguided" && guidance.isActive("collision_seeking");
  return attacks ? "image" : "image_route";
}

}  // namespace cdiff::planners
