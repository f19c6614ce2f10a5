// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The table from planner name to constructor, for ego and CBVs alike.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/planning/planner.h"
#include "guidance/guidance_options.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planners/two_stage_pid/trajectory_tracker.h"
#include "rendering/camera_options.h"

namespace cdiff::planners {

/// Options of all planners; each takes its own.
struct PlannerOptions {
  PdmLiteOptions pdm_lite;
  DiffusionOptions diffusion;  ///< of two_stage_pid too
  TrajectoryTrackerOptions two_stage_pid;
  guidance::GuidanceOptions guidance;        ///< of planners that can be guided
  std::string guidance_group = "guidance.";  ///< before its keys in errors
  dynamics::BicycleModelOptions vehicle;
  rendering::CameraOptions camera;  ///< that planners which see look through
};

/// Throws InputError naming the nearest known planner for an unknown name.
std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const PlannerOptions& options,
                                               const planning::PlanningContext& context);

/// Names that makePlanner knows, sorted.
std::vector<std::string> plannerNames();
/// Whether a planner of this name follows guidance objectives; false for unknown names.
bool canBeGuided(const std::string& name);
/// Whether a planner of this name needs images; false for unknown names.
bool seesImages(const std::string& name);

}  // namespace cdiff::planners
