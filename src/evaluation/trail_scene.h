// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/run_plan.h"
#include "evaluation/run_record.h"
#include "record/result_folder.h"

namespace cdiff::evaluation {

// One scene as each planner of a batch drove it: runs that differ in the planner of CBVs, or of the
// ego, alone.

/// A contact of two vehicles and its place in the map frame [m].
struct TouchPlace {
  std::uint64_t tick = 0;
  std::string vehicle;
  std::string partner;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// One planner's run of a scene: trace and contacts of CBVs and ego.
struct DrivenScene {
  std::string planner;
  const BatchRun* run = nullptr;
  double step = 0.0;                   ///< [s]
  std::vector<record::TraceRow> rows;  ///< of all vehicles
  std::vector<TouchPlace> touches;
};

/// Whose planner differs between the runs of a scene.
enum class TrailsOf { kCbvs, kEgo };

/// The factor in which they differ: "cbv_planner" or "ego_planner".
std::string factorOf(TrailsOf who);

/// The factors that the runs of a scene share: all but that one.
Factors sceneOf(const BatchRun& run, TrailsOf who);

/// One of the scenes that two or more planners drove to an end, by planner. Of CBVs that of most
/// planners with a CBV, then with the smallest distance of any CBV to the ego; of egos that of most
/// planners, then with the lowest mean driving score. Empty where there is none. Throws InputError
/// naming a damaged trace or summary.
std::vector<DrivenScene> chosenScene(const std::vector<BatchRun>& runs, TrailsOf who);

}  // namespace cdiff::evaluation
