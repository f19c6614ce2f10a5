// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "planners/camera_ego/training/ego_data.h"
#include "planners/camera_ego/training/ego_validation.h"
#include "planners/vad_mini/vad_mini_network.h"

namespace cdiff::planners {

/// Open-loop measures of `vad_mini` on held-out moments, by the network that drives; beside it a
/// vehicle that keeps its velocity, detections that never change, and a straight road.
class VadMiniValidation {
 public:
  /// `prior` must outlive the validation.
  VadMiniValidation(const VadMiniModel& model, const ConstantDetections& prior);
  void add(const EgoExample& example);
  learning::Measures measures() const { return ego_.measures(); }
  std::string byNetwork() const { return ego_.byNetwork(); }

 private:
  VadMiniOutput look(const EgoExample& example);

  VadMiniArchitecture architecture_;
  VadMiniNetwork network_;
  const ConstantDetections& prior_;
  EgoValidation ego_;
};

/// Lines that the network is sure of (body frame [m]): score above `least`.
std::vector<BevLine> sureLines(const VadMiniOutput& output, double least);

}  // namespace cdiff::planners
