// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collection/camera_sight.h"
#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "rendering/front_camera.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// A stretch during which one vehicle follows one route: vehicle and the tick it was selected at.
using DriveKey = std::pair<std::string, std::uint64_t>;

/// The image that a driven vehicle was shown at a decision.
struct DrivenImage {
  int slot = traffic::kEgoSlot;
  traffic::CameraImage image;
};

/// A session in memory: what drove along which routes, and what it saw; samples are made of it.
struct DrivenSession {
  std::string name;  ///< scenario and seed
  std::unique_ptr<session::SessionSetup> setup;
  std::vector<traffic::TrafficSnapshot> decisions;          ///< at decision ticks, in order
  std::map<std::uint64_t, std::map<int, DriveKey>> drives;  ///< by tick, then slot
  std::map<DriveKey, map::Route> routes;
  std::set<std::pair<std::string, std::uint64_t>> disturbed;   ///< noise or fault: vehicle, tick
  std::map<std::string, std::vector<std::uint64_t>> contacts;  ///< ticks by vehicle
  std::vector<DrivenImage> images;                             ///< by tick, then slot
  double seconds = 0.0;                                        ///< simulated
};

// Training samples from a driven session: for every image of a driven vehicle what it then did, in
// its own frame (SI units; rows as in traffic/vehicle.h), and its route tokens.

/// By tick and slot. An image gives one if its vehicle was driven, without noise, contact or jump,
/// from the tick before it to the end of the horizon. Throws InputError for images of another size.
std::vector<learning::DrivingSample> samplesOf(const DrivenSession& session,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

/// Topics of the drive's bag, and how samples are taken of it.
struct DriveOptions {
  std::string image;     ///< sensor_msgs/Image or sensor_msgs/CompressedImage
  std::string odometry;  ///< nav_msgs/Odometry: pose in a fixed frame, forward speed as twist x
  std::string control;   ///< e2e_cdiff/ControlAction; empty: actions are inferred from the motion
  std::string path;      ///< nav_msgs/Path in the odometry's frame; empty: the path driven
  double period = 0.5;   ///< between two samples [s]
  double largest_gap = 0.3;  ///< largest gap of odometry and controls within a sample [s]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError when a topic that must be given is not.
  void validate() const;
};

/// A drive of one vehicle with a front camera that someone else recorded, in memory: images,
/// states, controls and paths by their stamps [s] (SI units, a fixed frame of its own).
struct RecordedDrive {
  std::map<double, traffic::CameraImage> images;  ///< of the architecture's size
  std::map<double, traffic::VehicleState> states;
  std::map<double, traffic::ControlAction> controls;
  std::map<double, geometry::Polyline> paths;

  /// State between the two nearest around `time`; nullopt outside, or where they lie farther apart
  /// than `largest_gap`.
  std::optional<traffic::VehicleState> stateAt(double time, double largest_gap) const;
  /// The last control up to `time`, at most `largest_gap` old.
  std::optional<traffic::ControlAction> controlAt(double time, double largest_gap) const;
};

// Training samples from a drive that someone else recorded (SI units; rows as in
// traffic/vehicle.h).

/// Samples of the drive called `name` in order of time; each minute is a session of its own, so
/// that whole minutes are held out in training. An image gives one if odometry (and controls, where
/// named) goes on for the whole horizon, forward: reversing is dropped, because the vehicle
/// dynamics cannot reverse. Actions that are inferred are those of the vehicle dynamics
/// (dynamics/action_rollout.h). Throws InputError where there is no image or no sample.
std::vector<learning::DrivingSample> samplesOf(const RecordedDrive& drive, const std::string& name,
                                               const DriveOptions& drive_options,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

/// A displacement to the left [m] and counter-clockwise [rad].
struct SampleOffset {
  double lateral = 0.0;
  double heading = 0.0;
};

/// `state` as it would be had the vehicle come to `displaced` in place of `here`.
traffic::VehicleState displacedAlike(const traffic::VehicleState& state,
                                     const traffic::VehicleState& here,
                                     const traffic::VehicleState& displaced);

/// A sample as it would be beside its route, made by OffsetSamples.
struct DisplacedSample {
  learning::DrivingSample sample;
  bool off_course = false;  ///< SampleKinds::off_course at the displaced place
};

/// Makes recovery samples: a recorded vehicle is put beside its route and drives back. The image
/// and the route tokens are those of the displaced place, throttle and brake are as recorded, the
/// steering is PDM-Lite's toward the route, and the states are what the vehicle dynamics makes of
/// these actions (rows in the frame of the displaced vehicle, SI units). Called by samplesOf for a
/// share of the samples.
class OffsetSamples {
 public:
  /// `setup` and `options` must outlive this object.
  OffsetSamples(const session::SessionSetup& setup, const DatasetOptions& options);

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
