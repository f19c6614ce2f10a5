// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_options.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {

void DiffusionOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"model", "", "Shipped model, or folder with its weight files."}, model, {});
  visitor.text(
      {"conditioning", "",
       "What the network is given: image and route, the image alone, or the image alone where "
       "collision_seeking has a weight."},
      conditioning, {"image_route", "image", "by_guidance"});
  visitor.number(
      {"route_scale", "",
       "How much the route counts where it is given: 0 nothing, 1 as trained, above 1 more."},
      route_scale, 0.0, 5.0);
  visitor.text({"motion", "",
                "Given with the route to a model that takes them: the image of 0.4 s before, the "
                "target speed, or all of that."},
               motion, {"all", "previous_image", "target_speed", "none"});
  visitor.text(
      {"current_state", "",
       "State of the vehicle before the trajectory that is denoised: pinned there, or none, "
       "as the model was trained."},
      current_state, {"none", "pinned"});
  visitor.text({"state_branch", "", "States from actions: learned head, or exact dynamics."},
               state_branch, {"learned", "exact"});
  visitor.text(
      {"response", "",
       "Response to the executed throttle: as the dynamics was fitted, or monotone: one that "
       "would slow the vehicle coasts."},
      response, {"fitted", "monotone"});
  visitor.number({"hysteresis", "", "Share of the score by which another mode must be better."},
                 hysteresis, 0.0, 1.0);
  visitor.number({"frozen_image_time", "s", "The same image for so long while moving is a fault."},
                 frozen_image_time, 0.1, 60.0);
  visitor.text({"precision", "",
                "What the image encoder multiplies; auto: int8 where the processor has AVX-512 "
                "VNNI, else fp32."},
               precision, {"auto", "fp32", "bf16", "int8"});
  visitor.text({"isa", "", "Instructions of encoder and denoiser; auto: the best of this machine."},
               isa, {"auto", "avx2", "avx512"});
  visitor.integer({"threads", "", "Among which the CBVs of a decision are divided."}, threads, 1,
                  16);
  visitor.group({"sampler", "", "How trajectories are denoised."}, sampler);
}

void DiffusionOptions::validate() const {
  if (route_scale == 1.0 || conditioning != "image") return;
  throw core::InputError("key 'diffusion.route_scale' is " + core::formatNumber(route_scale) +
                         ", and conditioning 'image' gives no vehicle its route; expected 1, or "
                         "conditioning 'image_route'");
}

std::string DiffusionOptions::conditioningUnder(const guidance::GuidanceOptions& guidance) const {
  if (conditioning != "by_guidance") return conditioning;
  const bool attacks = sampler.mode != "unguided" && guidance.isActive("collision_seeking");
  return attacks ? "image" : "image_route";
}

}  // namespace cdiff::planners
