// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_descriptor.h"

#include "core/text.h"
#include "diffusion/few_step_solver.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planners/diffusion/image_watch.h"

namespace cdiff::planners {
namespace {

std::string samplerText(const diffusion::SamplerOptions& sampler) {
  if (sampler.mode == "unguided") return "DDPM over all K steps without guidance";
  if (sampler.mode == "paper") return "DDPM over all K steps, gradient through the network";
  // Of the shipped architecture; a model of another K is read by the planner alone.
  const auto diffusion_steps = static_cast<int>(diffusion::Architecture().diffusion_steps);
  return diffusion::fewStepSolverTitle(sampler.solver) + " over " +
         std::to_string(sampler.visitedSteps(diffusion_steps, false).size()) +
         " steps, proximal guidance" + (sampler.warm_start ? ", warm start" : "");
}

std::string candidatesText(const guidance::GuidanceOptions& guidance) {
  if (guidance.candidates == 1) return "1 sample";
  const std::string samples = std::to_string(guidance.candidates) + " samples";
  if (guidance.road_horizon == 0.0) return samples;
  return samples + ", first those on the road for " + core::formatNumber(guidance.road_horizon) +
         " s";
}

std::string samplingText(const DiffusionOptions& options,
                         const guidance::GuidanceOptions& guidance) {
  const std::string noise =
      guidance.noise_correlation == 0.0 ? ""
      : guidance.noise_correlation == 1.0
          ? ", one noise a vehicle"
          : ", noise correlated by " + core::formatNumber(guidance.noise_correlation);
  return samplerText(options.sampler) + ", " + candidatesText(guidance) + noise +
         (options.response == "fitted" ? "" : ", " + options.response + " response");
}

std::string conditioningText(const DiffusionOptions& options,
                             const guidance::GuidanceOptions& guidance) {
  const std::string conditioning = options.conditioningUnder(guidance);
  if (conditioning != "image_route") return conditioning;
  const std::string motion = options.motion == "all" ? "" : ", motion " + options.motion;
  if (options.route_scale == 1.0) return conditioning + motion;
  return conditioning + motion + ", route scale " + core::formatNumber(options.route_scale);
}

planning::NetworkFacts networkFacts(const planning::PlannerOptionsTable& table,
                                    const guidance::GuidanceOptions& guidance) {
  const auto& options = table.of<DiffusionOptions>();
  const inference::Precision precision =
      inference::precisionNamed(options.precision, options.isa, "diffusion.precision");
  return {options.model,
          conditioningText(options, guidance),
          samplingText(options, guidance),
          {{"encoder_precision", inference::toText(precision)},
           {"encoder_instruction_set", inference::oneDnnInstructionSet(options.isa, precision)},
           {"denoiser_instruction_set",
            inference::toText(inference::instructionSetNamed(options.isa, "diffusion.isa"))}}};
}

}  // namespace

std::unique_ptr<DiffusionPlanner> makeDiffusionPlanner(const planning::PlannerParts& parts) {
  auto planner =
      std::make_unique<DiffusionPlanner>(parts.options.of<DiffusionOptions>(), parts.guidance,
                                         parts.vehicle, parts.context, parts.guidance_group);
  const diffusion::Architecture& sizes = planner->model().architecture;
  const rendering::CameraOptions& camera = parts.camera;
  if (camera.width == sizes.image_width && camera.height == sizes.image_height) {
    if (!parts.rig.cameras.empty()) {
      rendering::requireSameCameras(
          parts.rig, {rendering::frontCamera(camera)},
          {"model '" + planner->model().name + "' (keys camera.*)", parts.rig_key});
    }
    return planner;
  }
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
