// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "collection/camera_sight.h"
#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "rendering/front_camera.h"
#include "session/session_setup.h"

namespace cdiff::collection {

// Recovery samples: what a recorded vehicle would see and do beside its route.

/// A displacement to the left [m] and counter-clockwise [rad].
struct SampleOffset {
  double lateral = 0.0;
  double heading = 0.0;
};

/// `state` as it would be had the vehicle come to `displaced` in place of `here`.
traffic::VehicleState displacedAlike(const traffic::VehicleState& state,
                                     const traffic::VehicleState& here,
                                     const traffic::VehicleState& displaced);

/// A sample as it would be beside its route, made by DisplacedSamples.
struct DisplacedSample {
  learning::DrivingSample sample;
  bool off_course = false;  ///< SampleKinds::off_course at the displaced place
};

/// Makes recovery samples: a recorded vehicle is put beside its route and drives back. The image
/// and the route tokens are those of the displaced place, throttle and brake are as recorded, the
/// steering is PDM-Lite's toward the route, and the states are what the vehicle dynamics makes of
/// these actions (rows in the frame of the displaced vehicle, SI units). Called by samplesOf for a
/// share of the samples.
class DisplacedSamples {
 public:
  /// `setup` and `options` must outlive this object.
  DisplacedSamples(const session::SessionSetup& setup, const DatasetOptions& options);

  /// What the vehicle sees in the snapshot from `state`.
  traffic::CameraImage seen(const traffic::TrafficSnapshot& snapshot, traffic::Vehicle vehicle,
                            const traffic::VehicleState& state) {
    vehicle.state = state;
    return camera_.render(snapshot, vehicle);
  }
  /// The auxiliary targets of what `vehicle` sees, the driven one or a copy in another place.
  std::vector<float> targets(const traffic::Vehicle& vehicle, const SampleSurroundings& around) {
    return sightTargetsOf(vehicle, around.snapshot, sight_.seenBy(vehicle, around.snapshot),
                          around.route, around.arc_length);
  }
  /// The sample with its vehicle displaced by `offset`; `previous`: the snapshot of its image
  /// before, where it has one; `future`: those of the T decisions that follow. nullopt when the
  /// vehicle would start off the drivable area, leave it, or touch another
  /// vehicle.
  std::optional<DisplacedSample> displace(
      const learning::DrivingSample& sample, const SampleSurroundings& around,
      const traffic::TrafficSnapshot& previous,
      const std::vector<const traffic::TrafficSnapshot*>& future, const SampleOffset& offset);

 private:
  /// Whether the box lies on the drivable area and overlaps no other vehicle on its level.
  bool free(const traffic::Vehicle& vehicle, const traffic::TrafficSnapshot& snapshot) const;
  /// Drives from the displaced place with the throttle and brake in `rollout`, whose states and
  /// steering it overwrites; false as soon as the vehicle is not free.
  bool driveBack(traffic::Vehicle vehicle, const SampleSurroundings& around,
                 const std::vector<const traffic::TrafficSnapshot*>& future,
                 traffic::Rollout& rollout) const;

  const session::SessionSetup& setup_;
  const DatasetOptions& options_;
  dynamics::BicycleModel model_;
  rendering::FrontCamera camera_;
  CameraSight sight_;
};

}  // namespace cdiff::collection
