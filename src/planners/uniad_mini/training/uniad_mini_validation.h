// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "planners/camera_ego/training/ego_validation.h"
#include "planners/uniad_mini/plan_adjustment.h"
#include "planners/uniad_mini/uniad_mini_network.h"

namespace cdiff::planners {

/// Open-loop measures of `uniad_mini` on held-out moments, by the network that drives: its plans
/// as answered and as adjusted; beside them a vehicle that keeps its velocity, detections that
/// never change, and a straight road. Besides the distances of forecasts' best modes, and the
/// overlap of occupancy with where labeled agents are.
class UniadMiniValidation {
 public:
  /// `prior` must outlive the validation.
  UniadMiniValidation(const UniadMiniModel& model, const ConstantDetections& prior);
  void add(const EgoExample& example);
  learning::Measures measures() const;

 private:
  UniadMiniOutput look(const EgoExample& example);
  void addForecasts(const EgoExample& example, const UniadMiniOutput& output);
  void addOccupancy(const EgoExample& example, const UniadMiniOutput& output);

  UniadMiniArchitecture architecture_;
  UniadMiniNetwork network_;
  const ConstantDetections& prior_;
  EgoValidation ego_;
  PlanMeasures adjusted_{"adjusted_"};
  double end_sum_ = 0.0, end_count_ = 0.0;  ///< smallest distances of forecasts at 3 s [m]
  double meet_ = 0.0, join_ = 0.0;          ///< cells occupied in both, and in either
};

/// The measures as Markdown.
std::string uniadTable(const learning::Measures& held_out);

}  // namespace cdiff::planners
