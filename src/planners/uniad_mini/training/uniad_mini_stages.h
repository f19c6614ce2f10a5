// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>

#include "planners/uniad_mini/training/uniad_mini_task.h"

namespace cdiff::planners {

// The stages of the training of `uniad_mini`, and their parts in checkpoints.

inline constexpr const char* kPerceptionStage = "perception";
inline constexpr const char* kEndToEndStage = "end_to_end";
inline constexpr const char* kBevPart = "bev";
inline constexpr const char* kTrackPart = "track";
inline constexpr const char* kPlanPart = "plan";
/// Samples a step where the options give none.
inline constexpr std::int64_t kUniadMiniBatch = 16;

std::unique_ptr<learning::Stage> makeUniadStage(UniadTrainingState& state, const std::string& name);

/// Measures on the held-out samples of a run.
learning::Measures heldOutMeasures(UniadTrainingState& state);

}  // namespace cdiff::planners
