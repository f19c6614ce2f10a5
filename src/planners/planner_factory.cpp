// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/planner_factory.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planners/pdm_lite/pdm_lite.h"
#include "planners/two_stage_pid/two_stage_pid.h"

namespace cdiff::planners {
namespace {

using Constructor = std::unique_ptr<planning::Planner> (*)(const PlannerOptions&,
                                                           const planning::PlanningContext&);

struct Entry {
  const char* name;
  Constructor make;
  bool guided;  ///< follows guidance objectives
  bool sees;    ///< needs images
};

/// Throws InputError if the camera has not the size of the model's images.
std::unique_ptr<DiffusionPlanner> makeSeeing(const PlannerOptions& options,
                                             const planning::PlanningContext& context) {
  auto planner = std::make_unique<DiffusionPlanner>(
      options.diffusion, options.guidance, options.vehicle, context, options.guidance_group);
  const diffusion::Architecture& sizes = planner->model().architecture;
  const rendering::CameraOptions& camera = options.camera;
  if (camera.width != sizes.image_width || camera.height != sizes.image_height) {
    throw core::InputError("the camera's size is " + std::to_string(camera.width) + " x " +
                           std::to_string(camera.height) + " (keys camera.width, camera.height); " +
                           "model '" + planner->model().name + "' sees " +
                           std::to_string(sizes.image_width) + " x " +
                           std::to_string(sizes.image_height));
  }
  return planner;
}

std::unique_ptr<planning::Planner> makeDiffusion(const PlannerOptions& options,
                                                 const planning::PlanningContext& context) {
  return makeSeeing(options, context);
}

std::unique_ptr<planning::Planner> makeTwoStagePid(const PlannerOptions& options,
                                                   const planning::PlanningContext& context) {
  return std::make_unique<TwoStagePid>(makeSeeing(options, context), options.two_stage_pid);
}

std::unique_ptr<planning::Planner> makePdmLite(const PlannerOptions& options,
                                               const planning::PlanningContext& context) {
  return std::make_unique<PdmLite>(options.pdm_lite, options.vehicle, context);
}

/// The table, sorted by name: a new planner is one more line.
constexpr Entry kPlanners[] = {
    {"diffusion", &makeDiffusion, true, true},
    {"pdm_lite", &makePdmLite, false, false},
    {"two_stage_pid", &makeTwoStagePid, true, true},
};

const Entry* findEntry(const std::string& name) {
  for (const Entry& entry : kPlanners) {
    if (name == entry.name) return &entry;
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const PlannerOptions& options,
                                               const planning::PlanningContext& context) {
  if (const Entry* entry = findEntry(name)) return entry->make(options, context);
  if (name == "external") {
    throw core::InputError(
        "planner 'external' is a node of the user's own: it needs the node graph "
        "(session.launch), not a planner in this process");
  }
  throw core::InputError("unknown planner '" + name + "'; the nearest known planner is '" +
                         core::nearestName(name, plannerNames()) + "'");
}

std::vector<std::string> plannerNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kPlanners) names.emplace_back(entry.name);
  return names;
}

bool canBeGuided(const std::string& name) {
  const Entry* entry = findEntry(name);
  return entry != nullptr && entry->guided;
}

bool seesImages(const std::string& name) {
  const Entry* entry = findEntry(name);
  return entry != nullptr && entry->sees;
}

}  // namespace cdiff::planners
