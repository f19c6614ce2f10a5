// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_descriptor.h"

#include "e2e_cdiff/core/exceptions.h"
#include "planners/diffusion/image_watch.h"

namespace cdiff::planners {
namespace {

std::string samplingText(const DiffusionOptions& options) {
  const diffusion::SamplerOptions& sampler = options.sampler;
  const std::string candidates =
      options.candidates == 1 ? "1 sample" : std::to_string(options.candidates) + " samples";
  if (sampler.mode == "unguided") return "DDPM over all K steps without guidance, " + candidates;
  if (sampler.mode == "paper")
    return "DDPM over all K steps, gradient through the network, " + candidates;
  return "DDIM over " + std::to_string(sampler.steps) + " steps, proximal guidance" +
         (sampler.warm_start ? ", warm start, " : ", ") + candidates;
}

planning::NetworkFacts networkFacts(const planning::PlannerOptionsTable& table,
                                    const guidance::GuidanceOptions& guidance) {
  const auto& options = table.of<DiffusionOptions>();
  return {options.model,
          options.conditioningUnder(guidance),
          samplingText(options),
          {{"encoder_instruction_set", diffusion::ImageEncoder::instructionSet()},
           {"denoiser_instruction_set",
            diffusion::CpuDenoiser::toText(diffusion::CpuDenoiser::bestInstructionSet())}}};
}

}  // namespace

std::unique_ptr<DiffusionPlanner> makeDiffusionPlanner(const planning::PlannerParts& parts) {
  auto planner =
      std::make_unique<DiffusionPlanner>(parts.options.of<DiffusionOptions>(), parts.guidance,
                                         parts.vehicle, parts.context, parts.guidance_group);
  const diffusion::Architecture& sizes = planner->model().architecture;
  const rendering::CameraOptions& camera = parts.camera;
  if (camera.width == sizes.image_width && camera.height == sizes.image_height) return planner;
  throw core::InputError("the camera's size is " + sizeText(camera.width, camera.height) +
                         " (keys camera.width, camera.height); model '" + planner->model().name +
                         "' sees " + sizeText(sizes.image_width, sizes.image_height));
}

planning::PlannerDescriptor diffusionDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "diffusion";
  descriptor.title = "E2E-CDiff";
  descriptor.help = "guided diffusion of states and actions from the front view.";
  descriptor.cameras = {"front"};
  descriptor.guided = true;
  descriptor.cbv_node = "diffusion_planner_node";
  descriptor.options = planning::makePlannerOptions<DiffusionOptions>;
  descriptor.make = makeDiffusionPlanner;
  descriptor.network = networkFacts;
  descriptor.weights_sha256 = [](const planning::PlannerOptionsTable& table) {
    return diffusion::modelFilesSha256(table.of<DiffusionOptions>().model);
  };
  return descriptor;
}

}  // namespace cdiff::planners
