// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "collection/collection_options.h"
#include "collection/sample_kinds.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "rendering/front_camera.h"

namespace cdiff::collection {

/// A displacement to the left [m] and counter-clockwise [rad].
struct SampleOffset {
  double lateral = 0.0;
  double heading = 0.0;
};

/// What displace() makes.
struct DisplacedSample {
  learning::DrivingSample sample;
  bool off_course = false;  ///< at its displaced place, as SampleKinds
};

/// Samples of vehicles that are put beside their route: image from the displaced place, pedals as
/// recorded, steering by which the expert would return to its route, states by the vehicle dynamics
/// (so that actions and states agree), route tokens from the displaced place.
class OffsetSamples {
 public:
  /// `setup` and `options` must outlive this object.
  OffsetSamples(const session::SessionSetup& setup, const DatasetOptions& options);

  /// `sample`, displaced; `future` holds the snapshots of the following T decisions. nullopt where
  /// the vehicle would touch another one or leave the road at any time, or starts off it.
  std::optional<DisplacedSample> displace(
      const learning::DrivingSample& sample, const SampleSurroundings& around,
      const std::vector<const traffic::TrafficSnapshot*>& future, const SampleOffset& offset);

 private:
  bool free(const traffic::Vehicle& vehicle, const traffic::TrafficSnapshot& snapshot) const;
  bool driveBack(traffic::Vehicle vehicle, const SampleSurroundings& around,
                 const std::vector<const traffic::TrafficSnapshot*>& future,
                 traffic::Rollout& rollout) const;

  const session::SessionSetup& setup_;
  const DatasetOptions& options_;
  dynamics::BicycleModel model_;
  rendering::FrontCamera camera_;
};

}  // namespace cdiff::collection
