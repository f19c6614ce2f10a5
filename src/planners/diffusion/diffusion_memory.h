// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "planners/diffusion/image_watch.h"
#include "planners/diffusion/last_plan.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// What the diffusion planner remembers of a vehicle from decision to decision.
class DiffusionMemory {
 public:
  planning::RouteFollower follower;
  ImageWatch watch;
  std::optional<LastPlan> plan;  ///< none after a fault
  std::vector<float> features;   ///< of the image that was encoded last

  /// Whether the image that was watched last is another than the one that `features` are of; from
  /// now on they are to be its own.
  bool takeImage();
  /// Keeps the features as those of a decision, and those of decisions up to `back` ticks before;
  /// none where that is 0.
  void keepFeatures(std::uint64_t tick, std::uint64_t back);
  /// The features that were kept `back` ticks before `tick`; nullptr where none were.
  const std::vector<float>* featuresBefore(std::uint64_t tick, std::uint64_t back) const;

 private:
  std::uint64_t features_hash_ = 0;
  std::map<std::uint64_t, std::vector<float>> earlier_;  ///< by tick
};

}  // namespace cdiff::planners
